"""The edit of the spec files that makes a run's judgement pass: proven causes pinned, vanished ones removed.

decide(scene file, its records) → what each adapter should be expected to do on which cases     (decide.py)
edited(text, …) → the spec's text with that and nothing else changed                             (edit.py)
propose(results, scene files) → a unified diff, and what cannot be pinned and why                (propose.py)
"""
