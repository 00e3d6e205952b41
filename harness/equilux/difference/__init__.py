"""What changed between two runs, and in words: `equilux diff`.

compare_runs(a, b) → changes          (compare.py; the results alone)
compare_pictures(…) → changes         (pictures.py; reads the pictures whose hash changed)
tell(changes) → lines of text         (words.py; the same change on many cases is one sentence)
"""
