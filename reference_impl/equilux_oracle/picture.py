"""The oracle's pictures: which closed form evaluates which lighting model.

`phong` and `opengl` are local (local_picture.py), `raytraced` follows rays (transport.py), `reflection-equation` integrates over
emitters (the subpackage `emitters`). Each is imported when it is called for.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from equilux_oracle.doubledouble import Array
from equilux_oracle.examination import Examination, pixel_centers
from equilux_oracle.reach import out_of_reach
from equilux_scenes.case import Case
from equilux_scenes.model import Mesh


def supports(case: Case) -> list[str]:
    """The features of a case that have no closed form, sorted; empty where the oracle can be evaluated."""
    return sorted(lacking(case))


def lacking(case: Case) -> Mapping[str, str]:
    """The features of a case that have no closed form, each with the reason."""
    if case.scene.model == "reflection-equation":
        from equilux_oracle import emitters

        return emitters.lacking(case)
    meshes = [shape for shape in case.scene.objects if isinstance(shape, Mesh)]
    if meshes:
        features = ["shape.mesh", *(f"normals.{shape.normals}" for shape in meshes)]
        return dict.fromkeys(features, "a mesh is data, not a formula")
    if case.scene.model == "raytraced":
        from equilux_oracle.affordable import too_deep

        return too_deep(case)
    return {}


def radiance(case: Case) -> Array:
    """The picture of a case: radiance at the pixel centres, W/(m²·sr), (h, w, 3), row 0 on top. Raises ValueError for a mesh."""
    return radiance_with_bound(case)[0]


def radiance_with_bound(case: Case) -> tuple[Array, Array]:
    """The picture, and a hard limit on the absolute error of its arithmetic, both (h, w, 3)."""
    if case.scene.model == "reflection-equation":
        from equilux_oracle import emitters

        return emitters.radiance_with_bound(case)
    film = case.scene.film
    found = examine(case, pixel_centers(film))
    return found.radiance.reshape(film.height, film.width, 3), found.bound.reshape(film.height, film.width, 3)


def evaluate(case: Case, film_xy: npt.ArrayLike) -> Array:
    """Radiance (n, 3) at film positions (n, 2) in pixels, (0.5, 0.5) being the centre of the top left pixel.

    Positions may lie off the film. Raises ValueError for a mesh.
    """
    if case.scene.model == "reflection-equation":
        from equilux_oracle import emitters

        return emitters.evaluate(case, np.asarray(film_xy, dtype=np.float64).reshape(-1, 2))
    return examine(case, film_xy).radiance


def examine(case: Case, film_xy: npt.ArrayLike) -> Examination:
    """Radiance at film positions (n, 2), with its bound and its scale.

    Raises ValueError for a case without a closed form (`lacking`), or with numbers beyond double-double's reach.
    """
    missing = lacking(case)
    if missing:
        raise ValueError(f"{case.name}: no closed form for {', '.join(sorted(missing))} ({'; '.join(set(missing.values()))})")
    unreachable = out_of_reach(case.scene)
    if unreachable:
        raise ValueError(f"{case.name}: {'; '.join(unreachable)}")
    positions = np.asarray(film_xy, dtype=np.float64).reshape(-1, 2)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore", under="ignore"):
        return _examine(case, positions).completed(case.scene)


def _examine(case: Case, positions: Array) -> Examination:
    if case.scene.model == "reflection-equation":
        from equilux_oracle import emitters

        return emitters.examine(case, positions)
    if case.scene.model == "raytraced":
        from equilux_oracle.affordable import examine_within_reason

        return examine_within_reason(case, positions)
    from equilux_oracle.local_picture import examine_local

    return examine_local(case, positions)
