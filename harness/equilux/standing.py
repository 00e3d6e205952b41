"""A render judged three ways (comparison.md): against the truth, against what its adapter declares, against its peers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal

from equilux.diagnose.diagnosis import Diagnosis, Found
from equilux.judge import UNEXPLAINED
from equilux.results import Finding, Standing
from equilux.trust import TRUTHS

Verdict = Literal["agree", "diverge"]


def standing_of(
    adapter: str, truth: str | None, pairs: Iterable[Mapping[str, Any]], diagnosis: Diagnosis | None, *, was_diagnosed: bool
) -> Standing | None:
    """How a delivered render stands; None for a truth, and where there was no truth that it could be compared with.

    pairs: all of the case. diagnosis: None where the render was not diagnosed, which has a reason in `was_diagnosed` False (the
    user said so, or the run was stopped), or in the pair (another size, a fault of the diagnosis).
    """
    own = {pair["a"] if pair["b"] == adapter else pair["b"]: pair for pair in pairs if adapter in (pair["a"], pair["b"])}
    against = own.get(truth or "")
    if adapter in TRUTHS or against is None or against["verdict"] == "not-comparable":
        return None
    others = {name: pair["verdict"] for name, pair in sorted(own.items()) if name not in TRUTHS}
    peers: dict[str, Verdict] = {name: verdict for name, verdict in others.items() if verdict != "not-comparable"}
    if against["verdict"] == "agree":
        return Standing(truth="agree", peers=peers, finding="as-modelled", reason=f"agrees with the {truth}")
    if diagnosis is None:
        reason = (against["reason"] or "no cause could be looked for") if was_diagnosed else "it was not diagnosed"
        return Standing(truth="diverge", peers=peers, finding="unexplained", reason=reason)
    finding, reason = _finding(diagnosis)
    return Standing(truth="diverge", dialect=diagnosis.dialect, peers=peers, finding=finding, reason=reason)


def _finding(diagnosis: Diagnosis) -> tuple[Finding, str]:
    proven = diagnosis.proven
    if not proven:
        return "unexplained", "no named cause accounts for the divergence"
    left = "" if not _left(diagnosis) else f"; {_share(1 - diagnosis.explained)} of the diverging pixels stay unexplained"
    if diagnosis.dialect == "agree":
        return "model-difference", f"departs from the scene's model as declared: {_named(proven)}"
    undeclared = [cause for cause in proven if not cause.declared]
    if undeclared and all(cause.suspects == "translation" for cause in undeclared):
        return "translation-bug", f"{_named(undeclared)}: more likely the translation's fault than the renderer's{left}"
    what = f"not declared: {_named(undeclared)}" if undeclared else f"not as declared: {_named(proven)}"
    return "implementation-bug", what + left


def _left(diagnosis: Diagnosis) -> bool:
    return any(cause.id == UNEXPLAINED for cause in diagnosis.causes)


def _named(causes: Iterable[Found]) -> str:
    return ", ".join(cause.id for cause in causes)


def _share(part: float) -> str:
    """A share that is not 0 never shows as 0."""
    return f"{max(part, 0):.1%}" if part >= 0.0005 else "less than 0.1%"
