"""The script's image, with its budget."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from equilux.adapter import Program, RawRender, Reading, RendererFailed
from equilux_adapters._triangles.bounds import Floats, view_of
from equilux_adapters._triangles.view import Mesh
from equilux_adapters.opengl.budget import budget_of
from equilux_adapters.opengl.formula import Lighting, raised_to_itself
from equilux_adapters.opengl.interpolation import Left, left_open
from equilux_adapters.opengl.kit.stage import Light, Surface
from equilux_adapters.opengl.knobs import OpenGLKnobs
from equilux_adapters.opengl.render import DRAWN, IMAGE
from equilux_scenes.model import Camera, Film


def read(raw: RawRender, program: Program, knobs: OpenGLKnobs) -> Reading:
    """float32 (h, w, 3). Raises RendererFailed when the script left no such image."""
    try:
        image = np.load(raw.files[IMAGE])
    except (OSError, ValueError, EOFError) as error:
        raise RendererFailed(f"{IMAGE}: {error}") from error
    facts = program.data
    return Reading(image, budget_of(facts, _left(facts, raw.files[DRAWN])))


def _left(facts: Mapping[str, Any], drawn: Path) -> Left:
    camera: Camera = TypeAdapter(Camera).validate_json(json.dumps(facts["camera"]))
    view = view_of(camera, Film.model_validate_json(json.dumps(facts["film"])))
    lights = [Light(**_arrays(light, view.eye)) for light in facts["lights"]]
    lighting = Lighting(lights, np.asarray(facts["ambient"]), None if facts["local_viewer"] else view.forward)
    objects = []
    with np.load(drawn) as arrays:
        for index, (surface, true) in enumerate(zip(facts["surfaces"], facts["round"], strict=True)):
            mesh = Mesh(*(arrays[f"{name}-{index}"] for name in ("points", "normals", "triangles")))
            objects.append((mesh, Surface(**surface), true))
    left = left_open(view, objects, lighting)
    if any(raised_to_itself(light, surface) for light in lights for _, surface, _ in objects):
        # What is interpolated is what the API evaluates at the corners: by the model, or by Mesa's own rule.
        by_mesa = left_open(view, objects, lighting._replace(by_mesa=True))
        left = Left(*(np.maximum(one, other) for one, other in zip(left, by_mesa, strict=True)))
    return left


def _arrays(light: Mapping[str, Any], eye: Floats) -> dict[str, Any]:
    """A light's fields, its position relative to the eye."""
    away = None if light["position"] is None else np.asarray(light["position"]) - eye
    return {**light, "position": away}
