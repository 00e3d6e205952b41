"""Tessellates the Utah teapot from its published Bézier patches: `python scene_specs/make_teapot.py`.

M. E. Newell's teapot (1975; patches as in F. Crow, "The Origins of the Teapot", IEEE CG&A 7(1), 1987), 32 bicubic patches.
Most of it is turned on a lathe, so that a patch is a profile times an arc; handle and spout are tubes, mirrored in y. Written as
binary PLY in the published units, y up, with the surface's own unit normals, wound counter-clockwise seen from outside.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

SEGMENTS = 29
"""Cells along each side of a patch: 2 · 29² triangles each, less those that vanish at the two poles: 53 592 in all."""

TEAPOT = Path(__file__).parent / "equilux_scenes/corpus/showcase/teapot.ply"

# Lathe profiles, four control points each: (radius, arm of the arc's tangent, height). The arm is 0.56 radius but at the knob.
LATHE = {
    "rim": [(1.4, 0.784, 2.4), (1.3375, 0.749, 2.53125), (1.4375, 0.805, 2.53125), (1.5, 0.84, 2.4)],
    "upper body": [(1.5, 0.84, 2.4), (1.75, 0.98, 1.875), (2.0, 1.12, 1.35), (2.0, 1.12, 0.9)],
    "lower body": [(2.0, 1.12, 0.9), (2.0, 1.12, 0.45), (1.5, 0.84, 0.225), (1.5, 0.84, 0.15)],
    "knob": [(0.0, 0.0, 3.15), (0.8, 0.45, 3.15), (0.0, 0.0, 2.85), (0.2, 0.112, 2.7)],
    "lid": [(0.2, 0.112, 2.7), (0.4, 0.224, 2.55), (1.3, 0.728, 2.55), (1.3, 0.728, 2.4)],
    "bottom": [(1.5, 0.84, 0.15), (1.5, 0.84, 0.075), (1.425, 0.798, 0.0), (0.0, 0.0, 0.0)],
}

# Tubes, four sections each: inner x and height, outer x and height, half-width.
TUBES = {
    "upper handle": [(-1.6, 2.025, -1.5, 2.25, 0.3), (-2.3, 2.025, -2.5, 2.25, 0.3),
                     (-2.7, 2.025, -3.0, 2.25, 0.3), (-2.7, 1.8, -3.0, 1.8, 0.3)],
    "lower handle": [(-2.7, 1.8, -3.0, 1.8, 0.3), (-2.7, 1.575, -3.0, 1.35, 0.3),
                     (-2.5, 1.125, -2.65, 0.9375, 0.3), (-2.0, 0.9, -1.9, 0.6, 0.3)],
    "lower spout": [(1.7, 1.425, 1.7, 0.6, 0.66), (2.6, 1.425, 3.1, 0.825, 0.66),
                    (2.3, 2.1, 2.4, 2.025, 0.25), (2.7, 2.4, 3.3, 2.4, 0.25)],
    "upper spout": [(2.7, 2.4, 3.3, 2.4, 0.25), (2.8, 2.475, 3.525, 2.49375, 0.25),
                    (2.9, 2.475, 3.45, 2.5125, 0.15), (2.8, 2.4, 3.2, 2.4, 0.15)],
}


def lathe_patch(profile: list[tuple[float, float, float]]) -> np.ndarray:
    """Control net (4, 4, 3), x y z with z up: the quarter x ≥ 0, y ≤ 0."""
    return np.array([[(r, 0, z), (r, -k, z), (k, -r, z), (0, -r, z)] for r, k, z in profile])


def tube_patch(sections: list[tuple[float, float, float, float, float]]) -> np.ndarray:
    """Control net (4, 4, 3), x y z with z up: the half y ≤ 0."""
    return np.array([[(xi, 0, zi), (xi, -w, zi), (xo, -w, zo), (xo, 0, zo)] for xi, zi, xo, zo, w in sections])


def bernstein(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cubic Bernstein polynomials and their derivatives, (n, 4) each."""
    s = 1 - t
    value = np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], axis=1)
    slope = np.stack([-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t], axis=1)
    return value, slope


def evaluate(net: np.ndarray, segments: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and unit normals, (n, n, 3) each; the normal's side is arbitrary but the same all over the patch."""
    value, slope = bernstein(np.linspace(0, 1, segments + 1))
    points = np.einsum("ui,vj,ijk->uvk", value, value, net)
    across = np.cross(np.einsum("ui,vj,ijk->uvk", slope, value, net), np.einsum("ui,vj,ijk->uvk", value, slope, net))
    length = np.linalg.norm(across, axis=2, keepdims=True)
    # At a pole of the lathe one derivative vanishes; both lie on the axis with a horizontal tangent: the normal is the axis.
    pole = length[..., 0] < 1e-12
    normals = across / np.where(length < 1e-12, 1, length)
    normals[pole] = (0, 0, 1)
    return points, normals


def outward(name: str, points: np.ndarray, normals: np.ndarray) -> float:
    """+1 where the patch's normals point out of the pot, −1 where they point in: judged in the middle of the patch."""
    middle = points.shape[0] // 2
    point, normal = points[middle, middle], normals[middle, middle]
    if name in TUBES:
        ring = points[middle]
        return float(np.sign(normal @ (point - (ring[0] + ring[-1]) / 2)))
    if name == "rim":  # a bead whose section is centred at radius 1.45, height 2.4
        return float(np.sign(normal @ (point - [*(1.45 * point[:2] / np.linalg.norm(point[:2])), 2.4])))
    inside = [0, 0, 2.0] if name == "lid" else [0, 0, 3.0] if name == "knob" else [0, 0, 1.2]
    return float(np.sign(normal @ (point - inside)))


def tessellate(segments: int = SEGMENTS) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (n, 3), unit normals (n, 3) and counter-clockwise faces (m, 3), y up."""
    all_points, all_normals, all_faces = [], [], []
    n = segments + 1
    index = np.arange(n * n).reshape(n, n)
    a, b, c, d = index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    cells = np.stack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], axis=1).reshape(-1, 3)
    for name, shape in {**LATHE, **TUBES}.items():
        points, normals = evaluate(lathe_patch(shape) if name in LATHE else tube_patch(shape), segments)  # type: ignore[arg-type]
        normals = normals * outward(name, points, normals)
        if name in ("knob", "bottom"):
            pole = np.linalg.norm(points[..., :2], axis=2) < 1e-12
            normals[pole] = (0, 0, 1) if name == "knob" else (0, 0, -1)
        mirrors = [(1, 1), (1, -1), (-1, 1), (-1, -1)] if name in LATHE else [(1, 1), (1, -1)]
        for sign in mirrors:
            p, q = (array.reshape(-1, 3) * (*sign, 1) for array in (points, normals))
            corner = p[cells]
            area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
            faces = cells[np.linalg.norm(area, axis=1) > 1e-14]
            flip = np.einsum("ij,ij->i", area, q[cells].sum(axis=1))[np.linalg.norm(area, axis=1) > 1e-14] < 0
            faces = np.where(flip[:, None], faces[:, ::-1], faces)
            all_faces.append(faces + sum(len(x) for x in all_points))
            all_points.append(p)
            all_normals.append(q)
    y_up = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T
    return np.concatenate(all_points) @ y_up, np.concatenate(all_normals) @ y_up, np.concatenate(all_faces)


def ply(vertices: np.ndarray, normals: np.ndarray, faces: np.ndarray) -> bytes:
    """Binary little-endian PLY: float32 vertices with normals, and triangles."""
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment Utah teapot, M. E. Newell 1975, tessellated from its 32 patches\n"
        f"element vertex {len(vertices)}\n" + "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
        + f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.zeros(len(faces), dtype=[("count", "u1"), ("corner", "<i4", 3)])
    rows["count"], rows["corner"] = 3, faces
    # Adding 0 turns −0 into 0, so that the file does not depend on how a mirrored zero was reached.
    return header.encode() + (np.hstack([vertices, normals]) + 0.0).astype("<f4").tobytes() + rows.tobytes()


def main() -> None:
    vertices, normals, faces = tessellate()
    TEAPOT.write_bytes(ply(vertices, normals, faces))
    print(f"{TEAPOT.name}: {len(vertices)} vertices, {len(faces)} triangles", file=sys.stderr)


if __name__ == "__main__":
    main()
