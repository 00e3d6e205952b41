"""From a renderer's budget to the uncertainty of its render: numbers and per-pixel maps that the comparison kernel can add up.

Two renders agree where |L_a − L_b| ≤ B, B = Σ bounds of both + k √(σ_a² + σ_b²).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

import mpmath
import numpy as np
import numpy.typing as npt

from equilux.budget import Bound, Budget, Geometric, Sampled, Term
from equilux.planes import read_planes, write_planes

FloatArray = npt.NDArray[np.floating]
Map = npt.NDArray[np.float32]

MINIMUM_REPEATS = 32
"""Below this many repeats a standard deviation is too uncertain to judge by: the pair is `not-comparable`."""

FALSE_ALARM_RATE = 1e-6
"""Family-wise: the chance that sampling noise alone makes any pixel of a pair diverge."""

STORAGE_TERM = "storage"
"""Name of the term for rounding to float32; stated once, here, for every float32 image whose adapter has not stated it itself."""


class Sensitive(Protocol):
    """What is asked of the tracer: how far radiance may move when normals and positions do (comparison.md, *geometric*)."""

    def sensitivity(self, normal: Any, position_m: Any) -> npt.NDArray[np.float64]:
        """(h, w, 3), for δN and δP given as one number or one per object."""
        ...


@dataclass(frozen=True)
class Uncertainty:
    """What one render claims to know: |error| ≤ abs + rel |L| + per_pixel, and a standard deviation on top where it was sampled.

    per_pixel, sigma: (h, w, 3) float32, rounded up from double, so that what is saved and what is used are the same; or None.
    sigma is the standard deviation of the mean, already pooled over 3×3 pixels. degrees_of_freedom belongs to sigma. film_px:
    how far, in pixels, a discontinuity may be displaced. terms: the budget, as JSON. obstacle: why no pair with this render
    can be compared, or None.
    """

    abs: float = 0.0
    rel: float = 0.0
    per_pixel: Map | None = None
    sigma: Map | None = None
    degrees_of_freedom: int | None = None
    film_px: float = 0.0
    terms: list[dict[str, Any]] = field(default_factory=list)
    obstacle: str | None = None

    def bound(self, radiance: FloatArray, pixels: npt.NDArray[np.intp] | None = None) -> npt.NDArray[np.float64]:
        """The hard part of B for these radiances (…, 3): abs + rel |L| + per_pixel; `pixels`: row-major indices, one per
        radiance triple.
        """
        total = self.abs + self.rel * np.abs(np.asarray(radiance, np.float64))
        if self.per_pixel is not None:
            total = total + (self.per_pixel if pixels is None else self.per_pixel.reshape(-1, 3)[pixels])
        return np.asarray(total)

    def to_json(self) -> dict[str, Any]:
        """Everything but the maps, as render.json holds it; the maps go beside it by `save_maps`."""
        return {
            "abs": self.abs,
            "rel": self.rel,
            "per_pixel": _summary(self.per_pixel),
            "sigma": _summary(self.sigma),
            "degrees_of_freedom": self.degrees_of_freedom,
            "film_px": self.film_px,
            "terms": self.terms,
            "obstacle": self.obstacle,
        }

    def save_maps(self, path: Path) -> bool:
        """Write `uncertainty.exr`: R G B the per-pixel bound, sigma.R … the standard deviation. False, and no file, where
        neither varies.
        """
        planes: dict[str, npt.NDArray[Any]] = {}
        for prefix, image in (("", self.per_pixel), ("sigma.", self.sigma)):
            if image is not None:
                planes |= {prefix + band: image[..., i] for i, band in enumerate("RGB")}
        if not planes:
            path.unlink(missing_ok=True)
            return False
        write_planes(path, planes)
        return True

    @classmethod
    def from_json(cls, data: Mapping[str, Any], maps: Path | None = None) -> Uncertainty:
        """Inverse of `to_json` and `save_maps`. `maps` may be a path that does not exist where nothing varies per pixel.

        Raises OSError where the summary says that there are maps and they cannot be read.
        """
        loaded: dict[str, Map] = {}
        wanted = [name for name in ("per_pixel", "sigma") if data.get(name) is not None]
        if wanted:
            if maps is None:
                raise OSError("the uncertainty varies per pixel, and no file of maps was given")
            planes = read_planes(maps)
            for name, prefix in (("per_pixel", ""), ("sigma", "sigma.")):
                if name in wanted:
                    loaded[name] = np.stack([planes[prefix + band] for band in "RGB"], axis=-1)
        return cls(
            abs=data["abs"], rel=data["rel"], film_px=data["film_px"], terms=list(data["terms"]), obstacle=data.get("obstacle"),
            degrees_of_freedom=data.get("degrees_of_freedom"), **loaded,
        )


def stated(budget: Budget, image: FloatArray, tracer: Sensitive | None = None) -> Uncertainty:
    """The uncertainty of one render, from its budget.

    image: (h, w, 3). Bounds add. Geometric terms add first, object by object, and are then propagated through the tracer once
    with full-size steps, so that what they do together is covered too. Sampled terms are independent of one another:
    variances add. A float32 image adds the bound of its storage, 2^-24 |L| (and 2^-150 below the smallest normal number),
    unless the budget holds a term named "storage".

    Raises ValueError where a term is negative, not finite, or has another size than the image.
    """
    if image.ndim != 3 or image.shape[2] != 3:
        raise ValueError(f"image: shape {image.shape}, allowed (height, width, 3)")
    terms = (*budget.terms, *_storage(budget, image))
    for term in terms:
        _check(term, image.shape)
    bounds = [term for term in terms if isinstance(term, Bound)]
    maps = [np.asarray(term.abs, np.float64) for term in bounds if np.ndim(term.abs) > 0]
    propagated, obstacle = _propagate([term for term in terms if isinstance(term, Geometric)], image.shape, tracer)
    if propagated is not None:
        maps.append(propagated)
    sampled = [term for term in terms if isinstance(term, Sampled)]
    return Uncertainty(
        abs=math.fsum(float(term.abs) for term in bounds if np.ndim(term.abs) == 0),
        rel=math.fsum(term.rel for term in bounds),
        per_pixel=_rounded_up(sum(maps[1:], maps[0])) if maps else None,
        sigma=_pooled_sigma(sampled),
        degrees_of_freedom=min((term.repeats - 1 for term in sampled), default=None),
        film_px=budget.film_px,
        terms=[_term_json(term) for term in terms],
        obstacle=obstacle or _too_few_repeats(sampled),
    )


def _storage(budget: Budget, image: FloatArray) -> tuple[Bound, ...]:
    if image.dtype != np.float32 or any(term.name == STORAGE_TERM for term in budget.terms):
        return ()
    return (Bound(STORAGE_TERM, "half a unit in the last place of float32", abs=2.0**-150, rel=2.0**-24),)


def _check(term: Term, shape: tuple[int, ...]) -> None:
    """Every number of a term must be finite and not negative; every map must have the image's shape."""
    values: dict[str, Any] = {
        name: getattr(term, name) for name in ("abs", "rel", "normal", "position_m", "film_px", "sigma") if hasattr(term, name)
    }
    for name, value in values.items():
        array = np.asarray(list(value.values()) if isinstance(value, Mapping) else value, np.float64)
        if not np.all(np.isfinite(array)) or np.any(array < 0):
            worst = array.flat[int(np.argmax(~(np.isfinite(array) & (array >= 0))))]
            raise ValueError(f"uncertainty term '{term.name}': {name} {worst}, allowed finite and ≥ 0")
        if name in ("abs", "sigma") and (array.ndim > 0 or name == "sigma") and array.shape != shape:
            raise ValueError(f"uncertainty term '{term.name}': {name} of shape {array.shape}, allowed {shape}")
    if isinstance(term, Sampled) and term.repeats < 1:
        raise ValueError(f"uncertainty term '{term.name}': {term.repeats} repeats, allowed ≥ 1")


def _propagate(
    terms: list[Geometric], shape: tuple[int, ...], tracer: Sensitive | None
) -> tuple[npt.NDArray[np.float64] | None, str | None]:
    """What the geometric terms may do to the radiance, (h, w, 3), or None where they do nothing; and why that cannot be said."""
    normal = _added([term.normal for term in terms])
    position = _added([term.position_m for term in terms])
    if np.max(normal) == 0 and np.max(position) == 0:
        return None, None
    names = ", ".join(term.name for term in terms)
    if tracer is None:
        return None, f"geometric uncertainty ({names}) cannot be propagated without the reference tracer"
    objects = _object_count(tracer)
    moved = np.asarray(tracer.sensitivity(_per_object(normal, objects), _per_object(position, objects)), np.float64)
    if moved.shape != shape:
        return None, f"the render is {shape[1]}×{shape[0]} pixels, the scene's film is {moved.shape[1]}×{moved.shape[0]}"
    if not np.all(np.isfinite(moved)):
        raise ValueError(f"uncertainty terms {names}: the propagated radiance is not finite")
    return moved, None


def _added(parts: list[float | Mapping[int, float]]) -> npt.NDArray[np.float64]:
    """Terms added object by object: entry −1 is what all objects share, entry i ≥ 0 what object i has beyond it."""
    highest = max((max(part, default=-1) for part in parts if isinstance(part, Mapping)), default=-1)
    total = np.zeros(highest + 2)
    for part in parts:
        if isinstance(part, Mapping):
            for index, value in part.items():
                total[index] += value
        else:
            total[-1] += part
    return total


def _per_object(added: npt.NDArray[np.float64], objects: int | None) -> float | npt.NDArray[np.float64]:
    """One number where no object has its own, else one per object of the scene."""
    own = added[:-1]
    if not own.any():
        return float(added[-1])
    if objects is None or len(own) > objects:
        known = "an unknown number of" if objects is None else objects
        raise ValueError(f"an uncertainty term names object {len(own) - 1}, the scene has {known} objects")
    out = np.full(objects, added[-1])
    out[: len(own)] += own
    return out


def _object_count(tracer: Sensitive) -> int | None:
    case = getattr(tracer, "case", None)
    return None if case is None else len(case.scene.objects)


def _pooled_sigma(terms: list[Sampled]) -> Map | None:
    """√Σσ² of the independent terms, each first replaced by its maximum over the 3×3 neighbourhood.

    A pixel whose repeats happened to agree would otherwise claim to be exact.
    """
    if not terms:
        return None
    variance = sum(_maximum_3x3(np.asarray(term.sigma, np.float64)) ** 2 for term in terms)
    return _rounded_up(np.sqrt(np.asarray(variance)))


def _maximum_3x3(image: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(0, 1)).max(axis=(-2, -1)))


def _too_few_repeats(terms: list[Sampled]) -> str | None:
    for term in terms:
        if term.repeats < MINIMUM_REPEATS:
            return f"sampled uncertainty '{term.name}' rests on {term.repeats} repeats, needed {MINIMUM_REPEATS}"
    return None


def _rounded_up(image: npt.NDArray[np.float64]) -> Map:
    """The smallest float32 that is not below. Raises ValueError where there is none."""
    with np.errstate(over="ignore"):
        nearest = image.astype(np.float32)
        up = np.where(nearest < image, np.nextafter(nearest, np.float32(np.inf)), nearest)
    if not np.all(np.isfinite(up)):
        raise ValueError(f"uncertainty: {float(np.max(image))} W/(m²·sr), allowed at most {float(np.finfo(np.float32).max)}")
    return np.ascontiguousarray(up)


def _summary(image: Map | None) -> dict[str, float] | None:
    return None if image is None else {"max": float(image.max()), "median": float(np.median(image))}


def _term_json(term: Term) -> dict[str, Any]:
    """A term as JSON; a map is summarised by its maximum and median."""
    out: dict[str, Any] = {"name": term.name, "kind": term.kind, "reason": term.reason}
    if isinstance(term, Bound):
        return out | {"abs": _number(term.abs), "rel": float(term.rel)}
    if isinstance(term, Geometric):
        return out | {"normal": _number(term.normal), "position_m": _number(term.position_m), "film_px": float(term.film_px)}
    return out | {"sigma": _number(term.sigma), "repeats": term.repeats}


def _number(value: float | Mapping[int, float] | FloatArray) -> Any:
    if isinstance(value, Mapping):
        return {str(index): float(part) for index, part in value.items()}
    if np.ndim(value) > 0:
        return _summary(np.asarray(value, np.float32))
    return float(np.asarray(value))


# --- coverage factor --------------------------------------------------------------------------------------------------


def coverage_factor(a: Uncertainty, b: Uncertainty, tests: int) -> float:
    """k such that sampling noise alone makes one or more of `tests` bands diverge with probability ≤ 1e-6; 0 where nothing
    was sampled.

    Under H₀ (the renders agree), D = (L_a − L_b)/√(s_a² + s_b²) follows Student's t: exactly when one side is sampled, with ν
    = repeats − 1, and with the Welch–Satterthwaite ν ≥ min(ν_a, ν_b) when both are; quantiles fall with ν, so the smaller one
    is safe. Two-sided, and by Boole's inequality (Bonferroni, which needs no independence of the pixels; Šidák's factor
    differs from it by less than 1e-6 relative at this level): k = t_ν(1 − α/(2 · tests)), α = 1e-6. Pooling σ by its maximum
    over 3×3 pixels only makes D smaller.
    """
    degrees = [side.degrees_of_freedom for side in (a, b) if side.sigma is not None and side.degrees_of_freedom is not None]
    if not degrees:
        return 0.0
    return student_quantile(FALSE_ALARM_RATE / (2 * tests), min(degrees))


@lru_cache(maxsize=256)
def student_quantile(upper_tail: float, degrees_of_freedom: int) -> float:
    """t with P(T > t) = upper_tail, 0 < upper_tail ≤ 1/2, for Student's distribution.

    P(T > t) = I_x(ν/2, 1/2)/2 with x = ν/(ν + t²) (Abramowitz & Stegun 26.7.1, 26.5.27), I the regularised incomplete beta
    function, evaluated in 40 digits and inverted by bisection of log t to double precision. Raises ValueError outside the
    domain.
    """
    if not 0 < upper_tail <= 0.5 or degrees_of_freedom < 1:
        raise ValueError(f"Student's quantile: tail {upper_tail}, ν {degrees_of_freedom}, allowed tail in (0, 0.5] and ν ≥ 1")
    if upper_tail == 0.5:
        return 0.0
    with mpmath.workdps(40):
        nu, twice = mpmath.mpf(degrees_of_freedom), 2 * mpmath.mpf(upper_tail)

        def is_below(log_t: Any) -> bool:
            x = nu / (nu + mpmath.exp(2 * log_t))
            return bool(mpmath.betainc(nu / 2, 0.5, 0, x, regularized=True) > twice)

        low, high = mpmath.mpf(-45), mpmath.mpf(1)
        while is_below(high):
            high *= 2
        while high - low > mpmath.mpf(2) ** -56:
            middle = (low + high) / 2
            low, high = (middle, high) if is_below(middle) else (low, middle)
        return float(mpmath.exp(high))
