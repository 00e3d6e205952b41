"""Edges on real pictures: a boundary within δ of a pixel's centre is excused, and no known fault hides behind that."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from equilux.budget import Bound, Budget, Geometric
from equilux.compare import DIVERGE, EDGE, PairResult, RenderedImage, compare_pair
from equilux.edges import MAXIMUM_DELTA_PX
from equilux.uncertainty import stated
from equilux_tracer import Tracer
from support.random_scenes import case_of

Spec = dict[str, Any]

SCENE: Spec = {
    "equilux": 1,
    "name": "edges",
    "model": "phong",
    "camera": {"projection": "perspective", "eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_deg": 30},
    "film": {"width": 128, "height": 96},
    "background": [0.1, 0.1, 0.1],
    "lights": {"key": {"kind": "point", "position": [0.3, 2, 3], "intensity": [7.5, 7.5, 7.5]}},
    "materials": {"clay": {"diffuse": [0.6, 0.5, 0.4], "specular": [0.5, 0.5, 0.5], "exponent": 20}},
    "objects": [{"kind": "sphere", "center": [0, 0, 0], "radius": 0.5, "material": "clay"}],
}
"""The measured test scene, its light a little aside."""

POSTER: Spec = {
    **copy.deepcopy(SCENE),
    "lights": {},
    "materials": {"clay": {"emission": [0.7, 0.7, 0.7]}, "other": {"emission": [0.3, 0.4, 0.5]}},
    "objects": [
        {"kind": "sphere", "center": [0.1, 0.05, 0], "radius": 0.5, "material": "clay"},
        {"kind": "box", "min": [-0.9, -0.6, -1.0], "max": [-0.2, 0.5, -0.5], "material": "other",
         "transform": [{"rotate": {"axis": [0, 0, 1], "degrees": 17}}]},
    ],
}  # fmt: skip
"""Flat colours: only silhouettes can differ."""

LAMP: Spec = {
    **copy.deepcopy(SCENE),
    "lights": {
        "lamp": {"kind": "spot", "position": [0.3, 0.2, 2], "direction": [-0.1, -0.1, -1], "intensity": [5, 5, 5],
                 "cone_half_angle_deg": 12.0, "attenuation": {"constant": 1}},
    },
    "materials": {"chalk": {"specular": [0.5, 0.4, 0.3], "exponent": 0}},
    "objects": [{"kind": "plane", "point": [0, 0, 0], "normal": [0.1, 0.2, 1], "material": "chalk"}],
}  # fmt: skip
"""The boundary of a spot on a wall. (R·V)^0 and constant attenuation: flat inside, black outside."""


def judged(spec: Spec, image: npt.NDArray[np.float64], *, film_px: float = MAXIMUM_DELTA_PX, abs_: float = 1e-6) -> PairResult:
    """A picture against the reference's own of the scene."""
    tracer = Tracer(case_of(spec))
    truth = tracer.render()["radiance"]
    budget = Budget((Bound("flat", "chosen", abs=abs_), Geometric("raster", "chosen", film_px=film_px)))
    a = RenderedImage("vtk", image, stated(budget, image, tracer))
    return compare_pair(a, RenderedImage("reference", truth, stated(Budget((Bound("own", "", rel=1e-12),)), truth)), tracer)


def shifted(spec: Spec, dx: float, dy: float = 0.0) -> npt.NDArray[np.float64]:
    """What a renderer sees whose film is displaced by (dx, dy) pixels."""
    film = spec["film"]
    y, x = np.mgrid[: film["height"], : film["width"]] + 0.5
    film_xy = np.stack([(x + dx).ravel(), (y + dy).ravel()], axis=-1)
    return Tracer(case_of(spec)).evaluate(film_xy)["radiance"].reshape(film["height"], film["width"], 3)


def altered(spec: Spec, path: str, value: Any) -> Spec:
    """The scene with one number replaced; path: keys and indices between dots."""
    out = copy.deepcopy(spec)
    *parents, last = path.split(".")
    place: Any = out
    for key in parents:
        place = place[int(key) if isinstance(place, list) else key]
    place[last] = value
    return out


def picture(spec: Spec) -> npt.NDArray[np.float64]:
    return np.asarray(Tracer(case_of(spec)).render()["radiance"])


FAULTS = {
    "half a pixel to the right": (POSTER, lambda: shifted(POSTER, 0.5)),
    "half a pixel down": (POSTER, lambda: shifted(POSTER, 0.0, 0.5)),
    "half a pixel, pixel corners": (POSTER, lambda: shifted(POSTER, 0.5, 0.5)),
    "radius 1 % too large": (POSTER, lambda: picture(altered(POSTER, "objects.0.radius", 0.505))),
    "radius 1 % too small": (POSTER, lambda: picture(altered(POSTER, "objects.0.radius", 0.495))),
    "field of view 0.5° too wide": (POSTER, lambda: picture(altered(POSTER, "camera.fov_y_deg", 30.5))),
    "field of view 0.5° too narrow": (POSTER, lambda: picture(altered(POSTER, "camera.fov_y_deg", 29.5))),
    "cone 1 % too wide": (LAMP, lambda: picture(altered(LAMP, "lights.lamp.cone_half_angle_deg", 12.12))),
    "half a pixel along a cone's boundary": (LAMP, lambda: shifted(LAMP, 0.5)),
    "half a pixel on a shaded ball": (SCENE, lambda: shifted(SCENE, 0.5)),
    "radius 1 % too large on a shaded ball": (SCENE, lambda: picture(altered(SCENE, "objects.0.radius", 0.505))),
    "field of view 0.5° on a shaded ball": (SCENE, lambda: picture(altered(SCENE, "camera.fov_y_deg", 30.5))),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_displaced_picture_never_hides_among_edges(fault: str) -> None:
    """Even with the largest δ there is: most of the wrong pixels lie farther than that from a boundary."""
    spec, render = FAULTS[fault]
    pair = judged(spec, render()).json
    assert pair["verdict"] == "diverge"
    assert pair["diverge"] > pair["edge"], f"{fault}: {pair['diverge']} pixels diverge, {pair['edge']} are excused"


@pytest.mark.parametrize("spec", [POSTER, LAMP], ids=["silhouettes and creases", "spot boundary"])
@pytest.mark.parametrize("displacement", [0.003, 0.03, 0.09])
def test_boundaries_within_delta_are_excused(spec: Spec, displacement: float) -> None:
    found = 0
    for angle in np.radians([0, 45, 160, 250]):
        image = shifted(spec, displacement * np.cos(angle), displacement * np.sin(angle))
        pair = judged(spec, image, film_px=displacement / 0.92)  # as far as eight points on a ring are sure to see
        assert pair.json["diverge"] == 0, f"{pair.json['diverge']} pixels diverge, worst {pair.json['worst']}"
        found += pair.json["edge"]
    assert found > 0 or displacement < 0.01, "no pixel was near enough to a boundary to be tested"


def test_a_displacement_beyond_the_stated_delta_is_not_excused() -> None:
    pair = judged(POSTER, shifted(POSTER, 0.09), film_px=0.01)
    assert pair.json["diverge"] > 10


@pytest.mark.parametrize(
    ("path", "value"),
    [("materials.clay.exponent", 22), ("materials.clay.exponent", 20.1), ("materials.clay.specular", [0.5, 0.5, 0.505]),
     ("materials.clay.diffuse", [0.606, 0.5, 0.4]), ("lights.key.intensity", [7.5, 7.6, 7.5])],
)  # fmt: skip
def test_a_wrong_value_on_a_smooth_surface_is_never_excused(path: str, value: Any) -> None:
    """Of the pixels that a wrong material or light changes, those whose surroundings hold no boundary all diverge."""
    image, truth = picture(altered(SCENE, path, value)), picture(SCENE)
    pair = judged(SCENE, image)
    wrong = (np.abs(image - truth) > 1.1e-6).any(axis=2)
    near_boundary = pair.planes["class"] == EDGE
    tracer = Tracer(case_of(SCENE))
    hit = tracer.render(("object_id",))["object_id"] >= 0
    gate = shifted_signature_differs(tracer)
    assert not (near_boundary & ~gate).any(), "an edge was found where no boundary is within 0.1 pixel"
    assert (pair.planes["class"][wrong & hit & ~gate] == DIVERGE).all()
    assert pair.json["diverge"] > 100


def shifted_signature_differs(tracer: Tracer) -> npt.NDArray[np.bool_]:
    """(h, w): whether the path signature changes anywhere within 0.1 pixel of the centre, asked on a fine grid."""
    film = tracer.case.scene.film
    y, x = np.mgrid[: film.height, : film.width] + 0.5
    centre = tracer.render(("signature",))["signature"]
    differs = np.zeros(centre.shape, np.bool_)
    for radius in (0.05, 0.1):
        for angle in np.linspace(0, 2 * np.pi, 16, endpoint=False):
            film_xy = np.stack([(x + radius * np.cos(angle)).ravel(), (y + radius * np.sin(angle)).ravel()], axis=-1)
            differs |= tracer.evaluate(film_xy, ("signature",))["signature"].reshape(centre.shape) != centre
    return differs


def test_a_wrong_value_right_on_a_silhouette_is_not_excused() -> None:
    """An antialiased silhouette blends both sides; within δ of the boundary it is on neither."""
    image = (shifted(POSTER, 0.09) + picture(POSTER)) / 2
    pair = judged(POSTER, image)
    blended = (np.abs(shifted(POSTER, 0.09) - picture(POSTER)) > 1e-3).any(axis=2)
    assert pair.json["diverge"] == blended.sum() > 0
    assert pair.json["edge"] == 0


def test_one_wrong_pixel_on_the_highlights_peak_is_found() -> None:
    image = picture(SCENE)
    peak = np.unravel_index(np.argmax(image[..., 0]), image.shape[:2])
    image[peak] *= 1 + 1e-5
    pair = judged(SCENE, image)
    assert (pair.json["diverge"], pair.json["edge"]) == (1, 0)
    assert (pair.json["worst"]["y"], pair.json["worst"]["x"]) == peak


def test_a_missing_gate_is_not_excused_along_the_terminator() -> None:
    """Radiance beyond the terminator where there should be none: only the strip within δ of it may be excused."""
    spec = altered(SCENE, "lights.key.position", [2.5, 0.0, 0.0])
    image = picture(spec)
    dark = image[..., 0] == 0
    image[dark] += 0.05
    pair = judged(spec, image)
    assert pair.json["diverge"] > 0.95 * dark.sum()


def test_geometric_bounds_cover_a_tilted_normal_and_no_more() -> None:
    """A sphere whose centre is off by δP shades as if its normals were off by δP / r: within the stated bound, and near it."""
    step = 1e-4
    moved = picture(altered(SCENE, "objects.0.center", [step, 0, 0]))
    tracer = Tracer(case_of(SCENE))
    truth = tracer.render()["radiance"]
    inside = tracer.render(("normal",))["normal"][..., 2] > 0.5
    budget = Budget((Geometric("off centre", "chosen", normal=2 * step / 0.5, position_m=2 * step),))
    bound = stated(budget, moved, tracer).bound(moved)
    error = np.abs(moved - truth)
    lit = inside[..., None] & (bound > 0)
    ratio = float((error[lit] / bound[lit]).max())
    assert (error[inside] <= bound[inside]).all()
    assert 0.1 < ratio <= 1, f"the largest error is {ratio} of the propagated bound"
