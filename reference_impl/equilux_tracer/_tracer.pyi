"""The exact tracer of equilux: Embree finds candidates, double and double-double decide and shade."""

import enum
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

embree_version: str

def limit_packets(lanes: int) -> None:
    """Let packets in double have no more lanes than this: 4, 8 or 16, 0 for none. For tests: no picture depends on it."""

_Triple = Sequence[float]
_Doubles = npt.NDArray[np.float64]

class TracerError(ValueError):
    """A scene, a channel or an array that the tracer refuses; the message says which and why."""

class Cancelled(RuntimeError):
    """The render was stopped through its Cancel before it was complete."""

class Projection(enum.Enum):
    perspective = 0
    orthographic = 1

class Model(enum.Enum):
    phong = 0
    opengl = 1
    raytraced = 2
    reflection_equation = 3

class EmitterKind(enum.Enum):
    sphere = 0
    disc = 1
    rectangle = 2

class Brdf(enum.Enum):
    lambert = 0
    phong_classic = 1
    phong_cosine = 2

class LightKind(enum.Enum):
    point = 0
    directional = 1
    spot = 2

class ShapeKind(enum.Enum):
    sphere = 0
    plane = 1
    box = 2
    disc = 3
    rectangle = 4
    cylinder = 5
    mesh = 6

class Cancel:
    """Stops a render from another thread: pass it as `cancel`, then call `cancel()`."""

    def __init__(self) -> None: ...
    def cancel(self) -> None:
        """Ask to stop; the render raises Cancelled soon after."""

    @property
    def cancelled(self) -> bool: ...

class Mesh:
    """Triangles in object coordinates; any number of descriptions may hold them."""

    def __init__(self, *, vertices: _Doubles, faces: npt.NDArray[np.int64], vertex_normals: _Doubles | None) -> None: ...

class SceneDescription:
    """The scene as plain numbers, world coordinates, SI units."""

    def __init__(self) -> None: ...
    def set_model(self, *, model: Model, recursion_limit: int, attenuated_shadows: bool, infinite_viewer: bool) -> None: ...
    def set_camera(
        self, *, projection: Projection, eye: _Triple, target: _Triple, up: _Triple, fov_y_deg: float = 0.0, height_m: float = 0.0
    ) -> None: ...
    def set_error_target(self, error_target: float) -> None: ...
    def set_rules(self, **fields: bool | float | str) -> None:
        """Every field of ShadingRules."""

    def set_film(self, width: int, height: int) -> None: ...
    def set_surroundings(self, *, ambient: _Triple, background: _Triple, has_environment: bool = False) -> None: ...
    def add_light(
        self,
        *,
        kind: LightKind,
        strength: _Triple,
        position: _Triple = ...,
        direction: _Triple = ...,
        attenuation: _Triple = ...,
        cone_half_angle_deg: float = 90.0,
        exponent: float = 0.0,
        ambient: _Triple = ...,
        diffuse: _Triple = ...,
        specular: _Triple = ...,
    ) -> None: ...
    def add_emitter(
        self, *, kind: EmitterKind, radiance: _Triple, a: _Triple, b: _Triple = ..., c: _Triple = ..., radius: float = 0.0
    ) -> None: ...
    def add_material(
        self,
        *,
        diffuse: _Triple,
        specular: _Triple,
        exponent: float,
        ambient: _Triple,
        emission: _Triple,
        reflection: _Triple = ...,
        transmission: _Triple = ...,
        transparency: float = 0.0,
        ior: float = 1.0,
        brdf: Brdf = ...,
    ) -> int: ...
    def add_mesh(self, mesh: Mesh) -> int: ...
    def add_object(
        self,
        *,
        kind: ShapeKind,
        material: int,
        matrix: Sequence[float],
        a: _Triple = ...,
        b: _Triple = ...,
        c: _Triple = ...,
        radius: float = 0.0,
        capped: bool = True,
        mesh: int = -1,
    ) -> None: ...

class World:
    """A scene prepared for tracing; read-only, any number of threads may trace it."""

    def __init__(self, scene: SceneDescription) -> None: ...
    def trace(
        self, *, film_xy: _Doubles | None, arrays: dict[str, npt.NDArray[Any]], threads: int, cancel: Cancel | None
    ) -> None:
        """Fill the arrays, keyed by channel name, each with as many elements as the samples need."""

    def sensitivity(
        self,
        *,
        film_xy: _Doubles | None,
        normal: _Doubles,
        position_m: _Doubles,
        result: _Doubles,
        threads: int,
        cancel: Cancel | None,
    ) -> None:
        """Fill `result`, three bands per sample."""

class FloatMode:
    """A world in single precision, for packets of rays. Read-only once made, any number of threads may use it."""

    def __init__(self, world: World, width: int = 0) -> None:
        """width: of the packets, 4, 8 or 16; 0: the widest there is. Raises TracerError for what is not covered."""

    @property
    def width(self) -> int: ...
    @property
    def displacement_px(self) -> float: ...
    def render(
        self,
        *,
        radiance: npt.NDArray[np.float32],
        rounding: npt.NDArray[np.float32] | None,
        threads: int,
        cancel: Cancel | None,
    ) -> None:
        """Fill radiance and, if given, the bound of its arithmetic error: three bands per pixel, row by row."""

    def traverse(self, *, threads: int) -> tuple[int, int, float]:
        """Trace the same rays without shading: eye rays, shadow rays, seconds."""

    def refine(
        self,
        *,
        radiance: _Doubles,
        rounding: _Doubles | None,
        threads: int,
        cancel: Cancel | None,
    ) -> None:
        """The same in double: packets find the first surfaces, everything else is exact."""
