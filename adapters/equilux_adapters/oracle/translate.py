"""Scene → program: the typed scene itself, as JSON, and the one command that evaluates it."""

from __future__ import annotations

import equilux_oracle
from equilux.adapter import Program, Unsupported
from equilux_scenes.case import Case

SCENE_FILE = "scene.json"
COMMAND_FILE = "command.txt"
COMMAND = f"python -m equilux_oracle {SCENE_FILE} radiance.npy bound.npy\n"


def program_of(case: Case) -> Program:
    """The scene without what does not change its picture. Raises Unsupported for a mesh, and for too many rays (Q7)."""
    lacking = equilux_oracle.lacking(case)
    if lacking:
        features = sorted(lacking)
        raise Unsupported(features, f"no closed form for {', '.join(features)}: {'; '.join(sorted(set(lacking.values())))}")
    text = case.scene.model_dump_json(indent=1, exclude={"about", "sweep", "expect"}, exclude_defaults=True, exclude_none=True)
    return Program({SCENE_FILE: (text + "\n").encode(), COMMAND_FILE: COMMAND.encode()}, SCENE_FILE)
