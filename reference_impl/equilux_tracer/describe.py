"""A typed scene → the plain numbers of the tracer's own scene description."""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

from equilux_scenes.case import Case
from equilux_scenes.mesh import TriangleMesh
from equilux_scenes.model import (
    AreaEmitter,
    Attenuation,
    Box,
    Cylinder,
    DeltaLight,
    DirectionalLight,
    Disc,
    DiscEmitter,
    Material,
    Mesh,
    Object,
    OrthographicCamera,
    PerspectiveCamera,
    Plane,
    PointLight,
    Rectangle,
    RectangleEmitter,
    Sphere,
    SphereEmitter,
)
from equilux_scenes.transforms import matrix
from equilux_tracer import _tracer

_MODELS = {
    "phong": _tracer.Model.phong,
    "opengl": _tracer.Model.opengl,
    "raytraced": _tracer.Model.raytraced,
    "reflection-equation": _tracer.Model.reflection_equation,
}
_BRDFS = {
    "lambert": _tracer.Brdf.lambert,
    "phong-classic": _tracer.Brdf.phong_classic,
    "phong-cosine": _tracer.Brdf.phong_cosine,
}

_COPIES: WeakKeyDictionary[TriangleMesh, _tracer.Mesh] = WeakKeyDictionary()
"""The tracer's copy of each mesh, as long as the mesh lives: one is enough for all worlds of a case and of its changes. Nobody
changes the arrays of a TriangleMesh."""


def describe(case: Case) -> _tracer.SceneDescription:
    """The case as the tracer wants it. Raises TracerError for a scene that it cannot hold."""
    scene = case.scene
    description = _tracer.SceneDescription()
    description.set_model(
        model=_MODELS[scene.model],
        recursion_limit=scene.recursion_limit,
        attenuated_shadows=scene.transparent_shadows == "attenuate",
        infinite_viewer=scene.viewer == "infinite",
    )
    _describe_camera(description, scene.camera)
    description.set_film(scene.film.width, scene.film.height)
    environment = scene.environment
    description.set_surroundings(
        ambient=scene.ambient,
        background=scene.background if environment is None else environment.radiance,
        has_environment=environment is not None,
    )
    for light in scene.delta_lights.values():
        _describe_light(description, light)
    for emitter in scene.area_emitters.values():
        _describe_emitter(description, emitter)
    materials = {name: _describe_material(description, material) for name, material in scene.materials.items()}
    for index, obj in enumerate(scene.objects):
        shape = _shape(obj)
        if isinstance(obj, Mesh):
            shape["mesh"] = description.add_mesh(_copied(case.meshes[index]))
        description.add_object(material=materials[obj.material], matrix=matrix(obj).ravel().tolist(), **shape)
    return description


def _copied(mesh: TriangleMesh) -> _tracer.Mesh:
    copy = _COPIES.get(mesh)
    if copy is None:
        copy = _tracer.Mesh(vertices=mesh.vertices, faces=mesh.faces, vertex_normals=mesh.vertex_normals)
        _COPIES[mesh] = copy
    return copy


def _describe_camera(description: _tracer.SceneDescription, camera: PerspectiveCamera | OrthographicCamera) -> None:
    if isinstance(camera, PerspectiveCamera):
        projection, size = _tracer.Projection.perspective, {"fov_y_deg": camera.fov_y_deg}
    else:
        projection, size = _tracer.Projection.orthographic, {"height_m": camera.height_m}
    description.set_camera(projection=projection, eye=camera.eye, target=camera.target, up=camera.up, **size)


def _describe_emitter(description: _tracer.SceneDescription, emitter: AreaEmitter) -> None:
    kind = _tracer.EmitterKind
    match emitter:
        case SphereEmitter():
            description.add_emitter(kind=kind.sphere, radiance=emitter.radiance, a=emitter.center, radius=emitter.radius)
        case DiscEmitter():
            description.add_emitter(
                kind=kind.disc, radiance=emitter.radiance, a=emitter.center, b=emitter.normal, radius=emitter.radius
            )
        case RectangleEmitter():
            description.add_emitter(
                kind=kind.rectangle, radiance=emitter.radiance, a=emitter.corner, b=emitter.edge_u, c=emitter.edge_v
            )


def _describe_light(description: _tracer.SceneDescription, light: DeltaLight) -> None:
    kind = _tracer.LightKind
    colours: dict[str, Any] = {"ambient": light.ambient, "diffuse": light.diffuse, "specular": light.specular}
    if isinstance(light, DirectionalLight):
        description.add_light(kind=kind.directional, strength=light.irradiance, direction=light.direction, **colours)
    elif isinstance(light, PointLight):
        description.add_light(
            kind=kind.point,
            strength=light.intensity,
            position=light.position,
            attenuation=_terms(light.attenuation),
            **colours,
        )
    else:
        description.add_light(
            kind=kind.spot,
            strength=light.intensity,
            position=light.position,
            direction=light.direction,
            attenuation=_terms(light.attenuation),
            cone_half_angle_deg=light.cone_half_angle_deg,
            exponent=light.exponent,
            **colours,
        )


def _terms(attenuation: Attenuation) -> tuple[float, float, float]:
    return attenuation.constant, attenuation.linear, attenuation.quadratic


def _describe_material(description: _tracer.SceneDescription, material: Material) -> int:
    return description.add_material(
        diffuse=material.diffuse,
        specular=material.specular,
        exponent=material.exponent,
        ambient=material.ambient,
        emission=material.emission,
        reflection=material.reflection,
        transmission=material.transmission,
        transparency=material.transparency,
        ior=material.ior,
        brdf=_BRDFS[material.brdf],
    )


def _shape(obj: Object) -> dict[str, Any]:
    """What `add_object` calls a, b, c, … of each shape: see ObjectDescription in scene_description.h."""
    kind = _tracer.ShapeKind
    match obj:
        case Sphere():
            return {"kind": kind.sphere, "a": obj.center, "radius": obj.radius}
        case Plane():
            return {"kind": kind.plane, "a": obj.point, "b": obj.normal}
        case Box():
            return {"kind": kind.box, "a": obj.min, "b": obj.max}
        case Disc():
            return {"kind": kind.disc, "a": obj.center, "b": obj.normal, "radius": obj.radius}
        case Rectangle():
            return {"kind": kind.rectangle, "a": obj.corner, "b": obj.edge_u, "c": obj.edge_v}
        case Cylinder():
            return {"kind": kind.cylinder, "a": obj.base, "b": obj.top, "radius": obj.radius, "capped": obj.capped}
        case Mesh():
            return {"kind": kind.mesh}
