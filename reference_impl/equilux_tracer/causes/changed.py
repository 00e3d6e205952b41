"""The reference tracer with rules changed: the same face as `Tracer`, another renderer's behaviour."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_tracer.causes.rule import Applied, Floats, Rule
from equilux_tracer.shading_rules import MODEL_RULES
from equilux_tracer.tracer import Arrays, Tracer


class ChangedTracer:
    """A case as a renderer with these causes would show it. Any number of threads may use it at the same time.

    causes are applied in order: first all that change the scene, then the shading rules, then, as the picture is made, all that
    change where a pixel looks (the last one applied is the outermost), then what it shows. rules: by id. Raises KeyError for an
    id without a rule, TracerError for a scene that cannot be computed with.
    """

    def __init__(
        self, case: Case, causes: Sequence[Applied], rules: Mapping[str, Rule], *, error_target: float = 1e-6,
        tracer: Tracer | None = None,
    ) -> None:  # fmt: skip
        """tracer: of the scene that these causes make, where it has been built before: causes of the picture alone share it."""
        self.case = case
        """The unchanged case."""
        self.causes = tuple(causes)
        self._rules = [(rules[applied.cause], applied) for applied in causes]
        self._tracer = tracer or self._of_changed_scene(error_target)
        self.changed_case = self._tracer.case

    def _of_changed_scene(self, error_target: float) -> Tracer:
        shading = MODEL_RULES
        changed = self.case
        for rule, applied in self._rules:
            changed = rule.change_case(changed, applied)
            shading = rule.change_shading(shading, applied)
        return Tracer(changed, error_target=error_target, rules=shading)

    @property
    def of_scene(self) -> Tracer:
        """The tracer of the changed scene, before anything changes its picture."""
        return self._tracer

    def render(self, channels: Sequence[str] = ("radiance",)) -> Arrays:
        """The whole film; see `Tracer.render`."""
        film = self.case.scene.film
        rows, columns = np.mgrid[0 : film.height, 0 : film.width]
        film_xy = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=-1)
        out = self.evaluate(film_xy, channels)
        return {name: value.reshape(film.height, film.width, *value.shape[1:]) for name, value in out.items()}

    def evaluate(self, film_xy: npt.ArrayLike, channels: Sequence[str] = ("radiance",)) -> Arrays:
        """At film positions (n, 2) in pixels; see `Tracer.evaluate`. Only "radiance" is changed by what changes pixels' values;
        every channel is by what changes where they look."""
        asked = np.asarray(film_xy, np.float64)
        out = self._tracer.evaluate(self.looked_at(asked), channels)
        if "radiance" in out:
            out["radiance"] = self.shown(out["radiance"], asked)
        return out

    def sensitivity(self, normal: Any, position_m: Any) -> Floats:
        """(h, w, 3): see `Tracer.sensitivity`, of what this renderer shows: the largest step that the picture's own rules make of
        a step up or down."""
        film = self.case.scene.film
        rows, columns = np.mgrid[0 : film.height, 0 : film.width]
        asked = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=-1)
        looked_at = self.looked_at(asked)
        moved = self._tracer.sensitivity(normal, position_m, film_xy=looked_at)
        radiance = self._tracer.evaluate(looked_at, ("radiance",))["radiance"]
        here = self.shown(radiance, asked)
        up, down = self.shown(radiance + moved, asked), self.shown(np.maximum(radiance - moved, 0), asked)
        return np.maximum(np.abs(up - here), np.abs(down - here)).reshape(film.height, film.width, 3)

    def looked_at(self, film_xy: Floats) -> Floats:
        """Where on the changed scene's film the picture shows what it shows at film_xy, (n, 2) pixels."""
        return np.ascontiguousarray(self._places(film_xy)[0])

    def shown(self, radiance: Floats, film_xy: Floats) -> Floats:
        """What the picture shows at film_xy where the changed scene's radiance is `radiance`, (n, 3)."""
        for (rule, applied), place in zip(self._rules, self._places(film_xy)[1:], strict=True):
            radiance = rule.change_radiance(radiance, place, self.case, applied)
        return np.ascontiguousarray(radiance, dtype=np.float64)

    def _places(self, film_xy: Floats) -> list[Floats]:
        """First where the film is looked at; then, cause by cause, at which place of the picture made so far it is seen."""
        places = [film_xy]
        for rule, applied in reversed(self._rules):
            places.append(rule.change_film(places[-1], self.case, applied))
        return places[::-1]
