"""Lights → entries of Mitsuba's scene, as text."""

from __future__ import annotations

import numpy as np

from equilux_adapters.mitsuba.text import number, triple
from equilux_scenes.model import (
    Attenuation,
    DirectionalLight,
    DiscEmitter,
    EnvironmentEmitter,
    Light,
    PointLight,
    RectangleEmitter,
    SphereEmitter,
    SpotLight,
)
from equilux_scenes.transforms import unit


def emitter(light: Light) -> str:
    """The dictionary of one light."""
    if isinstance(light, EnvironmentEmitter):
        return f'{{"type": "constant", "radiance": bands{triple(light.radiance)}}}'
    if isinstance(light, DirectionalLight):
        given = f'"direction": {_list(unit(light.direction))}, "irradiance": bands{triple(light.irradiance)}'
        return f'{{"type": "directional", {given}}}'
    if isinstance(light, PointLight | SpotLight):
        return _point(light) if _inverse_square(light.attenuation) and not _narrowing(light) else _lamp(light)
    assert isinstance(light, SphereEmitter | DiscEmitter | RectangleEmitter)
    shines = f'"emitter": {{"type": "area", "radiance": bands{triple(light.radiance)}}}, "bsdf": black()'
    return f"{{{_surface(light)}, {shines}}}"


def _inverse_square(attenuation: Attenuation) -> bool:
    return attenuation.constant == 0 and attenuation.linear == 0


def _narrowing(light: PointLight | SpotLight) -> bool:
    return isinstance(light, SpotLight) and light.exponent > 0


def _point(light: PointLight | SpotLight) -> str:
    """Mitsuba's own, where it has what the light asks for."""
    intensity = f"bands{triple(value / light.attenuation.quadratic for value in light.intensity)}"
    if isinstance(light, PointLight):
        return f'{{"type": "point", "position": {_list(light.position)}, "intensity": {intensity}}}'
    along = np.asarray(unit(light.direction))
    x, y = frame(along)
    to_world = f"placed({triple(x)}, {triple(y)}, {triple(along)}, {triple(light.position)})"
    cone = number(light.cone_half_angle_deg)  # no falloff between beam and cutoff: a hard cone (Q7)
    return f'{{"type": "spot", "to_world": {to_world}, "intensity": {intensity}, "cutoff_angle": {cone}, "beam_width": {cone}}}'


def _lamp(light: PointLight | SpotLight) -> str:
    """Registered by the script (Q8)."""
    terms = (light.attenuation.constant, light.attenuation.linear, light.attenuation.quadratic)
    given = [f"position={triple(light.position)}, intensity={triple(light.intensity)}, attenuation={triple(terms)}"]
    if isinstance(light, SpotLight):
        given.append(f"direction={triple(light.direction)}, half_angle_deg={number(light.cone_half_angle_deg)}")
        given.append(f"exponent={number(light.exponent)}")
    return f"lamp({', '.join(given)})"


def _surface(light: SphereEmitter | DiscEmitter | RectangleEmitter) -> str:
    if isinstance(light, SphereEmitter):
        return f'"type": "sphere", "center": {_list(light.center)}, "radius": {number(light.radius)}'
    if isinstance(light, DiscEmitter):
        return f'"type": "disk", "to_world": {disc_placement(light.center, light.normal, light.radius)}'
    return f'"type": "rectangle", "to_world": {rectangle_placement(light.corner, light.edge_u, light.edge_v)}'


def disc_placement(center: object, normal: tuple[float, float, float], radius: float) -> str:
    """Of Mitsuba's disk, which has radius 1, lies across z and faces it."""
    z = np.asarray(unit(normal))
    x, y = frame(z)
    return f"turned({triple(x)}, {triple(y)}, {triple(z)}, {triple(np.asarray(center, dtype=float))}, {number(radius)})"


def rectangle_placement(corner: object, edge_u: object, edge_v: object) -> str:
    """Of Mitsuba's rectangle, which reaches from -1 to 1 in x and y and faces z."""
    u, v = np.asarray(edge_u, dtype=float), np.asarray(edge_v, dtype=float)
    across = np.cross(u / np.max(np.abs(u)), v / np.max(np.abs(v)))
    middle = np.asarray(corner, dtype=float) + (u + v) / 2
    return f"placed({triple(u / 2)}, {triple(v / 2)}, {triple(across / np.linalg.norm(across))}, {triple(middle)})"


def frame(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit x and y, so that x, y, z are right-handed."""
    least = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(least, z)
    x /= np.linalg.norm(x)
    return x, np.cross(z, x)


def _list(values: object) -> str:
    return f"[{', '.join(number(value) for value in np.asarray(values, dtype=float))}]"
