"""What has a closed form: everything but triangle meshes."""

from __future__ import annotations

from collections.abc import Mapping

from equilux.adapter import Capability
from equilux_scenes.features import FEATURES

WITHOUT_CLOSED_FORM = ("shape.mesh", "normals.flat", "normals.smooth")

CAPABILITIES: Mapping[str, Capability] = {
    feature: Capability("none", "a mesh is data, not a formula") if feature in WITHOUT_CLOSED_FORM else Capability("exact")
    for feature in FEATURES
}
