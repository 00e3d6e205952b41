"""A valid spec with every kind of part, and how tests say where an error belongs: by a « in the text, just before the place."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from equilux_scenes.limits import Limits
from equilux_scenes.loader import SceneFile, SpecError, SpecErrors, corpus_folder, load_scene_text, load_scenes

MARK = "«"

VALID = """\
equilux: 1
name: every-part
about: Every kind of part once.
model: phong
camera: {projection: perspective, eye: [0, 0, 3], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 30}
film: {width: 64, height: 48}
ambient: [0.1, 0.2, 0.3]
background: 0.25
lights:
  key:
    kind: point
    position: [0, 2, 3]
    intensity: [7.5, 7.5, 7.5]
    attenuation: {constant: 0, linear: 0, quadratic: 1}
  sun: {kind: directional, direction: [0, -1, 0], irradiance: 1}
  lamp: {kind: spot, position: [0, 2, 0], direction: [0, -1, 0], intensity: 5, cone_half_angle_deg: 20, exponent: 4}
materials:
  clay: {diffuse: [0.6, 0.6, 0.6], specular: 0.5, exponent: 20, ambient: 0.1, emission: 0.01}
objects:
  - {kind: sphere, center: [0, 0, 0], radius: 0.5, material: clay}
  - {kind: plane, point: [0, -0.5, 0], normal: [0, 1, 0], material: clay}
  - {kind: box, min: [-1, -2, -3], max: [1, 2, 3], material: clay}
  - {kind: disc, center: [0, 0, 0], normal: [0, 1, 0], radius: 1, material: clay}
  - {kind: rectangle, corner: [0, 0, 0], edge_u: [1, 0, 0], edge_v: [0, 1, 0], material: clay}
  - {kind: cylinder, base: [0, 0, 0], top: [0, 1, 0], radius: 0.3, capped: true, material: clay}
  - kind: mesh
    normals: smooth
    vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    faces: [[0, 1, 2]]
    vertex_normals: [[0, 0, 1], [0, 0, 2], [0, 0, 3]]
    material: clay
    transform: [{scale: 2}, {rotate: {axis: [0, 1, 0], degrees: 30}}, {translate: [0, 0, 1]}]
sweep:
  exponent: {path: materials.clay.exponent, values: [1, 10, 100, 1000]}
expect:
  - {adapter: vtk, cause: exponent-clamped, when: "exponent > 128"}  # VTK clamps it
"""


@pytest.fixture(scope="session")
def valid() -> str:
    """The text of a spec that loads and has every kind of part."""
    return VALID


@pytest.fixture(scope="session")
def corpus() -> list[SceneFile]:
    """Every scene that is shipped; read once, as that takes a second."""
    return load_scenes([corpus_folder()])


@pytest.fixture(scope="session")
def edited() -> Callable[..., str]:
    """edited(old, new, …) → the valid spec with each `old`, which must be there exactly once, replaced."""

    def edit(*pairs: str) -> str:
        text = VALID
        for old, new in zip(pairs[::2], pairs[1::2], strict=True):
            assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in the valid spec"
            text = text.replace(old, new)
        return text

    return edit


@pytest.fixture(scope="session")
def load() -> Callable[..., SceneFile]:
    """Loads a text."""

    def load(text: str, folder: Path | None = None, **limits: int) -> SceneFile:
        return load_scene_text(text, "spec.yaml", folder, Limits(**limits))

    return load


@pytest.fixture(scope="session")
def errors_of() -> Callable[..., list[SpecError]]:
    """The errors of a text that must have some; every one of them is on one line and at a place of the text."""

    def errors_of(text: str, folder: Path | None = None, **limits: int) -> list[SpecError]:
        with pytest.raises(SpecErrors) as caught:
            load_scene_text(text, "spec.yaml", folder, Limits(**limits))
        errors = list(caught.value.errors)
        assert errors
        for error in errors:
            assert len(str(error).splitlines()) == 1, repr(str(error))
            assert error.line >= 1, error
            assert error.column >= 1, error
        return errors

    return errors_of


@pytest.fixture(scope="session")
def only_error(errors_of: Callable[..., list[SpecError]]) -> Callable[..., str]:
    """The message of the only error of a text, after checking that it stands where the text has its «."""

    def only_error(text: str, folder: Path | None = None, **limits: Any) -> str:
        assert text.count(MARK) == 1, "say with one « where the error belongs"
        before = text[: text.index(MARK)]
        place = (before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1)
        errors = errors_of(text.replace(MARK, ""), folder, **limits)
        assert len(errors) == 1, "\n".join(map(str, errors))
        assert (errors[0].line, errors[0].column) == place, f"{errors[0]}, expected at {place}"
        return errors[0].message

    return only_error
