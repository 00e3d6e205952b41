"""Why a render departs from the truth: the smallest set of causes under which the reference reproduces it, proven by rendering.

diagnose(case, side, truth, tracer, …) → Diagnosis        (search.py)
"""
