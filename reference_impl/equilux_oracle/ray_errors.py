"""How far rays in double-double may be off, and what that does to radiance.

Every bounce magnifies the error of a ray: a mirror of curvature κ turns a displacement x into an angle of up to 2 κ x, and the
next surface turns the angle, times the way there, into a displacement again. Each ray so carries two bounds along:

    lateral  m, how far the computed line passes from the true one at its start, across it
    angle    rad, between the two directions

At a surface met at distance t under the cosine c = N·V, with curvature κ,

    lateral' = lateral + t angle
    point    = (lateral' + ω S) / c            ω S: rounding of the crossing itself, S the size of the numbers involved
    normal   = κ point + ω

and onward, mirrored: angle + 2 normal, lateral' + ω S / c; refracted with the relative index η to the cosine q:
A angle + (1 + A) normal + ω/q with A = η max(1, c/q), since a turn in the plane of incidence is magnified by η c/q and one
across it by η; and lateral' max(1, q/c) + ω S / c. All first order, ω = 2^-96, which is more than what a hundred operations of
2^-104 each amount to; `stretch`, the condition of an object's placement, multiplies it.

Decisions (which object, lit or not, totally reflected or not) are taken on these numbers; a film position whose decision their
error could turn lies within that error of an edge, and is outside of what a bound of rounding says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilux_oracle.doubledouble import Array, Index
from equilux_oracle.highlight import sensitivity
from equilux_oracle.lights import Arriving
from equilux_oracle.local_formula import Surface

GEOMETRY = 2.0**-96
_WHOLE_TURN = 7.0


@dataclass(frozen=True)
class RayError:
    """Bounds on n rays: lateral in metres, angle in radians."""

    lateral: Array
    angle: Array

    @classmethod
    def of_camera(cls, coordinates: Array) -> RayError:
        return cls(GEOMETRY * coordinates, np.full(len(coordinates), GEOMETRY))

    def __getitem__(self, index: Index) -> RayError:
        return RayError(self.lateral[index], self.angle[index])


@dataclass(frozen=True)
class SurfaceError:
    """Bounds where n rays meet surfaces: lateral as of the ray, point in metres, normal and viewer in radians."""

    lateral: Array
    rounding: Array
    point: Array
    normal: Array
    viewer: Array

    def mirrored(self) -> RayError:
        return RayError(self.lateral + self.rounding, _capped(self.viewer + 2.0 * self.normal + GEOMETRY))

    def refracted(self, facing: Array, eta: Array, cosine: Array) -> RayError:
        """facing: N·V; eta: n_front / n_behind; cosine: of the refracted ray with −N."""
        with np.errstate(divide="ignore"):
            bent = bending(eta, facing, cosine)
            angle = bent * self.viewer + (1.0 + bent) * self.normal + GEOMETRY / cosine
            return RayError(self.lateral * np.maximum(1.0, cosine / facing) + self.rounding, _capped(angle))


def at_surface(error: RayError, t: Array, facing: Array, size: Array, curvature: Array, stretch: Array) -> SurfaceError:
    """n rays that have run t metres; facing: N·V; size: S in metres."""
    lateral = error.lateral + t * error.angle
    facing = np.maximum(facing, GEOMETRY)
    rounding = GEOMETRY * stretch * size / facing
    point = lateral / facing + rounding
    return SurfaceError(lateral, rounding, point, _capped(curvature * point + GEOMETRY * stretch), error.angle)


def bending(eta: Array, facing: Array, cosine: Array) -> Array:
    """How much refraction from the cosine c to q magnifies a turn of the ray, at most: A = η max(1, c/q)."""
    with np.errstate(divide="ignore"):
        result: Array = eta * np.maximum(1.0, facing / cosine)
    return result


def felt(here: Surface, light: Arriving, lit: Index, power: Array, off: SurfaceError, magnified: Array | float) -> Array:
    """What the errors of point, normal and viewer do to one light's diffuse term and highlight at the points `lit`, (3, k).

    magnified: A of the refracted light's direction, 1 of the mirrored one's. Below p = 1 the slope of c^p is taken at c/2;
    where the power is 0 there is no highlight to be off.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.sqrt(np.sum(light.to_light.hi[:, lit] ** 2, axis=0))
        to_light = np.where(np.isinf(distance), 0.0, off.point[lit] / distance)
    p = here.exponent[lit]
    soft = (p > 0.0) & (p < 1.0) & (power > 0.0)
    cosine = np.where(soft, power, 1.0) ** (1.0 / np.where(soft, p, 1.0))
    slope = np.where(soft, p * (np.maximum(cosine, 1e-300) / 2.0) ** (p - 1.0), sensitivity(p))
    strength = (2.0 + light.feels[lit]) * to_light
    turned = magnified * to_light + (1.0 + magnified) * off.normal[lit] + off.viewer[lit]
    of_diffuse = here.diffuse[:, lit] * (strength + off.normal[lit] + to_light)
    return light.value[:, lit] * (of_diffuse + here.specular[:, lit] * (strength + slope * turned))


def _capped(angle: Array) -> Array:
    """An angle that says nothing any more stays finite."""
    return np.minimum(angle, _WHOLE_TURN)
