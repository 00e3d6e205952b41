"""One film position of model `reflection-equation` by brute integration over the emitters, at many digits.

Written apart from the rest of this package: no borders, no Stokes, no closed form. A region of directions is integrated over
its own surface in two dimensions: a disc or rectangle as it stands, dω = cos θ' dA/r²; a sphere as the disc that its cap is
seen as, tan α across at distance 1; a hemisphere by polar angles. Within a flat region the horizons N·ω = 0 and M·ω = 0 are
straight lines, so both integrations are split exactly where the integrand has kinks, and Gauss–Legendre converges geometrically
on each piece. What it takes from elsewhere is `equilux_oracle.precise`: the camera, the nearest crossing, light without
an extent, and the arithmetic of vectors.

Valid where nothing is blocked but by horizons, which is where the closed forms are. No environment behind other bodies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import astuple, dataclass
from functools import cache, partial
from itertools import pairwise

from mpmath import mp, mpf

from equilux_oracle.emitters.covers import with_emitters
from equilux_oracle.precise import Vector, cross, dot, evaluate_at, exact, minus, plus, times, unit
from equilux_scenes.case import Case
from equilux_scenes.model import AreaEmitter, DiscEmitter, Material, RectangleEmitter, SphereEmitter

DIGITS = 25
NODES = 24


@dataclass(frozen=True)
class Receiver:
    """A lit point: unit N on the viewer's side, unit V, and p of the highlight."""

    point: Vector
    normal: Vector
    to_viewer: Vector
    exponent: mpf

    @property
    def mirror(self) -> Vector:
        """V mirrored at N."""
        return minus(times(2 * dot(self.normal, self.to_viewer), self.normal), self.to_viewer)


@dataclass(frozen=True)
class Received:
    """∫ N·ω dω, ∫ (R·V)^p dω and ∫ (R·V)^p N·ω dω over a region, where N·ω > 0, the highlights where R·V > 0."""

    irradiance: mpf
    lobe: mpf
    lobe_with_cosine: mpf


def radiance_at(case: Case, x: float, y: float) -> tuple[mpf, mpf, mpf] | None:
    """Radiance of each band at a film position in pixels, of a scene with emitters or an environment alone; None where no
    object is seen.

    Whatever blocks is not asked for: an environment is not behind other bodies, and there are no lights without an extent.
    """
    scene = case.scene
    objects = with_emitters(scene)
    names = {"": Material()} if scene.area_emitters else {}
    stripped = objects.model_copy(update={"model": "phong", "lights": {}, "materials": {**scene.materials, **names}})
    seen = evaluate_at(Case(case.name, stripped, case.name), x, y).seen
    if seen is None or seen.index >= len(scene.objects):
        return None
    material = scene.materials[scene.objects[seen.index].material]
    at = Receiver(seen.point, seen.normal, seen.to_viewer, mpf(material.exponent))
    received = [
        (emitter.radiance, converged(partial(from_emitter, emitter, at), material.exponent))
        for emitter in scene.area_emitters.values()
    ]
    if scene.environment is not None:
        received.append((scene.environment.radiance, converged(partial(from_hemisphere, at), material.exponent)))
    with mp.workdps(DIGITS):
        total = list(exact(material.emission))
        for radiance, part in received:
            lobe = {"lambert": mpf(0), "phong-classic": part.lobe, "phong-cosine": part.lobe_with_cosine}[material.brdf]
            for band in range(3):
                reflected = mpf(material.diffuse[band]) * part.irradiance + mpf(material.specular[band]) * lobe
                total[band] += mpf(radiance[band]) * reflected
        return total[0], total[1], total[2]


def from_emitter(emitter: AreaEmitter, at: Receiver, nodes: int = NODES, pieces: int = 1) -> Received:
    """What a point receives per radiance of an emitter that nothing blocks; nothing behind a one-sided one or inside a sphere.

    pieces: into how many parts every interval is cut besides, for sharp highlights.
    """
    with mp.workdps(DIGITS):
        flat = _flat(emitter, at.point)
        if flat is None:
            return Received(mpf(0), mpf(0), mpf(0))
        return _over(flat, at, nodes, pieces)


def converged(of: Callable[[int], Received], exponent: float) -> Received:
    """What a number of nodes → integrals gives when half as many nodes again change hardly anything.

    Where p is an integer convergence is geometric: what changes by 1e-12 is then off by its power 3/2, 1e-18. Where it is not,
    it is algebraic of an order above 13, and half as many nodes again reduce the error two hundred times. Raises
    ArithmeticError if it never does.
    """
    apart = 1e-14 if exponent != int(exponent) else 1e-12
    nodes = 16
    rough = of(nodes)
    while nodes < 150:
        nodes = nodes * 3 // 2
        fine = of(nodes)
        if all(abs(a - b) <= apart for a, b in zip(astuple(rough), astuple(fine), strict=True)):
            return fine
        rough = fine
    raise ArithmeticError(f"not converged with {nodes} nodes: {rough}")


def from_hemisphere(at: Receiver, nodes: int = NODES, pieces: int = 1) -> Received:
    """What a point receives per radiance of an environment, in polar angles about N."""
    with mp.workdps(DIGITS):
        x = unit(minus(at.mirror, times(dot(at.mirror, at.normal), at.normal)))
        y = cross(at.normal, x)
        graded = _is_rough(at.exponent)

        def across(phi: mpf) -> list[mpf]:
            # M·ω = 0 at tan θ = −(M·N)/(M·x cos φ)
            side = dot(at.mirror, x) * mp.cos(phi)
            border = [mp.atan2(dot(at.mirror, at.normal), -side)] if side < 0 else []
            return _gauss_sum(lambda theta: integrand(phi, theta), [mpf(0), *border, mp.pi / 2], nodes, pieces, graded)

        def integrand(phi: mpf, theta: mpf) -> list[mpf]:
            s = mp.sin(theta)
            omega = plus(times(s, plus(times(mp.cos(phi), x), times(mp.sin(phi), y))), times(mp.cos(theta), at.normal))
            return _weights(dot(at.normal, omega), dot(at.mirror, omega), mpf(1), at.exponent, s)

        quarter = mp.pi / 2
        return Received(*_gauss_sum(across, [-2 * quarter, -quarter, mpf(0), quarter, 2 * quarter], nodes, pieces, graded))


@dataclass(frozen=True)
class _Flat:
    """A flat region seen from a point: p = centre + x e + y f, x and y in the square or unit disc; e, f orthogonal."""

    center: Vector
    e: Vector
    f: Vector
    round: bool

    def x_of(self, s: mpf) -> tuple[mpf, mpf, mpf]:
        """x, dx/ds and the greatest |y| at s in [−1, 1]."""
        if self.round:
            angle = s * mp.pi / 2
            return mp.sin(angle), mp.pi / 2 * mp.cos(angle), mp.cos(angle)
        return s, mpf(1), mpf(1)

    def s_of(self, x: mpf) -> mpf:
        return 2 * mp.asin(x) / mp.pi if self.round else x


def _flat(emitter: AreaEmitter, point: Vector) -> _Flat | None:
    """An emitter's silhouette relative to a point; None if it does not shine there."""
    match emitter:
        case SphereEmitter():
            towards = minus(exact(emitter.center), point)
            d2, r2 = dot(towards, towards), mpf(emitter.radius) ** 2
            if d2 <= r2:
                return None
            axis = unit(towards)
            e = _some_across(axis)
            tangent = mp.sqrt(r2 / (d2 - r2))
            return _Flat(axis, times(tangent, e), times(tangent, cross(axis, e)), True)
        case DiscEmitter():
            towards, normal = minus(exact(emitter.center), point), unit(exact(emitter.normal))
            e = times(mpf(emitter.radius), _some_across(normal))
            return _Flat(towards, e, cross(normal, e), True) if dot(towards, normal) < 0 else None
        case RectangleEmitter():
            u, v = times(mpf(0.5), exact(emitter.edge_u)), times(mpf(0.5), exact(emitter.edge_v))
            towards = minus(plus(exact(emitter.corner), plus(u, v)), point)
            return _Flat(towards, u, v, False) if dot(towards, cross(u, v)) < 0 else None


def _over(flat: _Flat, at: Receiver, nodes: int, pieces: int) -> Received:
    """Each horizon is a line l0 + le x + lf y = 0 in the region's own coordinates; dω = |p·(e × f)| dx dy/|p|³."""
    lines = [tuple(dot(axis, v) for v in (flat.center, flat.e, flat.f)) for axis in (at.normal, at.mirror)]
    height = abs(dot(flat.center, cross(flat.e, flat.f)))
    graded = _is_rough(at.exponent)

    def across(s: mpf) -> list[mpf]:
        x, dx, top = flat.x_of(s)
        p = plus(flat.center, times(x, flat.e))
        q0, q1, q2 = dot(p, p), 2 * dot(p, flat.f), dot(flat.f, flat.f)
        (n0, n1), (m0, m1) = ((l0 + le * x, lf) for l0, le, lf in lines)
        borders = [-l0 / l1 for l0, l1 in ((n0, n1), (m0, m1)) if l1 != 0]
        cuts = [-top, *sorted(y for y in borders if -top < y < top), top]

        def integrand(y: mpf) -> list[mpf]:
            q = q0 + y * (q1 + y * q2)
            return _weights(n0 + n1 * y, m0 + m1 * y, mp.sqrt(q), at.exponent, height / q)

        return [dx * value for value in _gauss_sum(integrand, cuts, nodes, pieces, graded)]

    cuts = [mpf(-1), *sorted(flat.s_of(x) for x in _kinks(flat, lines) if -1 < x < 1), mpf(1)]
    return Received(*_gauss_sum(across, cuts, nodes, pieces, graded))


def _kinks(flat: _Flat, lines: list[tuple[mpf, ...]]) -> Iterable[mpf]:
    """Where a line meets the outline, or another line: there the pieces of the inner integral change."""
    for l0, le, lf in lines:
        if flat.round:
            # l0 + le x + lf y = 0 with x² + y² = 1
            square = le**2 + lf**2
            root = square - l0**2
            if square > 0 and root >= 0:
                for sign in (-1, 1):
                    yield (-l0 * le + sign * lf * mp.sqrt(root)) / square
        elif le != 0:
            yield from (-(l0 + lf * y) / le for y in (-1, 1))
    (a0, ae, af), (b0, be, bf) = lines
    determinant = ae * bf - af * be
    if determinant != 0:
        yield (af * b0 - a0 * bf) / determinant


def _weights(n: mpf, m: mpf, length: mpf, exponent: mpf, measure: mpf) -> list[mpf]:
    """The three integrands for N·p and M·p of a direction p of some length; dω = measure / length."""
    if n <= 0:
        return [mpf(0)] * 3
    cosine, per = n / length, measure / length
    power = mp.power(m / length, exponent) if m > 0 else mpf(0)
    return [per * cosine, per * power, per * power * cosine]


def _gauss_sum(of: Callable[[mpf], list[mpf]], cuts: list[mpf], nodes: int, pieces: int, graded: bool) -> list[mpf]:
    """Gauss–Legendre on every piece between cuts, graded towards its ends where a power that is no integer begins there."""
    total = [mpf(0)] * 3
    for low, high in pairwise(cuts):
        if high - low < mpf(10) ** (3 - DIGITS):
            continue
        step = (high - low) / pieces
        for k in range(pieces):
            for share, weight in _graded_rule(nodes) if graded else _rule(nodes):
                values = of(low + step * (k + share))
                total = [t + step * weight * value for t, value in zip(total, values, strict=True)]
    return total


def _is_rough(exponent: mpf) -> bool:
    """Whether u^p is too rough at u = 0 for Gauss–Legendre alone, whose error there falls by the order 2p + 2."""
    return bool(exponent != int(exponent) and exponent < 6)


@cache
def _rule(nodes: int) -> tuple[tuple[mpf, mpf], ...]:
    """Nodes and weights on [0, 1], by Newton's method on Legendre's polynomial."""
    with mp.workdps(DIGITS + 10):
        rule = []
        for k in range(nodes):
            x = mp.cos(mp.pi * (k + mpf(0.75)) / (nodes + mpf(0.5)))
            for _ in range(8):
                p0, p1 = mpf(1), x
                for j in range(2, nodes + 1):
                    p0, p1 = p1, ((2 * j - 1) * x * p1 - (j - 1) * p0) / j
                slope = nodes * (x * p1 - p0) / (x * x - 1)
                x -= p1 / slope
            rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope**2)))
        return tuple(rule)


@cache
def _graded_rule(nodes: int) -> tuple[tuple[mpf, mpf], ...]:
    """The same after s → ∫ 2772 s⁵ (1 − s)⁵ ds, which makes s^(6p+5) of a power s^p at either end."""

    def mapped(s: mpf) -> mpf:
        return s**6 * (462 + s * (-1980 + s * (3465 + s * (-3080 + s * (1386 - 252 * s)))))

    with mp.workdps(DIGITS + 10):
        return tuple((mapped(s), w * 2772 * (s * (1 - s)) ** 5) for s, w in _rule(nodes))


def _some_across(axis: Vector) -> Vector:
    least = min(range(3), key=lambda k: abs(axis[k]))
    return unit(cross(axis, (mpf(least == 0), mpf(least == 1), mpf(least == 2))))
