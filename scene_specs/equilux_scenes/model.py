"""The typed scene: what a spec means once it has been read and every default has been filled in.

Frozen pydantic models, one class per `kind`. Units are SI and bands are linear: see CONVENTIONS.md. The meaning of every term is
the lighting model's; nothing here evaluates it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

Vector3 = Annotated[tuple[float, float, float], BeforeValidator(lambda v: tuple(v) if isinstance(v, list) else v)]
"""Three world coordinates, metres."""


def _three_bands(value: Any) -> Any:
    """One number stands for three equal bands."""
    if isinstance(value, list):
        return tuple(value)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return (value, value, value)
    return value


NonNegative = Annotated[float, Field(ge=0)]
Positive = Annotated[float, Field(gt=0)]
Bands = Annotated[tuple[NonNegative, NonNegative, NonNegative], BeforeValidator(_three_bands)]
"""One radiometric quantity in three linear bands."""


class Part(BaseModel):
    """Base of every part of a spec: immutable, no unknown keys, no silent conversion, no NaN or Inf."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


# --- camera and film --------------------------------------------------------------------------------------------------


class PerspectiveCamera(Part):
    projection: Literal["perspective"]
    eye: Vector3
    target: Vector3
    up: Vector3 = (0.0, 1.0, 0.0)
    fov_y_deg: Annotated[float, Field(gt=0, lt=180)]


class OrthographicCamera(Part):
    projection: Literal["orthographic"]
    eye: Vector3
    target: Vector3
    up: Vector3 = (0.0, 1.0, 0.0)
    height_m: Positive


Camera = Annotated[PerspectiveCamera | OrthographicCamera, Field(discriminator="projection")]


class Film(Part):
    width: Annotated[int, Field(ge=1)]
    height: Annotated[int, Field(ge=1)]


# --- lights -----------------------------------------------------------------------------------------------------------


class Attenuation(Part):
    """E = I / (constant + linear r + quadratic r²); in m², m and 1. Given in part, the others are 0."""

    constant: NonNegative = 0.0
    linear: NonNegative = 0.0
    quadratic: NonNegative = 0.0


INVERSE_SQUARE = Attenuation(quadratic=1.0)


class PointLight(Part):
    kind: Literal["point"]
    position: Vector3
    intensity: Bands
    attenuation: Attenuation = INVERSE_SQUARE


class DirectionalLight(Part):
    kind: Literal["directional"]
    direction: Vector3  # the way the light travels
    irradiance: Bands


class SpotLight(Part):
    kind: Literal["spot"]
    position: Vector3
    direction: Vector3  # the way the light travels along the axis
    intensity: Bands  # on the axis
    cone_half_angle_deg: Annotated[float, Field(gt=0, le=90)]
    exponent: NonNegative = 0.0
    attenuation: Attenuation = INVERSE_SQUARE


Light = Annotated[PointLight | DirectionalLight | SpotLight, Field(discriminator="kind")]


# --- materials --------------------------------------------------------------------------------------------------------


class Material(Part):
    """Literal coefficients: diffuse and specular in 1/sr, ambient dimensionless, emission in W/(m²·sr)."""

    diffuse: Bands = (0.0, 0.0, 0.0)
    specular: Bands = (0.0, 0.0, 0.0)
    exponent: NonNegative = 1.0
    ambient: Bands = (0.0, 0.0, 0.0)
    emission: Bands = (0.0, 0.0, 0.0)
    reflection: Bands = (0.0, 0.0, 0.0)
    transmission: Bands = (0.0, 0.0, 0.0)
    transparency: Annotated[float, Field(ge=0, le=1)] = 0.0
    ior: Positive = 1.0


# --- objects ----------------------------------------------------------------------------------------------------------


class Rotation(Part):
    axis: Vector3
    degrees: float


class TransformStep(Part):
    """Exactly one of the four; steps are applied in the order they are written."""

    scale: float | Vector3 | None = None
    rotate: Rotation | None = None
    translate: Vector3 | None = None
    matrix: tuple[tuple[float, float, float, float], ...] | None = None  # 4×4, acts on column vectors


class Shape(Part):
    material: str
    transform: tuple[TransformStep, ...] = ()


class Sphere(Shape):
    kind: Literal["sphere"]
    center: Vector3
    radius: Positive


class Plane(Shape):
    kind: Literal["plane"]
    point: Vector3
    normal: Vector3


class Box(Shape):
    kind: Literal["box"]
    min: Vector3
    max: Vector3


class Disc(Shape):
    kind: Literal["disc"]
    center: Vector3
    normal: Vector3
    radius: Positive


class Rectangle(Shape):
    kind: Literal["rectangle"]
    corner: Vector3
    edge_u: Vector3
    edge_v: Vector3  # orthogonal to edge_u; the normal is edge_u × edge_v


class Cylinder(Shape):
    kind: Literal["cylinder"]
    base: Vector3
    top: Vector3
    radius: Positive
    capped: bool = True


class Mesh(Shape):
    kind: Literal["mesh"]
    normals: Literal["flat", "smooth"] = "flat"
    file: str | None = None
    vertices: tuple[Vector3, ...] | None = None
    faces: tuple[tuple[int, int, int], ...] | None = None
    vertex_normals: tuple[Vector3, ...] | None = None


Object = Annotated[Sphere | Plane | Box | Disc | Rectangle | Cylinder | Mesh, Field(discriminator="kind")]


# --- the scene --------------------------------------------------------------------------------------------------------


class SweepAxis(Part):
    path: str
    values: tuple[Any, ...]


class Expectation(Part):
    """A known divergence, pinned both ways: a new one fails, a vanished one fails too."""

    adapter: str
    cause: str
    when: str | None = None


class Scene(Part):
    equilux: Literal[1]
    name: str
    about: str = ""
    model: Literal["phong"]
    camera: Camera
    film: Film
    ambient: Bands = (0.0, 0.0, 0.0)
    background: Bands = (0.0, 0.0, 0.0)
    lights: dict[str, Light] = {}
    materials: dict[str, Material] = {}
    objects: tuple[Object, ...]
    sweep: dict[str, SweepAxis] = {}
    expect: tuple[Expectation, ...] = ()
