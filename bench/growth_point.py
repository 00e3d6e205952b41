"""One point of a growth curve, in a process of its own: `python -m bench.growth_point SERIES SIZE`.

Prints one JSON object: "seconds" by what was timed, and where the series holds pictures "held_bytes" and "peak_bytes", the most
that was resident above what was before the first picture.
"""

from __future__ import annotations

import json
import resource
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from bench.measured import timed
from bench.scenes import CORNELL, Spec, case_of

Point = dict[str, Any]
REPEATS = 3
FILM = {"width": 256, "height": 192}


def comparison(pixels: int) -> Point:
    """A pair of float32 pictures: both, a − b and E_n are held."""
    from equilux.compare import RenderedImage, compare_pair
    from equilux.uncertainty import Uncertainty

    height, width = film(pixels)
    one = RenderedImage("a", np.ones((2, 2, 3), np.float32), Uncertainty())
    compare_pair(one, one, None)  # what is loaded late is loaded now
    before = _reset_peak()
    rng = np.random.default_rng(1)
    a, b = (rng.random((height, width, 3), dtype=np.float32) for _ in range(2))
    left, right = RenderedImage("a", a, Uncertainty(rel=2.0)), RenderedImage("reference", b, Uncertainty())
    seconds = _best(lambda: compare_pair(left, right, None))
    return {"seconds": {"compare_pair": seconds}, "held_bytes": 4 * a.nbytes, "peak_bytes": _peak() - before}


def tracer_pixels(pixels: int) -> Point:
    """The Cornell box; held is the float64 picture."""
    height, width = film(pixels)
    return _traced({**CORNELL, "film": {"width": width, "height": height}})


def tracer_lights(lights: int) -> Point:
    return _traced({**_matt_sphere(lights), "film": FILM})


def tracer_triangles(triangles: int) -> Point:
    """A rolling ground of so many triangles from above: reading its file, building the tracer, rendering."""
    from equilux_scenes.loader import load_scene_file
    from equilux_tracer import Tracer

    with tempfile.TemporaryDirectory(prefix="equilux-bench-") as scratch:
        scene = write_ground(Path(scratch), triangles)
        loaded: list[Any] = []
        seconds = {"load": timed(lambda: loaded.append(load_scene_file(scene))).wall}
        case = loaded[0].cases[0]
        tracers: list[Tracer] = []
        seconds["build"] = timed(lambda: tracers.append(Tracer(case))).wall
        seconds["first render"] = timed(lambda: tracers[0].render(["radiance"])).wall  # what is built late is built now
        for precision in ("exact", "float"):
            seconds[f"render {precision}"] = _best(lambda: tracers[0].render(["radiance"], precision=precision))  # noqa: B023
    return {"seconds": seconds}


def film(pixels: int) -> tuple[int, int]:
    """Height and width of about that many pixels, 2 : 1."""
    height = max(1, round((pixels / 2) ** 0.5))
    return height, max(1, round(pixels / height))


def write_scene(folder: Path, spec: Spec) -> Path:
    """A spec as a file; JSON is YAML."""
    path = folder / f"{spec['name']}.scene.yaml"
    path.write_text(json.dumps(spec), encoding="utf-8")
    return path


def write_ground(folder: Path, triangles: int) -> Path:
    """A scene with a mesh of about so many triangles, as binary PLY. Returns the scene's file."""
    side = max(2, round((triangles / 2) ** 0.5) + 1)
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side), indexing="ij")
    points = np.stack([x, 0.1 * np.sin(9 * x) * np.cos(7 * y), -y], axis=-1).reshape(-1, 3).astype("<f8")
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + side, corner + 1], -1), np.stack([corner + 1, corner + side, corner + side + 1], -1)]
    )
    rows = np.empty(len(faces), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    rows["count"], rows["corners"] = 3, faces
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    (folder / "ground.ply").write_bytes(header.encode() + points.tobytes() + rows.tobytes())
    return write_scene(folder, {
        "equilux": 1, "name": "ground", "model": "phong", "film": FILM,
        "camera": {"projection": "perspective", "eye": [0, 2.2, 1.4], "target": [0, 0, 0], "fov_y_deg": 42},
        "lights": {"key": {"kind": "point", "position": [1.5, 2, 1], "intensity": 9}},
        "materials": {"soil": {"diffuse": 0.3, "specular": 0.2, "exponent": 20}},
        "objects": [{"kind": "mesh", "file": "ground.ply", "normals": "smooth", "material": "soil"}],
    })  # fmt: skip


def matt_sphere(name: str, pixels: int) -> Spec:
    """The least that a case can be: one light, one matt sphere."""
    height, width = film(pixels)
    return {**_matt_sphere(1), "name": name, "film": {"width": width, "height": height}}


def _matt_sphere(lights: int) -> Spec:
    turns = 2.399963 * np.arange(lights)  # the golden angle: no two lights behind one another
    places = [[3 * float(np.cos(turn)), 2.0 + index / lights, 3 * float(np.sin(turn))] for index, turn in enumerate(turns)]
    return {
        "equilux": 1, "name": "sphere", "model": "phong", "film": FILM,
        "camera": {"projection": "perspective", "eye": [0, 0.8, 4], "target": [0, 0, 0], "fov_y_deg": 40},
        "lights": {
            f"l{index}": {"kind": "point", "position": place, "intensity": 5 / lights} for index, place in enumerate(places)
        },
        "materials": {"matt": {"diffuse": 0.3}},
        "objects": [{"kind": "sphere", "center": [0, 0, 0], "radius": 1, "material": "matt"}],
    }  # fmt: skip


def _traced(spec: Spec) -> Point:
    from equilux_tracer import Tracer

    tracer = Tracer(case_of(spec))
    tracer.evaluate(np.array([[0.5, 0.5]]), ("radiance",))  # what is built late is built now
    before = _reset_peak()
    seconds = _best(lambda: tracer.render(["radiance"]))
    held = spec["film"]["width"] * spec["film"]["height"] * 3 * 8
    return {"seconds": {"render": seconds}, "held_bytes": held, "peak_bytes": _peak() - before}


def _best(work: Callable[[], object]) -> float:
    """The least of some repeats, by the clock."""
    return min(timed(work).wall for _ in range(REPEATS))


def _reset_peak() -> int:
    """What is resident now, bytes; from here on `_peak` tells the most (Linux; elsewhere the most ever)."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    return _peak()


def _peak() -> int:
    with suppress(OSError):
        for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


SERIES: dict[str, Callable[[int], Point]] = {
    "comparison": comparison, "tracer pixels": tracer_pixels, "lights": tracer_lights, "triangles": tracer_triangles,
}  # fmt: skip

if __name__ == "__main__":
    print(json.dumps(SERIES[sys.argv[1]](int(sys.argv[2]))))
