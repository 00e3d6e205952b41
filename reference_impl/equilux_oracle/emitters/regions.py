"""What a body covers of the directions around a point, as the closed contour of its lit part.

A region is the cone of directions in which a convex body is seen: the cap of a sphere, the elliptic cone of a disc, the pyramid
of a rectangle, the half-space behind a plane. Only the part above the surface's horizon, N·ω > 0, counts, and for a highlight
only what also lies above the mirror direction's horizon, M·ω > 0. All these sets are convex, so each horizon adds one arc to the
contour: from where the rim goes below it to where the rim comes up again. Its ends are computed from those very points of the
rim, so that the contour stays closed however badly the crossing itself is conditioned (a rim that just touches the horizon).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import Array, Bools
from equilux_oracle.emitters.arcs import Arcs, both, circle_arc, edge_arc, positive_part
from equilux_oracle.emitters.frame import Frame


@dataclass(frozen=True)
class Round:
    """Regions with one smooth rim: caps, discs, half-spaces. above: those that fill the whole hemisphere above N, (n,)."""

    rim: Arcs
    above: Bools

    def contour(self, frame: Frame, highlight: bool) -> list[Arcs]:
        """Arcs of the boundary of the part with N·ω > 0, and M·ω > 0 for a highlight."""
        above_n = self._above(np.array([[0.0], [0.0], [1.0]]))
        above_n = above_n[0], np.where(self.above, np.pi, above_n[1])
        ends_n = self._ends(above_n)
        if not highlight:
            start, length = _horizon(*ends_n, np.array([[1.0], [0.0], [0.0]]), np.array([[0.0], [1.0], [0.0]]))
            x, y = _axes_of_normal(frame)
            return [
                self.rim.between(above_n[0] - above_n[1], above_n[0] + above_n[1]),
                circle_arc(x, y, start, start + length),
            ]
        above_m = self._above(frame.mirror)
        rims = [self.rim.between(start, end) for start, end in both(above_n, above_m)]
        return rims + _horizons_of_highlight(frame, ends_n, self._ends(above_m))

    def _above(self, axis: Array) -> tuple[Array, Array]:
        l0, lc, ls = (np.sum(axis * part, axis=0) for part in (self.rim.c, self.rim.e, self.rim.f))
        return positive_part(l0, lc, ls)

    def _ends(self, above: tuple[Array, Array]) -> tuple[Array, Array, Bools]:
        """Where the rim goes below a horizon and where it comes up again, (3, n), and whether it does."""
        centre, half = above
        return self.rim.at(centre + half), self.rim.at(centre - half), (half > 0.0) & (half < np.pi)


@dataclass(frozen=True)
class Polygon:
    """Regions with straight edges: corners (k, 3, n), counter-clockwise as directions about their middle. seen: (n,)."""

    corners: Array
    seen: Bools

    def contour(self, frame: Frame, highlight: bool) -> list[Arcs]:
        """As `Round.contour`."""
        axes = [np.array([[0.0], [0.0], [1.0]])] + ([frame.mirror] if highlight else [])
        heights = [np.sum(axis * self.corners, axis=1) for axis in axes]
        arcs = []
        for k in range(len(self.corners)):
            edge = self.corners[k], self.corners[(k + 1) % len(self.corners)]
            arcs.append(edge_arc(*edge, *self._edge_above(k, heights)))
        ends = [self._ends(height) for height in heights]
        if highlight:
            return arcs + _horizons_of_highlight(frame, ends[0], ends[1])
        x, y = _axes_of_normal(frame)
        start, length = _horizon(*ends[0], x, y)
        return [*arcs, circle_arc(x, y, start, start + length)]

    def _edge_above(self, k: int, heights: list[Array]) -> tuple[Array, Array]:
        """The part of edge k above every horizon; both ends alike where there is none."""
        low, high = np.zeros(self.corners.shape[2]), np.ones(self.corners.shape[2])
        for height in heights:
            h0, h1 = height[k], height[(k + 1) % len(height)]
            crossing = _crossing(h0, h1)
            low = np.where((h0 <= 0.0) & (h1 > 0.0), np.maximum(low, crossing), low)
            high = np.where((h0 > 0.0) & (h1 <= 0.0), np.minimum(high, crossing), high)
            low = np.where((h0 <= 0.0) & (h1 <= 0.0), 1.0, low)
        high = np.where(self.seen, np.maximum(high, low), low)
        return self._on_edge(k, low), self._on_edge(k, high)

    def _on_edge(self, k: int, share: Array) -> Array:
        first, last = self.corners[k], self.corners[(k + 1) % len(self.corners)]
        point: Array = np.where(share == 1.0, last, first + share * (last - first))
        return point

    def _ends(self, height: Array) -> tuple[Array, Array, Bools]:
        down, up = np.zeros_like(self.corners[0]), np.zeros_like(self.corners[0])
        crosses = np.zeros(self.corners.shape[2], dtype=bool)
        for k in range(len(self.corners)):
            h0, h1 = height[k], height[(k + 1) % len(self.corners)]
            point = self._on_edge(k, _crossing(h0, h1))
            down = np.where((h0 > 0.0) & (h1 <= 0.0), point, down)
            up = np.where((h0 <= 0.0) & (h1 > 0.0), point, up)
            crosses |= (h0 > 0.0) != (h1 > 0.0)
        return down, up, crosses & self.seen


def cap(axis: Array, cos_alpha: Array, sin_alpha: Array) -> Round:
    """The cap of half-angle α about unit axes (3, n), local coordinates; α = π/2 is a half-space."""
    sign = np.where(axis[2] >= 0.0, 1.0, -1.0)  # an orthonormal basis without a branch cut but on z = 0 (Duff et al. 2017)
    s = -1.0 / (sign + axis[2])
    t = axis[0] * axis[1] * s
    first = np.stack([1.0 + sign * axis[0] ** 2 * s, sign * t, -sign * axis[0]])
    second = np.stack([t, sign + axis[1] ** 2 * s, -axis[1]])
    whole = np.full(axis.shape[1], np.pi)
    one = np.ones_like(whole)
    rim = Arcs(axis * cos_alpha, first * sin_alpha, second * sin_alpha, -whole, whole, one, one)
    return Round(rim, (cos_alpha <= 0.0) & (axis[2] > 0.0) & (np.hypot(axis[0], axis[1]) <= 1e-15))


def disc(to_center: Array, normal: Array, radius: float) -> Round:
    """The cone of a disc, seen from whichever side: centre relative to the point and unit normal, (3, n), local coordinates."""
    height = np.sum(normal * to_center, axis=0)
    across = to_center - normal * height
    off = np.sqrt(np.sum(across**2, axis=0))
    frame_axis = np.where(off > 0.0, across / np.where(off > 0.0, off, 1.0), _some_across(normal))
    e = radius * frame_axis
    f = np.where(height >= 0.0, 1.0, -1.0) * np.cross(normal, e, axis=0)
    whole = np.full(to_center.shape[1], np.pi)
    rim = Arcs(to_center, e, f, -whole, whole, (off - radius) ** 2 + height**2, np.ones_like(whole))
    return Round(rim, np.zeros(len(off), dtype=bool))


def parallelogram(corners: Array, side: Array) -> Polygon:
    """The pyramid of a rectangle or parallelogram; corners (4, 3, n) in order, local coordinates, e.g. c, c + u, c + u + v, c +
    v.

    side: the corner's height along u × v, (n,): > 0 where the directions to the corners turn counter-clockwise.
    """
    return Polygon(np.where(side >= 0.0, corners, corners[[0, 3, 2, 1]]), side != 0.0)


def _axes_of_normal(frame: Frame) -> tuple[Array, Array]:
    """x and y of the horizon of N, which runs counter-clockwise about it."""
    zero, one = np.zeros(len(frame)), np.ones(len(frame))
    return np.stack([one, zero, zero]), np.stack([zero, one, zero])


def _axes_of_mirror(frame: Frame) -> tuple[Array, Array]:
    """T and M × T of the horizon of M."""
    zero = np.zeros(len(frame))
    return np.stack([-frame.a, zero, frame.b]), np.stack([zero, zero - 1.0, zero])


def _horizon(down: Array, up: Array, crosses: Bools, x: Array, y: Array) -> tuple[Array, Array]:
    """Start and length, in [0, π], of the arc of the horizon between two of its points."""
    start = np.arctan2(np.sum(y * down, axis=0), np.sum(x * down, axis=0))
    end = np.arctan2(np.sum(y * up, axis=0), np.sum(x * up, axis=0))
    turn = (end - start) % (2 * np.pi)
    # More than half a turn is a point that rounding has split.
    return start, np.where(crosses & (turn < 1.5 * np.pi), turn, 0.0)


def _horizons_of_highlight(frame: Frame, ends_n: tuple[Array, Array, Bools], ends_m: tuple[Array, Array, Bools]) -> list[Arcs]:
    """The horizon of N where M·ω > 0, and that of M where N·ω > 0: both half circles |ψ| < π/2 of their own frames."""
    arcs = []
    for ends, (x, y) in ((ends_n, _axes_of_normal(frame)), (ends_m, _axes_of_mirror(frame))):
        start, length = _horizon(*ends, x, y)
        for turn in (0.0, 2 * np.pi):
            low, high = np.maximum(start, turn - np.pi / 2), np.minimum(start + length, turn + np.pi / 2)
            arcs.append(circle_arc(x, y, low, high))
    return arcs


def _crossing(h0: Array, h1: Array) -> Array:
    """Where a height that is linear along an edge vanishes, as a share of the edge; arbitrary where it does not."""
    change = h0 - h1
    share: Array = np.clip(h0 / np.where(change == 0.0, 1.0, change), 0.0, 1.0)
    return share


def _some_across(normal: Array) -> Array:
    least = np.argmin(np.abs(normal), axis=0)
    axis = np.zeros_like(normal)
    axis[least, np.arange(normal.shape[1])] = 1.0
    v = np.cross(axis, normal, axis=0)
    result: Array = v / np.sqrt(np.sum(v**2, axis=0))
    return result
