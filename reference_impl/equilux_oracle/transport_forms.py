"""Ray-traced configurations whose radiance is a formula, at as many digits as mpmath is set to.

They trace nothing: what a picture must show is written down from the laws of reflection and refraction, and `transport.py` is
tested against it. Sources: the law of refraction and total reflection as in Born and Wolf, Principles of Optics, 7th ed., §1.5;
the plane-parallel plate and the sphere by elementary trigonometry from it (Hecht, Optics, 5th ed., §4.4 and §5.2); the radiance
of repeated bounces is a geometric series.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import mp, mpf

# --- mirrors ----------------------------------------------------------------------------------------------------------


def bounces(emission: mpf, k_refl: mpf, background: mpf, met: int, limit: int) -> mpf:
    """Radiance of a ray that meets `met` glowing mirrors before it leaves for the background.

    The first mirror is seen at weight 1, each further one is a bounce; a recursion limit n allows n bounces:

        K_emit (1 − k^m)/(1 − k) + k^m background     if m ≤ n
        K_emit (1 − k^(n+1))/(1 − k)                  else
    """
    seen = min(met, limit + 1)
    series = emission * seen if k_refl == 1 else emission * (1 - k_refl**seen) / (1 - k_refl)
    return series + (k_refl**met * background if met <= limit else mpf(0))


def truncation(emission: mpf, k_refl: mpf, limit: int) -> mpf:
    """What a recursion limit leaves out of the endless series between two mirrors, k_refl < 1: K_emit k^(n+1)/(1 − k)."""
    return emission * k_refl ** (limit + 1) / (1 - k_refl)


@dataclass(frozen=True)
class OffSphere:
    """A ray mirrored by a sphere in parallel view: where (x, y, z) from the centre, and its direction."""

    point: tuple[mpf, mpf, mpf]
    direction: tuple[mpf, mpf, mpf]


def off_sphere(x: mpf, y: mpf, radius: mpf) -> OffSphere | None:
    """The ray that travels along −z at (x, y) from the axis, after it has met the sphere; None where it passes.

    With the unit normal N = (x, y, √(r² − x² − y²))/r, R = (2 N_z N_x, 2 N_z N_y, 2 N_z² − 1).
    """
    rest = radius**2 - x**2 - y**2
    if rest < 0:
        return None
    n = (x / radius, y / radius, mp.sqrt(rest) / radius)
    return OffSphere((x, y, mp.sqrt(rest)), (2 * n[2] * n[0], 2 * n[2] * n[1], 2 * n[2] ** 2 - 1))


# --- refraction -------------------------------------------------------------------------------------------------------


def critical_angle(ior: mpf) -> mpf:
    """The angle inside a medium beyond which light is totally reflected, asin(1/n), in radians; n > 1."""
    return mp.asin(1 / ior)


def slab_shift(thickness: mpf, angle: mpf, ior: mpf) -> mpf:
    """How far a plane-parallel slab displaces what is seen through it, along its surface.

    d (tan θ − tan θ'), with sin θ = n sin θ'.
    """
    return thickness * (mp.tan(angle) - mp.tan(mp.asin(mp.sin(angle) / ior)))


def through_ball(height: mpf, radius: mpf, ior: mpf, screen: mpf) -> mpf | None:
    """Where a ray parallel to the axis of a ball, at `height` from it, meets a screen at the distance `screen` behind its centre.

    None where it is turned back by 90° or more.

    With sin θ = h/r, sin θ = n sin θ', it enters at the polar angle θ, crosses the angle π − 2θ' and leaves at the height
    r sin(2θ' − θ), at r cos(2θ' − θ) behind the centre, turned towards the axis by δ = 2 (θ − θ'):

        y = r sin(2θ' − θ) − (D − r cos(2θ' − θ)) tan δ

    For n < h/r it does not enter but is reflected, by 2θ outward: y = h − (D + r cos θ) tan 2θ, for θ > 45°.
    """
    angle = mp.asin(height / radius)
    if height > ior * radius:
        return height - (screen + radius * mp.cos(angle)) * mp.tan(2 * angle) if angle > mp.pi / 4 else None
    inner = mp.asin(height / (radius * ior))
    leaves, turned = 2 * inner - angle, 2 * (angle - inner)
    if abs(turned) >= mp.pi / 2:
        return None
    return radius * mp.sin(leaves) - (screen - radius * mp.cos(leaves)) * mp.tan(turned)


def ball_on_axis(emission: mpf, through: mpf, mirrored: mpf, background: mpf, limit: int) -> mpf:
    """Radiance along the axis of a glass ball in a uniform background, whatever its index: nothing is turned there.

    through = t k_trans, mirrored = (1 − t) k_refl at normal incidence. The ray that entered goes to and fro, and each time shows
    the surface and, through it, the background: with n ≥ 1 and X = K_emit, T = through, ρ = mirrored, B the background

        X + ρ B + T [ X (1 − ρ^n)/(1 − ρ) + T B (1 − ρ^(n−1))/(1 − ρ) ]
    """
    if limit == 0:
        return emission
    to_and_fro = emission * (1 - mirrored**limit) / (1 - mirrored)
    behind = through * background * (1 - mirrored ** (limit - 1)) / (1 - mirrored)
    return emission + mirrored * background + through * (to_and_fro + behind)


# --- what is seen there -----------------------------------------------------------------------------------------------


def lamp_on_wall(diffuse: mpf, intensity: mpf, distance: mpf, aside: mpf) -> mpf:
    """Radiance of a Lambertian wall under a lamp at `distance` before it, `aside` from the foot: K_diff I d/(d² + a²)^(3/2)."""
    return diffuse * intensity * distance / mp.power(distance**2 + aside**2, mpf(3) / 2)
