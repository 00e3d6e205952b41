"""Pushing one quantity decade by decade until each renderer breaks.

Begin at `axis` (what an axis is) and `axes/` (the axes that there are); `push` renders them, `measure` reads what came of it,
`breakdown` finds where a curve leaves its uncertainty, `symptom` says what breaks, `record` is what is written.
"""
