"""What must hold between the keys that say how strong a light is: one strength, and a spectrum that fits it."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from equilux_scenes.checking import Context, Problem, check
from equilux_scenes.errors import number_text
from equilux_scenes.kinds import kinds_of
from equilux_scenes.model import BandIntervals, Spectrum, Strength
from equilux_scenes.units import LUMINOUS, strengths
from equilux_scenes.yaml_tree import ListNode, MapNode, ScalarNode

SPECTRA = ("table", "blackbody", "illuminant", "line_nm")
"""The keys of which a spectrum has exactly one."""


_STRENGTHS = {kind: strengths(cls) for kind, cls in kinds_of(Strength).items()}


@check(Strength)
def _one_strength(light: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    kind = node.entries.get("kind")
    known = (*_STRENGTHS[str(kind.value)], "spectrum") if isinstance(kind, ScalarNode) else ()
    given = [key for key in node.entries if key in known]
    beside_spectrum = {"flux", "luminous_flux", *LUMINOUS.values()}
    first = None
    for key in given:
        if first is None or (key != "spectrum" and first == "spectrum" and key in beside_spectrum):
            first = key
        elif key == "spectrum" and first in beside_spectrum:
            continue
        else:
            yield Problem((key,), f"one strength, and {first} is given")
    spectrum = node.entries.get("spectrum")
    if isinstance(spectrum, MapNode) and "total" in spectrum.entries and first in beside_spectrum:
        yield Problem(("spectrum", "total"), f"one strength, and {first} is given")


@check(Strength)
def _flux_of_a_spectrum_is_one_number(light: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if "spectrum" in node.entries and isinstance(node.entries.get("flux"), ListNode):
        yield Problem(("flux",), "one number (the spectrum makes the bands)")


@check(Spectrum)
def _one_kind_of_spectrum(spectrum: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    if len(node.entries.keys() & set(SPECTRA)) != 1:
        yield Problem((), f"exactly one of {', '.join(SPECTRA)}")


@check(BandIntervals, needs=("intervals_nm",))
def _intervals_are_apart(bands: SimpleNamespace, node: MapNode, context: Context) -> Iterator[Problem]:
    intervals = bands.intervals_nm
    for index, (low, high) in enumerate(intervals):
        if low >= high:
            yield Problem(("intervals_nm", index, 1), f"a wavelength > {number_text(low)}, which the interval starts at")
        for other, (start, end) in enumerate(intervals[:index]):
            if low < end and start < high:
                yield Problem(("intervals_nm", index), f"an interval that does not overlap interval {other}")
