"""Makes a watertight, solid teapot of the published one: `python scene_specs/make_glass_teapot.py`.

Glass needs a closed surface, and Newell's patches are none: lid, spout and handle pass through the body. The solid is the union
of what they enclose (body and lid as one solid of revolution, handle and spout closed at their ends), sampled as a signed
distance on a grid whose zero surface is extracted (vtkFlyingEdges3D gives closed, consistently wound surfaces). Normals are the
slope of the distance. Binary PLY in the published units, y up.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkImplicitPolyDataDistance

from make_teapot import LATHE, TUBES, bernstein, evaluate, ply, tube_patch

SPACING = 0.07
"""Of the grid, in the published units: about 30 000 triangles."""
OFFSET = 0.0173
"""Shifts the grid, so that no grid point lies exactly on a flat part of the surface."""
LOW, HIGH = np.array([-3.3, -2.3, -0.3]), np.array([3.9, 2.3, 3.5])
GLASS_TEAPOT = Path(__file__).parent / "equilux_scenes/corpus/showcase/glass-teapot.ply"


def silhouette(segments: int = 32) -> np.ndarray:
    """(radius, height) of body and lid from the pole at the bottom to the one on top, (n, 2)."""
    value = bernstein(np.linspace(0, 1, segments + 1))[0]
    curve = {name: value @ np.array([(radius, height) for radius, _, height in points]) for name, points in LATHE.items()}
    # The rim's bead is thinner than a cell of the grid, and left out.
    upwards = ("bottom", "lower body", "upper body", "lid", "knob")
    return np.concatenate([curve[name][::-1] for name in upwards])


def distance_to_lathe(points: np.ndarray) -> np.ndarray:
    """Signed distance of (n, 3), z up, to the solid of revolution; negative inside."""
    profile = silhouette()
    at = np.stack([np.linalg.norm(points[:, :2], axis=1), points[:, 2]], axis=1)
    nearest = np.full(len(at), np.inf)
    crossings = np.zeros(len(at), dtype=int)
    for a, b in pairwise(profile):
        edge = b - a
        length2 = edge @ edge
        t = np.clip((at - a) @ edge / length2, 0, 1) if length2 > 0 else np.zeros(len(at))
        nearest = np.minimum(nearest, np.linalg.norm(at - a - t[:, None] * edge, axis=1))
        spans = (a[1] > at[:, 1]) != (b[1] > at[:, 1])  # a horizontal ray outwards crosses the silhouette an odd number of times
        with np.errstate(divide="ignore", invalid="ignore"):
            crossings += spans & (at[:, 0] < a[0] + (at[:, 1] - a[1]) / (b[1] - a[1]) * edge[0])
    return np.where(crossings % 2 == 1, -nearest, nearest)


def closed_tube(names: tuple[str, str], segments: int = 24) -> vtkPolyData:
    """Handle or spout: both patches, both mirror halves, and a fan over each end, z up."""
    halves = [evaluate(tube_patch(TUBES[name]), segments)[0] for name in names]
    along = np.concatenate([halves[0], halves[1][1:]])  # rings along the tube, (m, n, 3), y ≤ 0
    rings = np.concatenate([along, (along * (1, -1, 1))[:, -2:0:-1]], axis=1)
    m, n = rings.shape[:2]
    vertices = np.concatenate([rings.reshape(-1, 3), [rings[0].mean(axis=0), rings[-1].mean(axis=0)]])
    faces = []
    for i in range(m - 1):
        for j in range(n):
            a, b = i * n + j, i * n + (j + 1) % n
            faces += [(a, b, b + n), (a, b + n, a + n)]
    for j in range(n):
        k = (j + 1) % n
        faces += [(m * n, k, j), (m * n + 1, (m - 1) * n + j, (m - 1) * n + k)]
    return _surface(vertices, np.array(faces))


def _surface(vertices: np.ndarray, faces: np.ndarray) -> vtkPolyData:
    points, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices), deep=True))
    ids = np.hstack([np.full((len(faces), 1), 3), faces]).ravel().astype(np.int64)
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(ids, deep=True))
    surface.SetPoints(points)
    surface.SetPolys(cells)
    return surface


def _signed_volume(surface: vtkPolyData) -> float:
    p = vtk_to_numpy(surface.GetPoints().GetData())
    corner = p[vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
    return float(np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6)


def distance_to_tube(surface: vtkPolyData, points: np.ndarray) -> np.ndarray:
    """Signed distance of (n, 3); negative inside, whichever way the surface is wound."""
    function = vtkImplicitPolyDataDistance()
    function.SetInput(surface)
    values = np.array([function.EvaluateFunction(point) for point in points])
    return values if _signed_volume(surface) > 0 else -values


def solid() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (n, 3), unit outward normals (n, 3) and counter-clockwise faces (m, 3), y up."""
    axes = [np.arange(low - OFFSET, high, SPACING) for low, high in zip(LOW, HIGH, strict=True)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    distance = distance_to_lathe(points)
    for names in (("upper handle", "lower handle"), ("lower spout", "upper spout")):
        distance = np.minimum(distance, distance_to_tube(closed_tube(names), points))
    image = vtkImageData()
    image.SetDimensions(*(len(axis) for axis in axes))
    image.SetOrigin(*(float(axis[0]) for axis in axes))
    image.SetSpacing(SPACING, SPACING, SPACING)
    image.GetPointData().SetScalars(numpy_to_vtk(distance, deep=True))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOn()
    edges.Update()
    surface = edges.GetOutput()
    vertices = vtk_to_numpy(surface.GetPoints().GetData()).astype(np.float64)
    normals = vtk_to_numpy(surface.GetPointData().GetNormals()).astype(np.float64)
    faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    if _signed_volume(surface) < 0:
        faces = faces[:, ::-1]
    corner = vertices[faces]
    outward = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    if np.einsum("ij,ij->", outward, normals[faces].sum(axis=1)) < 0:
        normals = -normals
    y_up = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T
    return vertices @ y_up, normals @ y_up, faces


def main() -> None:
    vertices, normals, faces = solid()
    header = b"comment Utah teapot, M. E. Newell 1975, tessellated from its 32 patches"
    ours = b"comment solid Utah teapot, after M. E. Newell 1975; closed for glass"
    content = ply(vertices, normals, faces).replace(header, ours, 1)
    GLASS_TEAPOT.write_bytes(content)
    print(f"{GLASS_TEAPOT.name}: {len(vertices)} vertices, {len(faces)} triangles", file=sys.stderr)


if __name__ == "__main__":
    main()
