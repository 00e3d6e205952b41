"""POV-Ray on the part of the models `opengl` and `reflection-equation` that it has: against an independent evaluation."""

from __future__ import annotations

import numpy as np
import pytest

from support import plain_raytraced
from support.povray import Run, bound, expressible, pixel_centres, run_all
from support.random_scenes import Spec, case_of, random_spec

PLAIN_TRUTH = 1e-10
"""Relative accuracy of the plain evaluation, in double precision."""
SEEDS = range(6)
SHAPES = ("sphere", "box", "disc", "rectangle", "plane")


def complaints(result: Run) -> list[str]:
    """Every pixel off edges that is farther from the truth than the budget allows, with both numbers."""
    film = result.case.scene.film
    truth = plain_raytraced.radiance(result.case, pixel_centres(result.case))[0].reshape(film.height, film.width, 3)
    wrong = np.argwhere((np.abs(result.image - truth) > bound(result.budget, truth) + PLAIN_TRUTH * truth).any(axis=2))
    if not len(wrong):
        return []
    edge = plain_raytraced.on_edge(result.case, wrong[:, ::-1] + 0.5, max(1e-6, result.budget.film_px))
    return [
        f"{result.case.name} at ({x}, {y}): povray {result.image[y, x]}, truth {truth[y, x]}"
        for (y, x), excused in zip(wrong, edge, strict=True) if not excused
    ]


def fixed_function(seed: int, orthographic: bool) -> Spec:
    """V to the eye point in perspective views, against the view direction in orthographic ones; lights of one colour."""
    options = {"fov_deg": None} if orthographic else {}
    spec = expressible(random_spec(6000 + seed, shapes=SHAPES, exponents=(0.05, 128.0), **options))
    if seed == 0:
        spec["materials"]["m0"]["exponent"] = 0.0
    for share, light in enumerate(spec["lights"].values()):
        light["diffuse"] = light["specular"] = [0.5, 1.0, 0.25 * share]
    return {**spec, "model": "opengl", "viewer": "infinite" if orthographic else "local"}


@pytest.mark.parametrize("orthographic", [False, True])
def test_the_fixed_function_model_agrees(orthographic, tmp_path):
    cases = [case_of(fixed_function(seed, orthographic)) for seed in SEEDS]
    problems = [line for result in run_all(cases, tmp_path) for line in complaints(result)]
    assert not problems, "\n".join(problems[:10])


def direct(seed: int) -> Spec:
    """Lights without extent, and shadows."""
    spec = expressible(random_spec(6100 + seed, shapes=("sphere", "box", "disc", "cylinder", "plane"), objects=(3, 6)))
    for name, material in spec["materials"].items():
        del material["ambient"]
        if name == "m0":
            del material["specular"], material["exponent"]
            material["brdf"] = "lambert"
    return {key: value for key, value in spec.items() if key != "ambient"} | {"model": "reflection-equation"}


def test_direct_light_of_lights_without_extent_agrees(tmp_path):
    problems = [line for result in run_all([case_of(direct(seed)) for seed in SEEDS], tmp_path) for line in complaints(result)]
    assert not problems, "\n".join(problems[:10])
