"""The functions that stand-alone VTK scripts are made from.

`translate` copies the source of those that a scene needs into its script, so what is tested here is, to the letter, what the
script runs. They use NumPy and VTK only, and nothing of equilux but each other.
"""
