"""The tracer's Python face: a case in, arrays of radiance and of what lies behind it out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from threading import Lock
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import numpy.typing as npt

from equilux_scenes.case import Case
from equilux_tracer import _tracer
from equilux_tracer.channels import CHANNELS
from equilux_tracer.describe import describe
from equilux_tracer.shading_rules import MODEL_RULES, ShadingRules

VERSION = "3"
"""Changes whenever a picture may change in its last digit: part of the key under which renders are reused."""

ERROR_TARGET = 1e-6
"""Default of Tracer's error_target: far below what any other renderer can state, and still affordable."""

Arrays = dict[str, npt.NDArray[Any]]

Precision = Literal["exact", "refined", "float"]
"""exact: double, and double-double wherever rounding could tip a decision. refined: single-precision packets find the surface
that each eye ray meets first, where that is faster than the exact search; the crossing, the shading and everything beyond it
are exact. float: single-precision packets throughout."""

PACKET_CHANNELS = ("radiance", "rounding")
"""What precision "float" and "refined" can tell; float32 and float64."""


class Traversal(NamedTuple):
    """What bare Embree needs for the rays of a picture."""

    eye_rays: int
    shadow_rays: int
    seconds: float


class Tracer:
    """One case, prepared once; afterwards any number of threads may use it at the same time.

    case: what to render. precision: of `render`, where that is not told another.
    error_target: in (0, 1), asked of the integrals of model reflection-equation: at each sample, the error of what each emitter
    adds to its brightest band, relative to that with nothing in between. There is a work limit: channel `quadrature` says what
    was reached.
    rules: what to do otherwise than the model says.
    Raises TracerError for a scene whose sizes or distances (beyond 1e60 m) or transform (singular) cannot be computed with.
    """

    def __init__(
        self,
        case: Case,
        *,
        precision: Precision = "exact",
        error_target: float = ERROR_TARGET,
        rules: ShadingRules = MODEL_RULES,
    ) -> None:
        self.case = case
        self.precision: Precision = _checked(precision)
        self._lights = len(case.scene.lights)
        description = describe(case)
        description.set_error_target(error_target)
        if rules != MODEL_RULES:
            description.set_rules(**asdict(rules))
        self._world = _tracer.World(description)
        self._float_modes: dict[int, _tracer.FloatMode] = {}
        self._preparing = Lock()

    def render(
        self,
        channels: Sequence[str] = ("radiance",),
        *,
        threads: int = 0,
        cancel: _tracer.Cancel | None = None,
        precision: Precision | None = None,
        out: npt.NDArray[np.float32] | None = None,
        packet_width: int = 0,
    ) -> Arrays:
        """The whole film, sampled at pixel centres, row 0 on top.

        channels: names from CHANNELS; each comes back with leading shape (height, width). threads: 0 means one per core; the
        result does not depend on it. cancel: another thread may stop the render through it.
        precision: see Precision; None: the Tracer's own. "float" and "refined" have the channels PACKET_CHANNELS only, and the
        models phong and raytraced; float comes as float32. out: where "float" writes the radiance, (height, width, 3) float32,
        contiguous. packet_width: 4, 8 or 16 rays at a time, 0: as many as the machine can; the picture then differs within
        `rounding` and at edges.
        Raises TracerError for an unknown channel, for what the precision does not cover, Cancelled.
        """
        film = self.case.scene.film
        shape = (film.height, film.width)
        precision = self.precision if precision is None else _checked(precision)
        if out is not None and precision != "float":
            raise _tracer.TracerError(f"out: only precision 'float' writes float32, got precision {precision!r}")
        if precision == "exact":
            return self._trace(channels, shape, None, threads, cancel)
        return self._render_by_packets(precision, channels, threads, cancel, out, packet_width)

    def raw_traversal(self, *, threads: int = 0, packet_width: int = 0) -> Traversal:
        """Sends the rays of the float mode through Embree and shades nothing: the bound that its speed is measured against.

        The same eye rays in the same packets, and from what they meet the same shadow rays, in the same order, generated anew;
        no normals, no materials, no output. seconds: wall time. The first call renders once, untimed, to find out which lanes
        send shadow rays. Secondary rays are not sent. Raises TracerError for what float packets do not cover.
        """
        return Traversal(*self._float_mode(packet_width).traverse(threads=threads))

    def displacement_px(self) -> float:
        """How far a silhouette or the border of a shadow may be displaced in precisions "float" and "refined", pixels.

        Derived in reference_impl/src/fast/float_mode.h. Raises TracerError for what float packets do not cover.
        """
        return self._float_mode(0).displacement_px

    def _float_mode(self, width: int) -> _tracer.FloatMode:
        """Prepared when it is first asked for: the exact mode pays nothing for it."""
        with self._preparing:
            if width not in self._float_modes:
                self._float_modes[width] = _tracer.FloatMode(self._world, width)
            return self._float_modes[width]

    def _render_by_packets(
        self,
        precision: Precision,
        channels: Sequence[str],
        threads: int,
        cancel: _tracer.Cancel | None,
        out: npt.NDArray[np.float32] | None,
        width: int,
    ) -> Arrays:
        unknown = [name for name in channels if name not in PACKET_CHANNELS]
        if unknown:
            allowed = ", ".join(PACKET_CHANNELS)
            raise _tracer.TracerError(f"channels: got {', '.join(unknown)}, allowed with precision {precision!r} {allowed}")
        mode = self._float_mode(width)
        shape = (self.case.scene.film.height, self.case.scene.film.width, 3)
        if out is not None and (out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous):
            raise _tracer.TracerError(f"out: got {out.dtype} {out.shape}, allowed contiguous float32 {shape}")
        dtype = np.float32 if precision == "float" else np.float64
        radiance: npt.NDArray[Any] = np.empty(shape, dtype) if out is None else out
        rounding: npt.NDArray[Any] | None = np.empty(shape, dtype) if "rounding" in channels else None
        trace = mode.render if precision == "float" else mode.refine
        trace(radiance=radiance, rounding=rounding, threads=threads, cancel=cancel)
        arrays = {"radiance": radiance, "rounding": rounding}
        return {name: array for name in channels if (array := arrays[name]) is not None}

    def evaluate(
        self,
        film_xy: npt.ArrayLike,
        channels: Sequence[str] = ("radiance",),
        *,
        threads: int = 0,
        cancel: _tracer.Cancel | None = None,
    ) -> Arrays:
        """Like `render`, at film positions of the caller's choice.

        film_xy: (n, 2), x to the right and y down in pixels; (0.5, 0.5) is the centre of the top-left pixel. Positions off the
        film are fine. Each channel comes back with leading shape (n,).
        """
        positions = _positions(film_xy)
        return self._trace(channels, (len(positions),), positions, threads, cancel)

    def sensitivity(
        self,
        normal: npt.ArrayLike,
        position_m: npt.ArrayLike,
        *,
        film_xy: npt.ArrayLike | None = None,
        threads: int = 0,
        cancel: _tracer.Cancel | None = None,
    ) -> npt.NDArray[np.float64]:
        """How far the radiance of each sample may be off when normals and positions are.

        W/(m²·sr), (h, w, 3), or (n, 3) at `film_xy`. normal: bound on |ΔN| of the unit shading normal; position_m: bound on |ΔP|,
        metres; each one number, or one per object. With δN, δP those of the object seen, and t₁, t₂ two tangent directions
        (the project's rule for *geometric* uncertainty):

            Σ over t₁, t₂ of max± |L(N ± δN t) − L(N)|  +  Σ over t₁, t₂, N of max± |L(P ± δP u) − L(P)|

        Steps have full size; N is made unit again; V follows P in perspective. The path signature is held: the gate of each
        highlight and each cone stay as they are. The diffuse term has no jump and follows max(0, N·L). A miss gives 0.

        Model raytraced: this sum for every hit of every path, L what leaves the hit, times the path's weight; at each step the
        secondary rays are followed anew (reference_impl/src/sensitivity.h). It takes as long as some dozens of pictures.

        Changed rules: L is what they make of N and P. With `vertex_lighting` each vertex has its own errors, which add up with
        the vertices' weights, and δP also moves the point between them.

        Raises TracerError for a bound that is negative or not finite, Cancelled.
        """
        objects = len(self.case.scene.objects)
        positions = None if film_xy is None else _positions(film_xy)
        film = self.case.scene.film
        result = np.empty((film.height, film.width, 3) if positions is None else (len(positions), 3))
        self._world.sensitivity(
            film_xy=positions,
            normal=_per_object(normal, objects),
            position_m=_per_object(position_m, objects),
            result=result,
            threads=threads,
            cancel=cancel,
        )
        return result

    def _trace(
        self,
        channels: Sequence[str],
        leading: tuple[int, ...],
        film_xy: npt.NDArray[np.float64] | None,
        threads: int,
        cancel: _tracer.Cancel | None,
    ) -> Arrays:
        arrays = self._arrays(channels, leading)
        self._world.trace(film_xy=film_xy, arrays=arrays, threads=threads, cancel=cancel)
        return arrays

    def _arrays(self, channels: Sequence[str], leading: tuple[int, ...]) -> Arrays:
        unknown = [name for name in channels if name not in CHANNELS]
        if unknown:
            raise _tracer.TracerError(f"channels: got {', '.join(unknown)}, allowed {', '.join(CHANNELS)}")
        return {name: CHANNELS[name].empty(leading, self._lights) for name in channels}


def _checked(precision: Precision) -> Precision:
    if precision not in get_args(Precision):
        raise _tracer.TracerError(f"precision: got {precision!r}, allowed {', '.join(map(repr, get_args(Precision)))}")
    return precision


def _positions(film_xy: npt.ArrayLike) -> npt.NDArray[np.float64]:
    positions = np.ascontiguousarray(film_xy, dtype=np.float64)
    if positions.ndim != 2 or positions.shape[1] != 2:
        raise _tracer.TracerError(f"film_xy: got shape {positions.shape}, allowed (n, 2)")
    return positions


def _per_object(bound: npt.ArrayLike, objects: int) -> npt.NDArray[np.float64]:
    values = np.asarray(bound, dtype=np.float64)
    if values.ndim and values.shape != (objects,):
        raise _tracer.TracerError(f"bounds: got shape {values.shape}, allowed one number or ({objects},)")
    return np.ascontiguousarray(np.broadcast_to(values, (objects,)))
