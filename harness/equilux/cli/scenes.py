"""`equilux scenes …`: work on specs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from equilux.cli import inputs
from equilux.complaint import BadUsage

Json = Annotated[bool, Parameter(name="--json", negative="")]
Limit = Annotated[tuple[str, ...], Parameter(name="--limit", negative="")]


def build() -> App:
    app = App(name="scenes", help="List, show, validate and expand scene specs; print their JSON Schema.")
    for command in (list_, show, validate, schema, expand):
        app.command(command, name=command.__name__.rstrip("_"))
    return app


def list_(*scenes: Path, json: Json = False, limit: Limit = ()) -> int:
    """List scenes, what each is about and what it requires.

    Parameters
    ----------
    scenes
        Scene files or folders; none: the shipped corpus.
    json
        Print a JSON list.
    limit
        Raise a limit on specs, NAME=VALUE.
    """
    loaded = inputs.load(scenes, limit, as_json=json)
    if json:
        inputs.print_json(
            [
                {
                    "scene": found.scene.name,
                    "file": str(found.path),
                    "model": found.scene.model,
                    "about": found.scene.about,
                    "cases": [case.name for case in found.cases],
                    "requires": sorted({feature for case in found.cases for feature in case.requires}),
                }
                for found in loaded
            ]
        )
        return 0
    rows = [("scene", "cases", "about")]
    rows += [(found.scene.name, str(len(found.cases)), " ".join(found.scene.about.split())) for found in loaded]
    sys.stdout.write(inputs.table(rows, right=frozenset({1})))
    return 0


def show(scene: str, /, *, json: Json = False, limit: Limit = ()) -> int:
    """Show a scene with every default filled in, what its lights are in bands, and the features it requires.

    Parameters
    ----------
    scene
        A scene file, or the name of a scene of the shipped corpus.
    json
        Print JSON alone.
    limit
        Raise a limit on specs, NAME=VALUE.
    """
    from equilux_scenes.photometry import K_M, k_m_text
    from equilux_scenes.units import UNITS, dumped_as_written, worked_out, written_strengths

    (found,) = inputs.load([_scene_path(scene, limit)], limit, as_json=json)
    resolved, bands = dumped_as_written(found.scene), worked_out(found.scene)
    requires = sorted({feature for case in found.cases for feature in case.requires})
    if json:
        cases = [case.name for case in found.cases]
        inputs.print_json({"scene": resolved, "bands": bands, "requires": requires, "cases": cases})
        return 0
    sys.stdout.write(_as_yaml(resolved))
    written = written_strengths(found.scene)
    for light, values in bands.items():
        key, (r, g, b) = next(iter(values.items()))
        sys.stdout.write(f"# light {light}: {key} [{r:.9g}, {g:.9g}, {b:.9g}] {UNITS[key]} from {written[light]}\n")
    if written or found.scene.k_m != K_M:
        sys.stdout.write(f"# k_m: {k_m_text(found.scene)}\n")
    sys.stdout.write(f"# requires: {', '.join(requires)}\n")
    for case in found.cases:
        own = sorted(set(case.requires))
        sys.stdout.write(f"# case: {case.name}" + (f" requires: {', '.join(own)}" if own != requires else "") + "\n")
    return 0


def validate(*scenes: Path, json: Json = False, limit: Limit = ()) -> int:
    """Check specs; every error is a line `file:line:column: …`, and the exit code is then 2.

    Parameters
    ----------
    scenes
        Scene files or folders; none: the shipped corpus.
    json
        Print the errors as a JSON list (empty when there is none).
    limit
        Raise a limit on specs, NAME=VALUE.
    """
    loaded = inputs.load(scenes, limit, as_json=json)
    if json:
        inputs.print_json([])
    else:
        sys.stdout.write(f"valid: {len(loaded)} scenes, {sum(len(found.cases) for found in loaded)} cases\n")
    return 0


def schema() -> int:
    """Print the JSON Schema of a spec, for editors."""
    from equilux_scenes.schema import json_schema

    inputs.print_json(json_schema())
    return 0


def expand(*scenes: Path, json: Json = False, limit: Limit = ()) -> int:
    """List every case of the sweeps, with its axes and what it requires.

    Parameters
    ----------
    scenes
        Scene files or folders; none: the shipped corpus.
    json
        Print a JSON list with the resolved scene of every case.
    limit
        Raise a limit on specs, NAME=VALUE.
    """
    from equilux_scenes.units import dumped_in_bands, written_strengths

    loaded = inputs.load(scenes, limit, as_json=json)
    cases = [case for found in loaded for case in found.cases]
    if json:
        inputs.print_json(
            [
                {
                    "case": case.name,
                    "scene": case.scene_name,
                    "axes": dict(case.axes),
                    "requires": list(case.requires),
                    "resolved": dumped_in_bands(case.scene),
                    "written": written_strengths(case.scene),
                }
                for case in cases
            ]
        )
        return 0
    for case in cases:
        sys.stdout.write(f"{case.name}\n")
    return 0


def _scene_path(scene: str, limit: tuple[str, ...]) -> Path:
    """A file as given, else the corpus scene of that name. Raises BadUsage with the nearest name."""
    from equilux_scenes.loader import corpus_folder

    path = Path(scene)
    if path.is_file():
        return path
    known = {found.name.removesuffix(".scene.yaml"): found for found in corpus_folder().rglob("*.scene.yaml")}
    if scene in known:
        return known[scene]
    from equilux.complaint import nearest

    what = "is a folder; give one scene" if path.is_dir() else "is neither a file nor a scene of the corpus"
    raise BadUsage(f"'{scene}' {what}{nearest(scene, known)}")


def _as_yaml(content: Any) -> str:
    """Readable YAML, vectors on one line."""
    import io

    from ruamel.yaml import YAML
    from ruamel.yaml.comments import CommentedSeq

    def compact(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: compact(item) for key, item in value.items()}
        if isinstance(value, list):
            sequence = CommentedSeq(compact(item) for item in value)
            if not any(isinstance(item, dict | list) for item in value):
                sequence.fa.set_flow_style()
            return sequence
        return value

    yaml = YAML()
    yaml.width = 10_000
    buffer = io.StringIO()
    yaml.dump(compact(content), buffer)
    return buffer.getvalue()
