"""What must hold between the values of one part, beyond each value's own type and whatever the lighting model.

Checks of whole scenes look at nodes, so that one wrong value hides no other error.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np

from equilux_scenes.causes import CAUSES, is_known
from equilux_scenes.checking import Context, Problem, check
from equilux_scenes.errors import hint, number_text, shortened
from equilux_scenes.expectation import Comparison, WhenError, parse_when
from equilux_scenes.lecture import ROWS
from equilux_scenes.limits import exceeded
from equilux_scenes.model import (
    Attenuation,
    Box,
    Cylinder,
    Expectation,
    Film,
    OrthographicCamera,
    PerspectiveCamera,
    Rectangle,
    RectangleEmitter,
    Scene,
    Shape,
    TransformStep,
)
from equilux_scenes.shown import shown
from equilux_scenes.transforms import matrix_of, unit
from equilux_scenes.yaml_tree import ListNode, MapNode, Node, Place, ScalarNode

PARALLEL = 1e-8
"""Sine of an angle below which two directions count as parallel: their cross product has lost half of its digits."""

ORTHOGONAL = 1e-9
"""Cosine of an angle below which two edges count as orthogonal: hand-computed sines and cosines reach it, a slip does not."""

SINGULAR = 1e-12
"""Ratio of a matrix's smallest to largest stretch below which its inverse has fewer than four digits."""


def _difference(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, float, float]:
    """Direction from b to a; halved first, so that it cannot overflow."""
    x, y, z = (p / 2 - q / 2 for p, q in zip(a, b, strict=True))
    return x, y, z


def _sine(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    return float(np.linalg.norm(np.cross(unit(a), unit(b))))


# --- camera and film --------------------------------------------------------------------------------------------------


@check(PerspectiveCamera, OrthographicCamera, needs=("eye", "target"))
def _eye_apart_from_target(camera: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if not any(_difference(camera.target, camera.eye)):
        yield Problem(("target",), "another point than the eye")


@check(PerspectiveCamera, OrthographicCamera, needs=("eye", "target", "up"))
def _up_across_the_view(camera: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    forward = _difference(camera.target, camera.eye)
    if any(forward) and _sine(camera.up, forward) <= PARALLEL:
        yield Problem(("up",), "a direction not parallel to the view", "" if "up" in node.entries else " (give 'up')")


@check(Film, needs=("width", "height"))
def _pixels_within_limit(film: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    pixels = film.width * film.height
    if pixels > context.limits.pixels:
        yield Problem((), message=exceeded("pixels", pixels, context.limits.pixels, "pixels of film"))


# --- lights -----------------------------------------------------------------------------------------------------------


@check(Attenuation, needs=("constant", "linear", "quadratic"))
def _attenuation_stays_positive(terms: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if terms.constant == terms.linear == terms.quadratic == 0:
        yield Problem((), "at least one term > 0 (the light would be infinitely bright)")


# --- objects ----------------------------------------------------------------------------------------------------------


@check(Box, needs=("min", "max"))
def _box_has_volume(box: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    for axis, (low, high) in enumerate(zip(box.min, box.max, strict=True)):
        if low >= high:
            yield Problem(("max", axis), f"a number > {number_text(low)}, which is min[{axis}]")


@check(Cylinder, needs=("base", "top"))
def _cylinder_has_length(cylinder: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if not any(_difference(cylinder.top, cylinder.base)):
        yield Problem(("top",), "another point than the base")


@check(Rectangle, RectangleEmitter, needs=("edge_u", "edge_v"))
def _edges_orthogonal(rectangle: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    cosine = sum(a * b for a, b in zip(unit(rectangle.edge_u), unit(rectangle.edge_v), strict=True))
    if abs(cosine) > ORTHOGONAL:
        degrees = math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
        yield Problem(("edge_v",), f"an edge orthogonal to edge_u (it makes {degrees:.9g}° with it)")


@check(TransformStep, needs=("scale", "rotate", "translate", "matrix"))
def _one_kind_of_step(step: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if len(node.entries) != 1:
        yield Problem((), "exactly one of scale, rotate, translate, matrix")


@check(TransformStep, needs=("matrix",))
def _matrix_is_affine(step: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if step.matrix is not None and step.matrix[3] != (0.0, 0.0, 0.0, 1.0):
        yield Problem(("matrix", 3), "[0, 0, 0, 1] as the last row (points stay points)")


@check(Shape, needs=("transform",))
def _transform_can_be_undone(shape: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if not shape.transform:
        return
    with np.errstate(over="ignore", invalid="ignore"):
        product = matrix_of(shape.transform)
    if not np.isfinite(product).all():
        yield Problem(("transform",), "steps whose product stays finite")
        return
    stretches = np.linalg.svd(product[:3, :3], compute_uv=False)
    if stretches[2] <= SINGULAR * stretches[0]:
        yield Problem(("transform",), "a transform that can be undone (this one flattens the object)")


# --- the scene --------------------------------------------------------------------------------------------------------


@check(Scene)
def _materials_are_defined(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    materials, objects = node.entries.get("materials"), node.entries.get("objects")
    if not isinstance(objects, ListNode) or not isinstance(materials, MapNode | None):
        return
    known = materials.entries if materials is not None else {}
    for index, obj in enumerate(objects.items):
        named = obj.entries.get("material") if isinstance(obj, MapNode) else None
        if isinstance(named, ScalarNode) and isinstance(named.value, str) and named.value not in known:
            allowed = ", ".join(known) or "a material of the scene, which has none"
            yield Problem(("objects", index, "material"), allowed, hint(named.value, known))


_AXIS_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]{0,39}\Z")
_PRINTABLE_NAME = re.compile(r"[^\x00-\x1f\x7f-\x9f\u2028\u2029]{1,100}\Z")


@check(Scene)
def _names_are_usable(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    kinds = (
        ("lights", "light", _PRINTABLE_NAME, "1 to 100 printable characters"),
        ("materials", "material", _PRINTABLE_NAME, "1 to 100 printable characters"),
        ("sweep", "sweep axis", _AXIS_NAME, "a letter, then letters, digits, - or _, at most 40"),
    )
    for group, what, pattern, allowed in kinds:
        named = node.entries.get(group)
        for name, place in named.keys.items() if isinstance(named, MapNode) else ():
            if not pattern.match(name) or (group == "sweep" and name in ("and", "or")):
                yield Problem((), message=f"name of {what}: got '{shortened(name)}', allowed {allowed}", place=place)


@check(Scene, needs=("shows",))
def _rows_of_the_lecture_exist(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    for index, row_id in enumerate(scene.shows):
        if row_id not in ROWS:
            yield Problem(("shows", index), "the id of a row of the lecture", hint(row_id, ROWS))


# --- expectations -----------------------------------------------------------------------------------------------------


@check(Expectation, needs=("cause",))
def _cause_exists(expectation: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if not is_known(expectation.cause):
        note = hint(expectation.cause, CAUSES, otherwise=" (a third party's own is written name:cause)")
        yield Problem(("cause",), "a known cause id", note)


@check(Scene)
def _whens_compare_axes_with_numbers(scene: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    expect, sweep = node.entries.get("expect"), node.entries.get("sweep")
    axes = sweep.entries if isinstance(sweep, MapNode) else {}
    for index, item in enumerate(expect.items if isinstance(expect, ListNode) else ()):
        when = item.entries.get("when") if isinstance(item, MapNode) else None
        if isinstance(when, ScalarNode) and isinstance(when.value, str):
            try:
                comparisons = parse_when(when.value).comparisons
            except WhenError as failed:
                yield Problem((), message=f"when of expectation {index}: {failed}", place=_inside_text(when, failed.offset))
                continue
            for comparison in comparisons:
                yield from _axis_is_number(comparison, index, when, axes)


def _axis_is_number(comparison: Comparison, index: int, when: ScalarNode, axes: dict[str, Node]) -> Iterator[Problem]:
    place = _inside_text(when, comparison.offset)
    what = f"when of expectation {index}"
    if comparison.axis not in axes:
        known = ", ".join(axes) or "none, as the scene has no sweep"
        message = f"{what}: unknown sweep axis '{shortened(comparison.axis)}', allowed {known}{hint(comparison.axis, axes)}"
        yield Problem((), message=message, place=place)
        return
    axis = axes[comparison.axis]
    values = axis.entries.get("values") if isinstance(axis, MapNode) else None
    for value in values.items if isinstance(values, ListNode) else ():
        if not is_number(value):
            allowed = f"an axis whose values are all numbers (one is {shown(value)})"
            yield Problem((), message=f"{what}: got axis '{shortened(comparison.axis)}', allowed {allowed}", place=place)
            return


def is_number(node: Node) -> bool:
    """Whether a value is a number (true and false are not)."""
    return isinstance(node, ScalarNode) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def _inside_text(node: ScalarNode, offset: int) -> Place:
    """The place of a character of a text; exact for text on one line without escapes."""
    return Place(node.place.line, node.place.column + offset + (1 if node.quoted else 0), node.place.start, node.place.end)
