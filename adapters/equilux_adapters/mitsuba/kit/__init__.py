"""What the written scripts are made of: modules whose text `source.py` copies, so that a script needs nothing but Mitsuba.

They name Mitsuba's classes, so they can be imported only after `mitsuba.set_variant`.
"""
