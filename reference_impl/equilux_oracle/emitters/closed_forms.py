"""The textbook closed forms of uniform emitters, one function each, in plain double.

For tests, documentation and anybody's check of a renderer. A form factor F is the share of an emitter's light in a receiver's
irradiance E = π L F; ∫ N·ω dω over what is seen is π F. Factors are numbered as in J. R. Howell, "A Catalog of Radiation Heat
Transfer Configuration Factors" (B: from an element to a surface, C: between surfaces).
"""

from __future__ import annotations

import math

# --- solid angles, sr -------------------------------------------------------------------------------------------------


def cap_solid_angle(half_angle: float) -> float:
    """Of a cone or cap of half-angle α, radians: 2π (1 − cos α) = 4π sin²(α/2)."""
    return 4 * math.pi * math.sin(half_angle / 2) ** 2


def sphere_solid_angle(radius: float, distance: float) -> float:
    """Of a sphere whose centre is `distance` > radius away: that of the cap with sin α = r/d."""
    return cap_solid_angle(math.asin(radius / distance))


def rectangle_solid_angle(width: float, height: float, distance: float) -> float:
    """Of a rectangle seen from straight before its middle: 4 arcsin(w h/√((w² + 4d²)(h² + 4d²)))."""
    return 4 * math.asin(width * height / math.sqrt((width**2 + 4 * distance**2) * (height**2 + 4 * distance**2)))


# --- form factors, dimensionless --------------------------------------------------------------------------------------


def sphere_on_element(radius: float, distance: float, cosine: float) -> float:
    """A sphere on an element whose normal makes an angle of that cosine with the direction to its centre (Howell B-43).

    sin²α cosθ where the whole sphere is above the horizon. Where the horizon cuts it, with x = √(h² − 1), y = −x cot θ, h = d/r:
    F = [(cosθ arccos y − x sinθ √(1 − y²))/h² + arctan(sinθ √(1 − y²)/x)]/π. 0 where it is wholly below. At most 1.
    """
    h2 = (distance / radius) ** 2
    sine = math.sqrt(max(0.0, 1 - cosine**2))
    if cosine * cosine * h2 > 1:
        return max(0.0, cosine) / h2
    x = math.sqrt(h2 - 1)
    y = -x * cosine / sine
    rest = sine * math.sqrt(max(0.0, 1 - y * y))
    return ((cosine * math.acos(y) - x * rest) / h2 + math.atan2(rest, x)) / math.pi


def coaxial_disc_on_element(radius: float, distance: float) -> float:
    """A disc on an element on its axis that faces it (Howell B-10): r²/(r² + d²)."""
    return radius**2 / (radius**2 + distance**2)


def disc_on_parallel_element(radius: float, distance: float, offset: float) -> float:
    """A disc on an element parallel to it, `offset` away from its axis (Howell B-13).

    F = ½ [1 − (d² + a² − r²)/√((d² + a² + r²)² − 4 a² r²)].
    """
    d2, a2, r2 = distance**2, offset**2, radius**2
    return 0.5 * (1 - (d2 + a2 - r2) / math.sqrt((d2 + a2 + r2) ** 2 - 4 * a2 * r2))


def rectangle_on_parallel_element(width: float, height: float, distance: float) -> float:
    """A rectangle on an element parallel to it, straight before one of its corners (Howell B-3).

    With A = w/d, B = h/d: F = [A/√(1+A²) arctan(B/√(1+A²)) + B/√(1+B²) arctan(A/√(1+B²))]/(2π).
    """
    a, b = width / distance, height / distance
    s, t = math.hypot(1, a), math.hypot(1, b)
    return (a / s * math.atan(b / s) + b / t * math.atan(a / t)) / (2 * math.pi)


def rectangle_on_perpendicular_element(width: float, height: float, distance: float) -> float:
    """A rectangle on an element in a plane across it, straight before a corner; the element's horizon runs along `width` (B-4).

    F = [arctan(w/d) − d/√(h² + d²) arctan(w/√(h² + d²))]/(2π).
    """
    far = math.hypot(height, distance)
    return (math.atan(width / distance) - distance / far * math.atan(width / far)) / (2 * math.pi)


def disc_to_parallel_disc(radius: float, other_radius: float, distance: float) -> float:
    """From a disc to another on the same axis (Howell C-41): ½ [X − √(X² − 4 (R₂/R₁)²)], R = r/d, X = 1 + (1 + R₂²)/R₁².

    It is the mean over the first disc of the second one's factor on an element.
    """
    r1, r2 = radius / distance, other_radius / distance
    x = 1 + (1 + r2**2) / r1**2
    ratio = r2 / r1
    return 2 * ratio**2 / (x + math.sqrt(x**2 - 4 * ratio**2))


# --- lobes of Phong's highlight, sr -----------------------------------------------------------------------------------


def lobe_solid_angle(exponent: float) -> float:
    """∫ (R·V)^p dω over a hemisphere about the mirror direction: 2π/(p + 1)."""
    return 2 * math.pi / (exponent + 1)


def lobe_reflectance(exponent: float) -> float:
    """∫ (R·V)^p cosθ dω of light along the normal: 2π/(p + 2)."""
    return 2 * math.pi / (exponent + 2)


def lobe_in_cone(exponent: float, half_angle: float) -> float:
    """∫ (R·V)^p dω over a cone about the mirror direction: 2π (1 − cos^(p+1) α)/(p + 1)."""
    return -lobe_solid_angle(exponent) * math.expm1((exponent + 1) * math.log(math.cos(half_angle)))


# --- emitters as a whole ----------------------------------------------------------------------------------------------


def sphere_flux(radius: float, radiance: float) -> float:
    """Φ = π L · 4π r² of a uniform sphere, W."""
    return 4 * math.pi**2 * radius**2 * radiance


def sphere_intensity(radius: float, radiance: float) -> float:
    """I = π r² L of a uniform sphere seen from afar, W/sr; of a Lambertian receiver that sees all of it, from any distance."""
    return math.pi * radius**2 * radiance


def furnace(diffuse: float, radiance: float) -> float:
    """What a convex Lambertian body shows under uniform radiance: π K_diff L."""
    return math.pi * diffuse * radiance
