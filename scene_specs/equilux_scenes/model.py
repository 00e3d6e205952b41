"""The typed scene: what a spec means once it has been read and every default has been filled in.

Frozen pydantic models, one class per `kind`. Units are SI and bands are linear: see CONVENTIONS.md. The meaning of every term is
the lighting model's; nothing here evaluates it. A term of another lighting model than the scene's is marked `OnlyIn` and keeps
its default.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from equilux_scenes.values import (
    Allowed,
    Bands,
    Count,
    Direction,
    Directions,
    Factors,
    Fraction,
    Intervals,
    LuminousEfficacy,
    Matrix4,
    NonNegative,
    Number,
    OnlyIn,
    OrFrom,
    Points,
    Positive,
    Samples,
    Temperature,
    Text,
    Triangles,
    Vector3,
    Wavelength,
    Words,
)

LIGHTING_MODELS = {
    "phong": "local: no occlusion, both faces of a surface lit alike",
    "opengl": "the fixed-function rules, per point",
    "raytraced": "occlusion, mirror reflection and refraction, to a recursion limit",
    "reflection-equation": "direct light of extended emitters, integrated over the hemisphere",
}
"""Every lighting model, and what it is."""

ZERO = (0.0, 0.0, 0.0)
ONE = (1.0, 1.0, 1.0)

Absent = SkipJsonSchema[None]
"""Of a key that may be left out; written as null it is an error."""


class Part(BaseModel):
    """Base of every part of a spec: immutable, no unknown keys, no silent conversion, no NaN or Inf."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, use_attribute_docstrings=True)

    kinds_only_in: ClassVar[OnlyIn | None] = None
    """The models that have this kind of part, where not all do."""


# --- camera and film --------------------------------------------------------------------------------------------------


class PerspectiveCamera(Part):
    """A pinhole camera. right = forward × up, forward from eye to target; pixels are square, rows go downwards."""

    projection: Literal["perspective"]
    eye: Vector3
    """Where the rays start, metres."""
    target: Vector3
    """A point on the view axis, metres."""
    up: Direction = (0.0, 1.0, 0.0)
    """Any direction not parallel to the view; the picture's upward direction is its part across the view."""
    fov_y_deg: Annotated[float, Field(gt=0, lt=180), Allowed("a number in the open interval (0, 180)")]
    """Full vertical field of view, degrees."""


class OrthographicCamera(Part):
    """A camera with parallel rays, which start at the eye's plane."""

    projection: Literal["orthographic"]
    eye: Vector3
    """A point of the plane where the rays start, metres; the middle of the film."""
    target: Vector3
    """A point on the view axis, metres."""
    up: Direction = (0.0, 1.0, 0.0)
    """Any direction not parallel to the view; the picture's upward direction is its part across the view."""
    height_m: Positive
    """Full height of the film, metres."""


Camera = Annotated[PerspectiveCamera | OrthographicCamera, Field(discriminator="projection")]


class Film(Part):
    """The pixels; each is sampled at its centre."""

    width: Count
    """Columns."""
    height: Count
    """Rows; row 0 is on top."""


# --- bands and spectra ------------------------------------------------------------------------------------------------


class BandIntervals(Part):
    """Bands that are intervals of wavelengths, instead of the linear Rec.709 primaries."""

    intervals_nm: Intervals
    """Each band is the integral of the spectrum over its interval, ends included; intervals do not overlap."""


class Spectrum(Part):
    """A spectral density: exactly one of table, blackbody, illuminant, line_nm. Linear between samples, 0 outside them.

    It is absolute where that has a meaning (a table; a blackbody that an emitter is made of), and relative where a strength is
    given: `total`, or a flux or a luminous quantity of the light.
    """

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": [key]} for key in ("table", "blackbody", "illuminant", "line_nm")]}
    )

    table: Samples | Absent = None
    """Pairs [wavelength in nm, value]; the value per nm, in the unit of the light's bands."""
    blackbody: Temperature | Absent = None
    """Planck's law at this temperature, K."""
    illuminant: Annotated[str | Absent, Allowed("the name of a CIE illuminant, such as D65")] = None
    """The name of a CIE illuminant, such as D65; relative."""
    line_nm: Wavelength | Absent = None
    """A single wavelength, nm; relative."""
    total: NonNegative | Absent = None
    """The integral over all wavelengths, in the unit of the light's bands."""


# --- lights -----------------------------------------------------------------------------------------------------------


class Strength(Part):
    """Base of all lights: how strong they are, in bands or in what determines them.

    Once a scene has been read, the bands (`intensity`, `irradiance` or `radiance`) are always there; what was written instead of
    them stays visible in the other keys.
    """

    spectrum: Spectrum | Absent = None
    """Makes the bands."""


class Attenuation(Part):
    """E = I / (constant + linear r + quadratic r²). Given in part, the others are 0."""

    constant: NonNegative = 0.0
    """m²"""
    linear: NonNegative = 0.0
    """m"""
    quadratic: NonNegative = 0.0
    """Dimensionless."""


INVERSE_SQUARE = Attenuation(quadratic=1.0)


class LightColours(Strength):
    """The separate colours of a light that the fixed-function model has; they multiply its intensity or irradiance."""

    ambient: Annotated[Bands, OnlyIn("opengl")] = ZERO
    """Share of the light that counts as ambient."""
    diffuse: Annotated[Bands, OnlyIn("opengl")] = ONE
    """Share of the light in the diffuse term."""
    specular: Annotated[Bands, OnlyIn("opengl")] = ONE
    """Share of the light in the highlight."""


class PointLight(LightColours):
    """A light at a point, shining alike in all directions."""

    kind: Literal["point"]
    position: Vector3
    """Metres."""
    intensity: Annotated[Bands, OrFrom("luminous_intensity", "flux", "luminous_flux", "spectrum")]
    """Radiant intensity, W/sr."""
    luminous_intensity: NonNegative | Absent = None
    """Luminous intensity, cd; without a spectrum equal bands."""
    flux: Bands | Absent = None
    """Radiant flux into all directions, W = 4π times the intensity."""
    luminous_flux: NonNegative | Absent = None
    """Luminous flux into all directions, lm; without a spectrum equal bands."""
    attenuation: Attenuation = INVERSE_SQUARE


class DirectionalLight(LightColours):
    """A light at infinity."""

    kind: Literal["directional"]
    direction: Direction
    """The way the light travels."""
    irradiance: Annotated[Bands, OrFrom("illuminance", "spectrum")]
    """On a surface that faces the light, W/m²."""
    illuminance: NonNegative | Absent = None
    """On a surface that faces the light, lx; without a spectrum equal bands."""


class SpotLight(LightColours):
    """A point light with a hard cone: cos^exponent of the angle to the axis inside (the edge included), 0 outside."""

    kind: Literal["spot"]
    position: Vector3
    """Metres."""
    direction: Direction
    """The way the light travels along the axis."""
    intensity: Annotated[Bands, OrFrom("luminous_intensity", "flux", "luminous_flux", "spectrum")]
    """Radiant intensity on the axis, W/sr."""
    luminous_intensity: NonNegative | Absent = None
    """Luminous intensity on the axis, cd; without a spectrum equal bands."""
    flux: Bands | Absent = None
    """Radiant flux of the whole cone, W."""
    luminous_flux: NonNegative | Absent = None
    """Luminous flux of the whole cone, lm; without a spectrum equal bands."""
    cone_half_angle_deg: Annotated[float, Field(gt=0, le=90), Allowed("a number in the interval (0, 90]")]
    """From the axis to the edge of the cone, degrees."""
    exponent: NonNegative = 0.0
    """Power of the cosine of the angle to the axis."""
    attenuation: Attenuation = INVERSE_SQUARE


class Emitter(Strength):
    """Base of the lights of model `reflection-equation` that have an extent: uniform, diffuse, seen by the camera."""

    kinds_only_in: ClassVar[OnlyIn | None] = OnlyIn("reflection-equation")

    radiance: Annotated[Bands, OrFrom("luminance", "spectrum")]
    """W/(m²·sr), alike in all directions in which it shines."""
    luminance: NonNegative | Absent = None
    """cd/m²; without a spectrum equal bands."""


class SurfaceEmitter(Emitter):
    """An emitter that is a surface, and so has a flux: π times its area times its radiance."""

    radiance: Annotated[Bands, OrFrom("luminance", "flux", "luminous_flux", "spectrum")]
    """W/(m²·sr), alike in all directions in which it shines."""
    flux: Bands | Absent = None
    """Radiant flux of the whole surface, W."""
    luminous_flux: NonNegative | Absent = None
    """Luminous flux of the whole surface, lm; without a spectrum equal bands."""


class SphereEmitter(SurfaceEmitter):
    """An opaque sphere that shines outward."""

    kind: Literal["sphere"]
    center: Vector3
    """Metres."""
    radius: Positive
    """Metres."""


class DiscEmitter(SurfaceEmitter):
    """An opaque disc that shines on its normal's side and is black behind."""

    kind: Literal["disc"]
    center: Vector3
    """Metres."""
    normal: Direction
    radius: Positive
    """Metres."""


class RectangleEmitter(SurfaceEmitter):
    """An opaque rectangle that shines on the side of edge_u × edge_v and is black behind."""

    kind: Literal["rectangle"]
    corner: Vector3
    """Metres."""
    edge_u: Direction
    """From the corner to the next one, metres."""
    edge_v: Direction
    """From the corner to the other next one, orthogonal to edge_u, metres."""


class EnvironmentEmitter(Emitter):
    """What every ray that misses sees, in all directions alike."""

    kind: Literal["environment"]


DeltaLight = PointLight | DirectionalLight | SpotLight
"""The lights without an extent; the camera does not see them."""

AreaEmitter = SphereEmitter | DiscEmitter | RectangleEmitter
"""The emitters that are surfaces."""

Light = Annotated[
    PointLight | DirectionalLight | SpotLight | SphereEmitter | DiscEmitter | RectangleEmitter | EnvironmentEmitter,
    Field(discriminator="kind"),
]


# --- materials --------------------------------------------------------------------------------------------------------


class Material(Part):
    """Literal coefficients: never an albedo, never normalised, never divided by π."""

    diffuse: Bands = ZERO
    """K_diff, 1/sr."""
    specular: Bands = ZERO
    """K_spec, 1/sr."""
    exponent: NonNegative = 1.0
    """p of the highlight (R·V)^p."""
    ambient: Annotated[Bands, OnlyIn("phong", "opengl", "raytraced")] = ZERO
    """K_amb, multiplies the scene's ambient radiance."""
    emission: Bands = ZERO
    """K_emit, W/(m²·sr)."""
    brdf: Annotated[Literal["lambert", "phong-classic", "phong-cosine"], OnlyIn("reflection-equation")] = "phong-classic"
    """lambert: f_r = K_diff. phong-classic: f_r cosθ_i = K_diff cosθ_i + K_spec (R·V)^p. phong-cosine: f_r = K_diff +
    K_spec (R·V)^p."""
    reflection: Annotated[Bands, OnlyIn("raytraced")] = ZERO
    """k_refl, weight of the mirrored radiance."""
    transmission: Annotated[Bands, OnlyIn("raytraced")] = ZERO
    """k_trans, weight of the refracted radiance."""
    transparency: Annotated[Fraction, OnlyIn("raytraced")] = 0.0
    """t: the surface is weighted 1 − t, what lies behind it t."""
    ior: Annotated[Positive, OnlyIn("raytraced")] = 1.0
    """Index of refraction on the inner side; 1 on the outer."""


# --- objects ----------------------------------------------------------------------------------------------------------


class Rotation(Part):
    """A right-handed rotation about an axis through the origin."""

    axis: Direction
    degrees: Number


class TransformStep(Part):
    """Exactly one of the four. Steps are applied in the order they are written."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    scale: Factors | Absent = None
    rotate: Rotation | Absent = None
    translate: Vector3 | Absent = None
    """Metres."""
    matrix: Matrix4 | Absent = None
    """4×4, row by row, acting on column vectors; the last row is [0, 0, 0, 1]."""


class Shape(Part):
    """What every object has."""

    material: Annotated[str, Allowed("the name of one of the scene's materials")]
    """The name of one of the scene's materials."""
    transform: tuple[TransformStep, ...] = ()
    """Object → world."""


class Sphere(Shape):
    """A sphere."""

    kind: Literal["sphere"]
    center: Vector3
    """Metres."""
    radius: Positive
    """Metres."""


class Plane(Shape):
    """An infinite plane."""

    kind: Literal["plane"]
    point: Vector3
    """Any of its points, metres."""
    normal: Direction


class Box(Shape):
    """A box with faces across the coordinate axes."""

    kind: Literal["box"]
    min: Vector3
    """Its corner with the smallest coordinates, metres."""
    max: Vector3
    """Its corner with the largest coordinates, metres."""


class Disc(Shape):
    """A flat disc."""

    kind: Literal["disc"]
    center: Vector3
    """Metres."""
    normal: Direction
    radius: Positive
    """Metres."""


class Rectangle(Shape):
    """A flat rectangle; its normal is edge_u × edge_v."""

    kind: Literal["rectangle"]
    corner: Vector3
    """Metres."""
    edge_u: Direction
    """From the corner to the next one, metres."""
    edge_v: Direction
    """From the corner to the other next one, orthogonal to edge_u, metres."""


class Cylinder(Shape):
    """A round cylinder."""

    kind: Literal["cylinder"]
    base: Vector3
    """Middle of one end, metres."""
    top: Vector3
    """Middle of the other end, metres."""
    radius: Positive
    """Metres."""
    capped: Annotated[bool, Allowed("true or false")] = True
    """Whether the ends are closed by discs."""


class Mesh(Shape):
    """Triangles, from a file or inline. Their geometric normal follows the right hand: counter-clockwise seen from its side."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["file"]}, {"required": ["vertices", "faces"]}]})

    kind: Literal["mesh"]
    normals: Annotated[Literal["flat", "smooth"], Allowed("flat or smooth")] = "flat"
    """flat: the triangles' own normals. smooth: vertex normals, where none are given those weighted by area and angle."""
    file: Annotated[str | Absent, Allowed("the name of a .obj or .ply file in the scene's folder")] = None
    """A .obj or .ply file in the scene's folder or below it."""
    vertices: Points | Absent = None
    """Metres."""
    faces: Triangles | Absent = None
    """Triangles as vertex numbers, counted from 0."""
    vertex_normals: Directions | Absent = None
    """One direction per vertex."""


Object = Annotated[Sphere | Plane | Box | Disc | Rectangle | Cylinder | Mesh, Field(discriminator="kind")]


# --- the scene --------------------------------------------------------------------------------------------------------


class SweepAxis(Part):
    """One value of the spec that takes several values in turn."""

    path: Text
    """Keys and list positions from the root, joined by dots: `materials.clay.exponent`."""
    values: Annotated[tuple[Any, ...], Field(min_length=1), Allowed("a list of at least one value")]


class Expectation(Part):
    """A known divergence, pinned both ways: a new one fails, a vanished one fails too."""

    adapter: Annotated[str, Field(min_length=1), Allowed("the name of an adapter")]
    cause: Annotated[str, Allowed("a cause id")]
    """A cause id: `equilux_scenes.causes`, or a third party's `name:cause`."""
    when: Annotated[str | Absent, Allowed("comparisons of sweep axes with numbers")] = None
    """For which cases: `exponent > 128 and size == 1`."""


def _exact_int(value: Any) -> Any:
    """`true` and `1.0` equal 1 in Python, and are no spec version."""
    if type(value) is not int:
        raise ValueError("not an integer")
    return value


class Scene(Part):
    """One scene: everything that determines its picture in every renderer."""

    equilux: Annotated[Literal[1], BeforeValidator(_exact_int), Allowed("1, the version of the spec language")]
    name: Annotated[str, Field(pattern="^[a-z0-9-]+$", max_length=100), Allowed("1 to 100 of a to z, 0 to 9 and -")]
    about: Text = ""
    """What the scene shows, in a sentence."""
    shows: Words = ()
    """Rows of the lecture that the scene shows: ids of `equilux_scenes.lecture`."""
    model: Literal["phong", "opengl", "raytraced", "reflection-equation"]
    """The lighting model that the scene is about."""
    camera: Camera
    film: Film
    ambient: Annotated[Bands, OnlyIn("phong", "opengl", "raytraced")] = ZERO
    """L_amb, W/(m²·sr)."""
    background: Bands = ZERO
    """Radiance of rays that miss, W/(m²·sr)."""
    k_m: LuminousEfficacy = 683.002
    """K_m, lm/W: converts luminous quantities."""
    bands: BandIntervals | Absent = None
    """What the three bands are; left out, the linear Rec.709 primaries."""
    lights: dict[str, Light] = {}
    materials: dict[str, Material] = {}
    objects: tuple[Object, ...] = ()
    """May be left out only where there is an emitter to be seen."""
    recursion_limit: Annotated[int, Field(ge=0), Allowed("an integer ≥ 0"), OnlyIn("raytraced")] = 8
    """How many reflected or refracted rays in succession."""
    transparent_shadows: Annotated[Literal["attenuate", "ignore"], Allowed("attenuate or ignore"), OnlyIn("raytraced")] = (
        "attenuate"
    )
    """What a transparent object does to light that crosses it."""
    viewer: Annotated[Literal["local", "infinite"], Allowed("local or infinite"), OnlyIn("opengl")] = "local"
    """Whether V is taken to the eye point or is minus the view direction everywhere."""
    sweep: dict[str, SweepAxis] = {}
    """Axes; the cases are their product, in file order."""
    expect: tuple[Expectation, ...] = ()
    """Divergences that are known."""

    @property
    def delta_lights(self) -> dict[str, DeltaLight]:
        """The lights without an extent, by name; in every model but `reflection-equation` these are all."""
        return {name: light for name, light in self.lights.items() if isinstance(light, DeltaLight)}

    @property
    def area_emitters(self) -> dict[str, AreaEmitter]:
        """The emitters that are surfaces, by name."""
        return {name: light for name, light in self.lights.items() if isinstance(light, AreaEmitter)}

    @property
    def environment(self) -> EnvironmentEmitter | None:
        """What missing rays see, if the scene has an environment."""
        return next((light for light in self.lights.values() if isinstance(light, EnvironmentEmitter)), None)
