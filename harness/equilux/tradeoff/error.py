"""How far a picture is from the truth: outside edges, over the largest radiance of the truth; and from the truth under what the
renderer declares to do otherwise."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from equilux import score, uncertainty
from equilux.adapter import Bound, Budget, Case, Image
from equilux.claim import claimed
from equilux.compare import RenderedImage, compare_pair
from equilux.dialect import Declared, dialect_on
from equilux.tradeoff.record import Error
from equilux.trust import TRUTHS
from equilux.uncertainty import stated


@dataclass
class Judge:
    """What the pictures of one case are held against. dialects: what each adapter declares; rules: by cause."""

    case: Case
    dialects: Mapping[str, Sequence[Declared]]
    rules: Mapping[str, Any]
    _changed: dict[str, tuple[RenderedImage, Any] | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        from equilux_tracer import Tracer

        self.tracer = Tracer(self.case)
        self.truth = score.truth_of(self.case, self.tracer)
        self.largest = float(np.abs(self.truth.image).max())

    def side(self, adapter: str, image: Image, budget: Budget) -> RenderedImage:
        """A picture with what its renderer states. Raises ValueError for a budget that does not fit it."""
        return RenderedImage(adapter, image, stated(budget, image, self.tracer), truth_rank=len(TRUTHS))

    def error(self, side: RenderedImage) -> Error:
        """Against the truth."""
        return self._error(side, self.truth, self.tracer)

    def error_to_dialect(self, side: RenderedImage) -> Error | None:
        """Against the reference under what the adapter declares; None where nothing declared changes this picture."""
        changed = self._changed_for(side.adapter)
        return None if changed is None else self._error(side, *changed)

    def dialect(self, adapter: str) -> list[str]:
        """The declared rules that change this picture, in words."""
        changed = self._changed_for(adapter)
        return [] if changed is None else [str(applied) for applied in changed[1].causes]

    def claimed(self, side: RenderedImage) -> float | None:
        return claimed(side.image, side.uncertainty).relative

    def _error(self, side: RenderedImage, truth: RenderedImage, tracer: Any) -> Error:
        pair = compare_pair(side, truth, tracer).json
        kinds = {kind: count for kind, count in pair["invalid_kinds"]["a"].items() if count}
        largest = float(np.abs(truth.image).max())
        max_abs = pair["max_abs"]
        return Error(
            against=truth.adapter,
            max_rel=_ratio(max_abs, largest) if not kinds else None,
            max_abs=max_abs,
            rms=pair["rms"],
            pixels=pair["pixels"],
            edge=pair["edge"],
            beyond=pair["diverge"],
            not_numbers=kinds,
        )

    def _changed_for(self, adapter: str) -> tuple[RenderedImage, Any] | None:
        if adapter not in self._changed:
            self._changed[adapter] = self._made_changed(adapter)
        return self._changed[adapter]

    def _made_changed(self, adapter: str) -> tuple[RenderedImage, Any] | None:
        from equilux_tracer import TracerError
        from equilux_tracer.causes import ChangedTracer

        applied = dialect_on(self.case, self.dialects.get(adapter, ()), self.rules)
        found: tuple[RenderedImage, Any] | None = None
        chosen: list[Any] = []
        before = self.truth.image
        for each in applied:
            try:
                tracer = ChangedTracer(self.case, (*chosen, each), self.rules)
                arrays = tracer.render(("radiance", "rounding"))
            except (TracerError, ValueError, KeyError, TypeError):
                continue  # its number depends on the scene and is not declared: the error against the truth stands
            image = arrays["radiance"]
            if not np.all(np.abs(image - before) <= 2 * arrays["rounding"] + 1e-9 * self.largest):
                chosen.append(each)
                bound = Budget((Bound("arithmetic", "rounding of the evaluation", abs=arrays["rounding"]),))
                found = RenderedImage(f"{TRUTHS[1]} as declared", image, uncertainty.stated(bound, image), truth_rank=1), tracer
                before = image
        return found


def _ratio(part: float | None, whole: float) -> float | None:
    """Of a difference to the largest radiance; a picture that is black all over has no scale, and only 0 is 0 of it."""
    if part is None:
        return None
    ratio = part / whole if whole > 0 else (0.0 if part == 0 else math.inf)
    return ratio if math.isfinite(ratio) else None
