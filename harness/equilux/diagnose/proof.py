"""The proof of a hypothesis: the whole picture rendered under it, and compared as any pair is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from equilux.compare import AGREE, DIVERGE, INVALID, PairResult, RenderedImage, compare_pair
from equilux.diagnose.bounds import ERROR_CHANNELS, Floats, PairBounds, Pixels, error_of
from equilux.diagnose.evidence import centres
from equilux.diagnose.trials import Causes, Workshop, shown_with_error
from equilux.uncertainty import Uncertainty
from equilux_tracer import Tracer
from equilux_tracer.causes import ChangedTracer

Mask = npt.NDArray[np.bool_]
Restate = Callable[[ChangedTracer | Tracer], Uncertainty]

ACCEPTED = 0.99
"""Share of the diverging pixels that must come within uncertainty. Not all: a gate, a cone or a total reflection that the
change moves can pass between two pictures' last digits at single pixels, where no edge is declared; and a fitted parameter has an
uncertainty of its own. A cause that is wrong misses far more."""
TELLING = 0.1
"""Share of the explained pixels at which the change's own uncertainty must be smaller than the difference it explains. A curve
or a factor of 1e5 can make a reference so uncertain in the dark that every picture agrees with it: no pixel tells anything
then. It need not be most of them: a spot's far side may show differences of 1e-20, which no changed picture can vouch for."""
BROKEN_SHARE, BROKEN_FEW = 0.01, 2
"""Pixels that agreed and no longer do: at most this share of those explained, or this few."""


@dataclass(frozen=True, eq=False)
class Proof:
    """A picture under causes, held against the renderer's. before, after: classes of the pixels, (h, w). scored: the comparison
    under the causes.
    """

    causes: Causes
    picture: npt.NDArray[np.float64]
    before: npt.NDArray[np.uint8]
    after: npt.NDArray[np.uint8]
    residual_max_abs: float | None
    scored: PairResult

    @property
    def diverging(self) -> int:
        return int((self.before == DIVERGE).sum())

    @property
    def mended(self) -> Mask:
        """(h, w): diverged before and is an agreement or an edge now."""
        return np.asarray((self.before == DIVERGE) & self.within)

    @property
    def within(self) -> Mask:
        """(h, w): the causes account for what the renderer shows there."""
        return np.asarray((self.after != DIVERGE) & (self.after != INVALID))

    @property
    def explained(self) -> float:
        return int(self.mended.sum()) / self.diverging if self.diverging else 0.0

    @property
    def broken(self) -> int:
        return int(((self.before == AGREE) & (self.after == DIVERGE)).sum())

    @property
    def left(self) -> Mask:
        """(h, w): what stays diverging, or does so now."""
        return np.asarray(self.after == DIVERGE)

    @property
    def harmless(self) -> bool:
        """Whether hardly any pixel that agreed is made to diverge."""
        return self.broken <= max(BROKEN_FEW, BROKEN_SHARE * int(self.mended.sum()))

    @property
    def holds(self) -> bool:
        """Whether the causes account for the divergence."""
        return self.explained >= ACCEPTED and self.harmless


@dataclass
class Court:
    """Proves hypotheses about one render of one case; each only once."""

    workshop: Workshop
    side: RenderedImage
    truth: RenderedImage
    scored: PairResult
    restate: Restate | None

    def __post_init__(self) -> None:
        self._known: dict[Causes, Proof | None] = {}

    def proof(self, causes: Causes) -> Proof | None:
        """None where the hypothesis cannot be rendered, or is so uncertain that it says nothing."""
        if causes not in self._known:
            self._known[causes] = self._proved(causes)
        return self._known[causes]

    def _proved(self, causes: Causes) -> Proof | None:
        height, width = self.side.image.shape[:2]
        film_xy = centres(np.arange(height * width), width)
        try:
            changed = self.workshop.changed(causes)
            with np.errstate(all="ignore"):
                with self.workshop.working(len(film_xy)):
                    found = changed.of_scene.evaluate(changed.looked_at(film_xy), ("radiance", *ERROR_CHANNELS))
                radiance, error = shown_with_error(changed, found["radiance"], error_of(found), film_xy)
            stated = self.side.uncertainty if self.restate is None else self.restate(changed)
        except Exception as problem:
            self.workshop.refused[causes] = f"{type(problem).__name__}: {problem}"
            return None
        picture = np.ascontiguousarray(radiance.reshape(height, width, 3))
        if not np.isfinite(picture).all():
            self.workshop.refused[causes] = "the changed picture is not finite"
            return None
        bounds = PairBounds.of(self.side, self.truth, stated)
        error = error + _magnified(changed, found["radiance"], bounds.own, film_xy)
        of_changed = bounds.of_changed(error.reshape(height, width, 3), self.truth.uncertainty.film_px)
        result = compare_pair(
            RenderedImage(self.side.adapter, self.side.image, stated, truth_rank=self.side.truth_rank),
            RenderedImage(self.truth.adapter, picture, of_changed, truth_rank=self.truth.truth_rank),
            changed,
        )
        proof = Proof(causes, picture, self.scored.planes["class"], result.planes["class"], result.json["max_abs"], result)
        mended = np.flatnonzero(proof.mended)
        return proof if self._is_telling(mended, bounds.at(mended, radiance[mended], error[mended])) else None

    def _is_telling(self, mended: Pixels, bound: Floats) -> bool:
        seen, true = (np.asarray(image, np.float64).reshape(-1, 3)[mended] for image in (self.side.image, self.truth.image))
        telling = np.flatnonzero((np.abs(seen - true) > bound).any(axis=1))
        return len(telling) >= TELLING * len(mended)


def _magnified(changed: ChangedTracer, radiance: Floats, own: Floats, film_xy: Floats) -> Floats:
    """What the renderer's own error is more after its picture was encoded than before: a curve is steep in the dark, and a value
    next to a step may have been rounded the other way. (n, 3); 0 where the picture is only scaled or moved.
    """
    here, doubled = changed.shown(radiance, film_xy), changed.shown(2 * radiance, film_xy)
    if np.allclose(doubled, 2 * here, rtol=1e-9, atol=0):
        return np.zeros_like(own)
    _, encoded = shown_with_error(changed, radiance, own, film_xy)
    return np.asarray(np.maximum(np.nan_to_num(encoded) - own, 0))
