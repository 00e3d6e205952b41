"""What each renderer's lighting model really is: its declared rules, each with the evidence of a run. Pages of docs/dialects/.

gathered(run, adapter, dialect) → Evidence        (evidence.py; reads the results tree and nothing else)
page(evidence, rules) → Markdown                  (page.py)
"""
