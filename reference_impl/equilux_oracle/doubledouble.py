"""Arithmetic with 106 bits in NumPy: each number is the unevaluated sum of two doubles.

Why: where a camera looks at a small object from afar, or from 1e6 units off the origin, one rounding of a hit point in double
already moves the normal by more than a highlight of exponent 1000 forgives. So all geometry is done in double-double, whose
unit roundoff is about 2^-104, and is rounded to double once, at the end. NumPy's long double is no way out: it is 80 bits on
x86 and 64 on many ARMs.

The error-free transformations are Knuth's two-sum and Dekker's two-product with Veltkamp's splitting (T. J. Dekker, "A
floating-point technique for extending the available precision", Numer. Math. 18, 1971); sum, quotient and root follow Hida, Li
and Bailey, "Library for double-double and quad-double arithmetic", 2007. They need round-to-nearest and uncontracted
operations, which separate NumPy calls are.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Index: TypeAlias = Any
"""Whatever NumPy accepts between brackets."""

_SPLITTER = 134217729.0  # 2^27 + 1


def _two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b = s + e exactly."""
    s = a + b
    v = s - a
    return s, (a - (s - v)) + (b - v)


def _quick_two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b = s + e exactly, where |a| ≥ |b|."""
    s = a + b
    return s, b - (s - a)


def _split(a: Array) -> tuple[Array, Array]:
    """a = h + l exactly, each of at most 26 bits."""
    t = _SPLITTER * a
    h = t - (t - a)
    return h, a - h


def _two_product(a: Array, b: Array) -> tuple[Array, Array]:
    """a b = p + e exactly (short of overflow and underflow)."""
    p = a * b
    ah, al = _split(a)
    bh, bl = _split(b)
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


class DD:
    """An array of double-double numbers: the value is `hi + lo`, with hi the double nearest to it.

    A vector is a DD of shape (3, n), or (3, 1) where it is the same for every ray; `dot`, `cross` and `norm` work along the
    first axis.
    """

    __slots__ = ("hi", "lo")
    __array_ufunc__ = None  # so that `array * DD` comes here and is not spread over the elements by NumPy

    def __init__(self, hi: npt.ArrayLike, lo: npt.ArrayLike | None = None) -> None:
        self.hi: Array = np.asarray(hi, dtype=np.float64)
        self.lo: Array = np.zeros_like(self.hi) if lo is None else np.asarray(lo, dtype=np.float64)

    def __getitem__(self, index: Index) -> DD:
        return DD(self.hi[index], self.lo[index])

    def __neg__(self) -> DD:
        return DD(-self.hi, -self.lo)

    def __add__(self, other: DD | Array | float) -> DD:
        b = as_dd(other)
        s, e = _two_sum(self.hi, b.hi)
        t, f = _two_sum(self.lo, b.lo)
        s, e = _quick_two_sum(s, e + t)
        return DD(*_quick_two_sum(s, e + f))

    def __sub__(self, other: DD | Array | float) -> DD:
        return self + (-as_dd(other))

    def __mul__(self, other: DD | Array | float) -> DD:
        b = as_dd(other)
        p, e = _two_product(self.hi, b.hi)
        return DD(*_quick_two_sum(p, e + (self.hi * b.lo + self.lo * b.hi)))

    def __truediv__(self, other: DD | Array | float) -> DD:
        b = as_dd(other)
        q1 = self.hi / b.hi
        r = self - b * q1
        q2 = r.hi / b.hi
        q3 = (r - b * q2).hi / b.hi
        s, e = _quick_two_sum(q1, q2)
        return DD(s, e) + q3

    __radd__ = __add__
    __rmul__ = __mul__

    def __rsub__(self, other: Array | float) -> DD:
        return as_dd(other) - self

    def sqrt(self) -> DD:
        """The root by one Newton step from the double root; 0 where the value is not positive."""
        root = np.sqrt(np.maximum(self.hi, 0.0))
        safe = np.where(root > 0.0, root, 1.0)
        correction = (self - DD(*_two_product(root, root))).hi / (2.0 * safe)
        return DD(*_quick_two_sum(root, np.where(root > 0.0, correction, 0.0)))

    # The sign of a normalised double-double is the sign of its leading part.
    def __lt__(self, other: DD | Array | float) -> Bools:
        return (self - other).hi < 0.0

    def __le__(self, other: DD | Array | float) -> Bools:
        return (self - other).hi <= 0.0

    def __gt__(self, other: DD | Array | float) -> Bools:
        return (self - other).hi > 0.0

    def __ge__(self, other: DD | Array | float) -> Bools:
        return (self - other).hi >= 0.0


def as_dd(value: DD | npt.ArrayLike) -> DD:
    """The value itself, or a double taken as exact."""
    return value if isinstance(value, DD) else DD(value)


def vector(components: npt.ArrayLike) -> DD:
    """Three exact doubles as a vector that is the same for every ray, (3, 1)."""
    return DD(np.asarray(components, dtype=np.float64).reshape(3, 1))


def direction(components: npt.ArrayLike) -> DD:
    """Three exact doubles of which only the direction counts, (3, 1): scaled by a power of two, so that 1e-300 and 1e300 do no
    harm."""
    exact = np.asarray(components, dtype=np.float64)
    return vector(np.ldexp(exact, -int(np.frexp(np.max(np.abs(exact)))[1])))


def where(condition: Bools, a: DD, b: DD) -> DD:
    return DD(np.where(condition, a.hi, b.hi), np.where(condition, a.lo, b.lo))


def stack(parts: list[DD]) -> DD:
    """Components (n,) → a vector (3, n)."""
    return DD(np.stack(np.broadcast_arrays(*(p.hi for p in parts))), np.stack(np.broadcast_arrays(*(p.lo for p in parts))))


def dot(a: DD, b: DD) -> DD:
    product = a * b
    return product[0] + product[1] + product[2]


def cross(a: DD, b: DD) -> DD:
    return stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def norm(a: DD) -> DD:
    return dot(a, a).sqrt()


def unit(a: DD) -> DD:
    return a / norm(a)
