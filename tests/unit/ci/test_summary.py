"""summary.md, as a reviewer reads it."""

from __future__ import annotations

from equilux.ci import RunView
from equilux.ci.markdown import code, plain
from equilux.ci.summary import summary

GOLDEN = r"""## equilux: 3 unexpected divergences, 1 expected divergence gone, 1 failed render, 1 fault of the engine

3 cases, 11 renders (8 ok, 1 reused), 7 pairs; 4.0 s; exit code 3

### Faults of the engine itself

- fog: a \| fault

### To be looked at

| case | pair | what | pixels | worst pixel: both numbers, bound B, E_n |
| --- | --- | --- | --- | --- |
| `clay[exponent=1]` | vtk / oracle | exponent-clamped \[128\]: the highlight's exponent is cut off at 128; unexplained, explains 99.8 % | 12 of 48 (25.0 %) | (3, 2) |
| `clay[exponent=1]` | povray / oracle | povray agrees with oracle, but the scene expects it to diverge (scaled): remove the expectation | 0 of 48 (0 %) |  |

### Renders that failed

| case | adapter | status | why |
| --- | --- | --- | --- |
| `clay[exponent=1]` | mitsuba | crashed | ended by signal 11 |

### Verdicts

| verdict | pairs |
| --- | ---: |
| diverge unexpectedly | 3 |
| expected to diverge, but gone | 1 |
| diverge as expected | 1 |
| agree | 1 |
| not comparable | 1 |

### By adapter

| adapter | version | ok | unsupported | failed | missing | agree | expected | unexpected | gone |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
| vtk | 9.7 | 3 | 0 | 0 | 0 | 0 | 1 | 3 | 0 |
| povray | 3.7 | 1 | 0 | 0 | 0 | 0 | 0 | 1 | 1 |
| opengl |  | 0 | 1 | 0 | 0 | 0 | 0 | 0 | 0 |
| mitsuba |  | 0 | 0 | 1 | 0 | 0 | 0 | 0 | 0 |
| extra |  | 0 | 0 | 0 | 1 | 0 | 0 | 0 | 0 |
| reference |  | 1 | 0 | 0 | 0 | 1 | 0 | 1 | 0 |
| oracle |  | 3 | 0 | 0 | 0 | 1 | 1 | 1 | 1 |

### Known divergences, by cause

| adapter | cause | cases | for example |
| --- | --- | ---: | --- |
| vtk | `exponent-clamped` | 1 | `clay[exponent=1000]` |

### Not supported

| adapter | lacks | cases | for example |
| --- | --- | ---: | --- |
| opengl | `model.phong` | 1 | `clay[exponent=1]` |

Pictures and numbers: `report/index.html` in the results (`out`); one pair in words: `equilux explain out CASE A B`
"""  # noqa: E501


def test_the_summary_tells_first_what_needs_a_look(view: RunView):
    assert summary(view) == GOLDEN


def test_text_of_others_is_never_markup():
    assert plain("a|b <img>\n# [x](y) `z`") == r"a\|b \<img\> \# \[x\](y) \`z\`"
    assert code("a`b|c\nd") == "``a`b\\|c d``"
