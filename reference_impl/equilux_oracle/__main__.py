"""`python -m equilux_oracle SCENE.json RADIANCE.npy [BOUND.npy]`: the picture of a scene.

The scene is the typed model's JSON, axes fixed. Writes float64 (h, w, 3), W/(m²·sr), row 0 on top, and the bound on its
arithmetic error likewise.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from equilux_oracle.picture import radiance_with_bound
from equilux_scenes.case import Case
from equilux_scenes.model import Scene


def main(arguments: list[str]) -> int:
    if len(arguments) not in (2, 3):
        print(__doc__, file=sys.stderr)
        return 2
    picture, bound = radiance_with_bound(case_from_json(Path(arguments[0]).read_bytes()))
    np.save(arguments[1], picture)
    if len(arguments) == 3:
        np.save(arguments[2], bound)
    return 0


def case_from_json(text: bytes) -> Case:
    """A case of a scene without meshes, from the JSON of `Scene.model_dump_json`."""
    scene = Scene.model_validate_json(text)
    return Case(scene.name, scene, scene.name)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
