"""Rendering axes: every value, with every renderer, in the first lighting model that the renderer can express."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from equilux.adapter import Case, Knobs
from equilux.extremes.axis import Axis
from equilux.plan import RUN, Plan, PlannedRender, Selection, make_plan
from equilux.trust import TRUTHS


@dataclass(frozen=True)
class Lane:
    """One renderer on one axis. model: what its scenes are written in; None where it can express none of the axis's, and then
    `reason` says what it lacks."""

    axis: Axis
    adapter: str
    model: str | None
    reason: str = ""


@dataclass(frozen=True)
class Push:
    """What is to be rendered. cases: by axis name, model and value."""

    axes: tuple[Axis, ...]
    lanes: tuple[Lane, ...]
    cases: Mapping[tuple[str, str, float], Case]
    plan: Plan


def make_push(axes: Sequence[Axis], selection: Selection, knobs: Mapping[str, Knobs]) -> Push:
    """Decide for every axis and renderer which scenes it gets. Probes each adapter once.

    The truths render whatever any renderer is given, and are measured themselves in the axis's first model that is rendered.
    """
    lanes = _lanes(axes, selection, knobs)
    wanted = {(lane.axis.name, lane.model): lane.axis for lane in lanes if lane.model is not None}
    cases = {
        (name, model, value): axis.case(value, model)
        for (name, model), axis in wanted.items()
        if model is not None
        for value in axis.values_in(model)
    }
    renderers = {key: {lane.adapter for lane in lanes if (lane.axis.name, lane.model) == key} for key in wanted}
    asked = {case.name: renderers[name, model] | set(TRUTHS) for (name, model, _), case in cases.items()}
    full = make_plan(tuple(cases.values()), selection, knobs)
    renders = tuple(render for render in full.renders if render.adapter in asked[render.case.name])
    plan = Plan(full.cases, full.entries, renders, full.knobs, full.named, full.added)
    return Push(tuple(axes), lanes, cases, plan)


def _lanes(axes: Sequence[Axis], selection: Selection, knobs: Mapping[str, Knobs]) -> tuple[Lane, ...]:
    """Judged by the benign value: what cannot be expressed there cannot be pushed."""
    benign = {(axis.name, model): axis.case(axis.benign, model) for axis in axes for model in axis.models}
    planned = {
        (render.case.name, render.adapter): render for render in make_plan(tuple(benign.values()), selection, knobs).renders
    }
    lanes: list[Lane] = []
    for axis in axes:
        own = [_lane(axis, entry.name, benign, planned) for entry in selection.entries if entry.name not in TRUTHS]
        used = [model for model in axis.models if any(lane.model == model for lane in own)]
        for entry in selection.entries:
            if entry.name in TRUTHS:
                own.append(_lane(axis, entry.name, benign, planned, used or list(axis.models)))
        lanes += own
    return tuple(lanes)


def _lane(
    axis: Axis, adapter: str, benign: Mapping[tuple[str, str], Case], planned: Mapping[tuple[str, str], PlannedRender],
    models: Sequence[str] | None = None,
) -> Lane:  # fmt: skip
    """The first model that the adapter can express; one that cannot run at all gets the first, where it shows as such."""
    reasons = []
    for model in models or axis.models:
        render = planned[benign[axis.name, model].name, adapter]
        if render.action != "unsupported":
            return Lane(axis, adapter, model)
        reasons.append(f"{model}: {render.reason}")
    return Lane(axis, adapter, None, "; ".join(reasons))


def is_renderable(push: Push) -> bool:
    """Whether anything at all would be rendered."""
    return any(render.action == RUN for render in push.plan.renders)
