"""Which of two causes that do the same is named."""

from __future__ import annotations

import pytest

from equilux.diagnose.hypotheses import Preference
from equilux_tracer.causes import RULES, Applied


@pytest.mark.parametrize(
    ("named", "other"),
    [
        (Applied("exponent-scaled", 0.25), Applied("exponent-clamped", 5.0)),  # exponent 20
        (Applied("exponent-clamped", 64.0), Applied("exponent-scaled", 0.64)),  # exponent 100
        (Applied("exponent-clamped", 16.0), Applied("exponent-scaled", 0.8)),  # exponent 20: neither value is usual
        (Applied("reversed-normals"), Applied("mirrored-handedness", None, "z")),
    ],
    ids=str,
)
def test_of_two_that_do_the_same_the_likelier_is_named(named: Applied, other: Applied) -> None:
    preference = Preference(RULES)
    assert preference.of_all((named,)) < preference.of_all((other,))
