"""The CIE's tables, from colour-science: loaded when a scene first needs one, and never typed by hand.

Importing colour-science takes half a second, and seconds more for its plots, which nobody here draws. So it is imported when a
spectrum, or an interval of wavelengths, is first looked at, and its plots when somebody asks for them.
"""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

_OBSERVER = "CIE 1931 2 Degree Standard Observer"


class SpectraMissing(ImportError):
    """colour-science is not installed."""

    def __init__(self) -> None:
        super().__init__("spectra need colour-science: pip install 'equilux[spectra]'")


@dataclass(frozen=True, eq=False)
class Sampled:
    """A function of the wavelength: wavelengths_nm (n,) ascending, values (n,) or (n, k); linear in between, 0 outside."""

    wavelengths_nm: Floats
    values: Floats


_PLOTS = "colour.plotting"


class _PlotsLater(ModuleType):
    """Stands for colour-science's plots, and with them Matplotlib, until something of them is used."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if sys.modules.get(_PLOTS) is self:
            del sys.modules[_PLOTS]
        return getattr(importlib.import_module(_PLOTS), name)


@cache
def _colorimetry() -> Any:
    if "colour" not in sys.modules:
        sys.modules.setdefault(_PLOTS, _PlotsLater(_PLOTS))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns of parts that it lacks without SciPy; none of them is used here
            return importlib.import_module("colour.colorimetry")
    except ImportError as failed:
        sys.modules.pop(_PLOTS, None)
        raise SpectraMissing from failed


@cache
def matching_functions() -> Sampled:
    """x̄, ȳ, z̄ of the CIE 1931 2° observer, 360 to 830 nm by 1 nm; ȳ is V(λ). Raises SpectraMissing."""
    return _sampled(_colorimetry().MSDS_CMFS[_OBSERVER])


@cache
def illuminant(name: str) -> Sampled:
    """A relative spectral power distribution, as published. Raises SpectraMissing, and KeyError for a name that there is not."""
    known = _colorimetry().SDS_ILLUMINANTS
    if name not in set(known):  # its own look-up is lenient: d65, FL 1
        raise KeyError(name)
    return _sampled(known[name])


def illuminant_names() -> Iterable[str]:
    """The names that `illuminant` knows. Raises SpectraMissing."""
    return sorted(_colorimetry().SDS_ILLUMINANTS)


def _sampled(table: Any) -> Sampled:
    return Sampled(np.array(table.wavelengths, dtype=np.float64), np.array(table.values, dtype=np.float64))
