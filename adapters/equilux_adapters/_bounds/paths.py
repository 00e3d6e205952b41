"""How much radiance rays may bring, whatever they meet: bounds over the whole picture, W/(m²·sr).

Where rays go is not asked: each may meet the worst surface at every bounce. A surface shows at most `local` itself and adds at
most `onward` of what its secondary rays bring, so a ray with n bounces left brings at most C(n) = max over surfaces of
local + onward C(n − 1), or the background.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Protocol, TypeVar

BOUNDLESS = 1e30
"""W/(m²·sr): a bound beyond this says nothing, and this stands for it: weights above 1 multiply beyond all use."""


class Shows(Protocol):
    """A surface. local: the most that a hit shows of itself. onward: the most that it adds of what secondary rays bring."""

    @property
    def local(self) -> float: ...
    @property
    def onward(self) -> float: ...


S = TypeVar("S", bound=Shows)


@dataclass(frozen=True)
class Surface:
    """See `Shows`."""

    local: float
    onward: float


@dataclass(frozen=True)
class Paths(Generic[S]):
    """background: of rays that miss. bounces: how many the scene allows."""

    surfaces: Sequence[S]
    background: float
    bounces: int

    @property
    def onward(self) -> float:
        """The largest of all surfaces."""
        return max([surface.onward for surface in self.surfaces], default=0.0)

    @cached_property
    def _brings(self) -> list[float]:
        brings = [max([surface.local for surface in self.surfaces], default=0.0)]
        for _ in range(self.bounces):
            brings.append(min(max([s.local + s.onward * brings[-1] for s in self.surfaces], default=0.0), BOUNDLESS))
        return [min(max(most, self.background), BOUNDLESS) for most in brings]

    def brings(self, bounces: int) -> float:
        """C(n): the most that a ray brings which may bounce so often."""
        return self._brings[bounces]

    def beyond(self, depth: int) -> float:
        """What all that lies `depth` bounces deep or deeper adds to a picture at most."""
        if depth > self.bounces:
            return 0.0
        weight = 1.0
        for _ in range(depth):
            weight = min(weight * self.onward, BOUNDLESS)
        return min(weight * self.brings(self.bounces - depth), BOUNDLESS)


def gain(onward: float, bounces: int) -> float:
    """Σ_{j≤n} onwardʲ: what one error bound per hit may add up to at the eye."""
    total, power = 1.0, 1.0
    for _ in range(bounces):
        power = min(power * onward, BOUNDLESS)
        total += power
    return min(total, BOUNDLESS)
