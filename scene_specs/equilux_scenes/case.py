"""A case: a scene with every sweep axis fixed. It is what adapters, tracer and oracle are given."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from equilux_scenes.expectation import applies
from equilux_scenes.features import RESOLVED_FEATURES, required_features
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import Expectation, Mesh, Object, Scene
from equilux_scenes.transforms import matrix
from equilux_scenes.units import OTHER_THAN_BANDS


@dataclass(frozen=True, eq=False)
class Case:
    """One picture to render.

    name: the scene's name, with its axes (`clay-ball[exponent=1000]`); it names the folder in the results tree. scene: the typed
    scene, axes fixed, `sweep` empty. axes: axis → value, in file order. source: the spec's file. folder: where its mesh files
    are. meshes: object index → mesh in object space, normals resolved.
    """

    name: str
    scene: Scene
    scene_name: str
    axes: Mapping[str, Any] = field(default_factory=dict)
    source: Path | None = None
    folder: Path | None = None
    meshes: Mapping[int, TriangleMesh] = field(default_factory=dict)

    @property
    def requires(self) -> tuple[str, ...]:
        """The features that the case needs, sorted: of a renderer (`demands`), and of equilux itself."""
        return required_features(self.scene)

    @property
    def demands(self) -> tuple[str, ...]:
        """The features that a renderer must have, sorted."""
        return tuple(feature for feature in self.requires if feature not in RESOLVED_FEATURES)

    @property
    def directory_name(self) -> str:
        """The case's folder in the results tree."""
        return self.name

    @property
    def expectations(self) -> tuple[Expectation, ...]:
        """The scene's expectations that apply to this case: those whose `when` holds for its axes."""
        return tuple(expectation for expectation in self.scene.expect if applies(expectation, self.axes))

    def canonical(self) -> bytes:
        """What determines the picture, and nothing else, as canonical JSON (UTF-8).

        Names, `about`, `expect`, sweeps, unused materials, the units of a light and the way a number or transform is written do
        not enter; meshes enter by content. Two cases with equal bytes have equal pictures.
        """
        scene = self.scene
        content = {
            "format": "equilux/case/1",
            "model": scene.model,
            "camera": scene.camera.model_dump(),
            "film": scene.film.model_dump(),
            "ambient": scene.ambient,
            "background": scene.background,
            "recursion_limit": scene.recursion_limit,
            "transparent_shadows": scene.transparent_shadows,
            "viewer": scene.viewer,
            "lights": [light.model_dump(exclude=set(OTHER_THAN_BANDS)) for light in scene.lights.values()],
            "objects": [self._canonical_object(index, obj) for index, obj in enumerate(scene.objects)],
        }
        return json.dumps(_normalised(content), sort_keys=True, separators=(",", ":"), allow_nan=False).encode()

    def _canonical_object(self, index: int, obj: Object) -> dict[str, Any]:
        left_out = {"transform", "material"}
        if isinstance(obj, Mesh):
            left_out |= {"file", "vertices", "faces", "vertex_normals"}
        content = obj.model_dump(exclude=left_out)
        content["material"] = self.scene.materials[obj.material].model_dump()
        content["matrix"] = matrix(obj).tolist()
        if isinstance(obj, Mesh):
            content["mesh"] = self.meshes[index].content_hash()
        return content


def _normalised(value: Any) -> Any:
    """−0.0 and 0.0 are one number; tuples are lists."""
    if isinstance(value, dict):
        return {key: _normalised(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_normalised(item) for item in value]
    if isinstance(value, float):
        return value + 0.0
    return value
