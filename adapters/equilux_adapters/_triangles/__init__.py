"""Scenes as triangles in double precision, for renderers that draw nothing else.

`view`, `facing`, `clip`, `depth`, `round` and `shapes` use NumPy and the standard library only: stand-alone scripts are made from
them. `translate` of an adapter copies the source of those functions that a scene needs into its script (`source`), so what is
tested here is, to the letter, what the script runs.
"""
