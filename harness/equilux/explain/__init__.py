"""Why two renders differ, in words and numbers: `equilux explain`, and the messages of failures elsewhere.

explain_pair(case, pair, …) → lines of text        (sentences.py; no files are read)
gather(run, case, a, b) → all there is to say       (gather.py; reads the results tree and nothing else)
"""

from equilux.explain.sentences import Told, explain_pair, one_line

__all__ = ["Told", "explain_pair", "one_line"]
