"""Why a render departs from the truth: the smallest set of causes under which the reference reproduces it, proven by rendering.

    diagnose(case, side, truth, scored, …) → Diagnosis        search.py
    Accounts(case, truth).explain(a, b, classes)              peers.py, for pairs of laboratories

A few hundred pixels are evidence (evidence.py). Hypotheses (hypotheses.py) are rendered there (trials.py) and their numbers
fitted (fit.py, scales.py); what explains them is proven on the whole picture by the comparison itself (proof.py), and what it
leaves over is looked at by itself (extension.py). report.py, words.py, regions.py and unexplained.py say what was found.
"""
