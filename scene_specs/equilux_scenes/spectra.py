"""Spectral densities and their integrals: over colour-matching functions, over intervals of wavelengths, and over all of them.

A table, an illuminant and the CIE's functions are linear between their samples and 0 outside. Integrals are taken cell by cell
between all samples of both factors, by four Gauss points each: exact to rounding for products of such functions (quadratic in a
cell), and for Planck's law, smooth over cells of 1 nm, too (relative 1e-12, shown by halving them). What is left is the tables'
own rounding, 1e-7 of the functions' peaks as published.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from equilux_scenes.model import Spectrum
from equilux_scenes.spectral_data import Floats, Sampled, illuminant, matching_functions

PLANCK = 6.62607015e-34
"""h, J s, exact by definition of the SI (2019)."""

LIGHT_SPEED = 299792458.0
"""c, m/s, exact by definition."""

BOLTZMANN = 1.380649e-23
"""k, J/K, exact by definition."""

STEFAN_BOLTZMANN = 2 * math.pi**5 * BOLTZMANN**4 / (15 * PLANCK**3 * LIGHT_SPEED**2)
"""σ, W/(m² K⁴)."""

_CELL = 0.002
"""Of the wavelength: the cells in which Planck's law is integrated, 1 nm at 500 nm."""

_GAUSS_POINTS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(4)


class Density(ABC):
    """A spectral density X_λ, per nm."""

    @abstractmethod
    def total(self) -> float:
        """∫ X_λ dλ over all wavelengths."""

    @abstractmethod
    def over(self, interval_nm: tuple[float, float]) -> float:
        """∫ X_λ dλ over an interval, ends included."""

    @abstractmethod
    def xyz(self) -> Floats:
        """∫ X_λ (x̄, ȳ, z̄) dλ, (3,) float64; the middle one times K_m is the luminous quantity."""


@dataclass(frozen=True, eq=False)
class Line(Density):
    """Everything at one wavelength, 1 in all."""

    wavelength_nm: float

    def total(self) -> float:
        return 1.0

    def over(self, interval_nm: tuple[float, float]) -> float:
        return 1.0 if interval_nm[0] <= self.wavelength_nm <= interval_nm[1] else 0.0

    def xyz(self) -> Floats:
        found: Floats = _values(matching_functions(), np.array([self.wavelength_nm]))[0]
        return found


class Spread(Density):
    """A density with values at wavelengths."""

    @abstractmethod
    def at(self, wavelengths_nm: Floats) -> Floats:
        """Values per nm."""

    @abstractmethod
    def knots_nm(self, low: float, high: float) -> Floats:
        """Wavelengths between the two, such that the density is smooth from each to the next."""

    def over(self, interval_nm: tuple[float, float]) -> float:
        low, high = interval_nm
        points, weights = _gauss(np.array([low, high, *self.knots_nm(low, high)]))
        return float(self.at(points) @ weights)

    def xyz(self) -> Floats:
        functions = matching_functions()
        low, high = functions.wavelengths_nm[[0, -1]]
        points, weights = _gauss(np.concatenate([functions.wavelengths_nm, self.knots_nm(low, high)]))
        product: Floats = (self.at(points) * weights) @ _values(functions, points)
        return product


@dataclass(frozen=True, eq=False)
class Table(Spread):
    """Linear between samples, 0 outside."""

    sampled: Sampled

    def at(self, wavelengths_nm: Floats) -> Floats:
        return _values(self.sampled, wavelengths_nm)

    def knots_nm(self, low: float, high: float) -> Floats:
        knots = self.sampled.wavelengths_nm
        return knots[(knots > low) & (knots < high)]

    def total(self) -> float:
        return float(np.trapezoid(self.sampled.values, self.sampled.wavelengths_nm))


@dataclass(frozen=True, eq=False)
class Blackbody(Spread):
    """Planck's law: B_λ = 2hc²/λ⁵ / (e^(hc/λkT) − 1), here in W/(m² sr nm); as in the CIE's own use, the index of air is 1."""

    temperature_k: float

    def at(self, wavelengths_nm: Floats) -> Floats:
        metres = wavelengths_nm * 1e-9
        with np.errstate(over="ignore"):  # e^∞: nothing is radiated there
            exponential = np.expm1(PLANCK * LIGHT_SPEED / (metres * BOLTZMANN * self.temperature_k))
        per_nm: Floats = 2e-9 * PLANCK * LIGHT_SPEED**2 / metres**5 / exponential
        return per_nm

    def knots_nm(self, low: float, high: float) -> Floats:
        return np.geomspace(low, high, math.ceil(math.log(high / low) / _CELL) + 1)

    def total(self) -> float:
        """σT⁴/π."""
        return STEFAN_BOLTZMANN * self.temperature_k**4 / math.pi


def density_of(spectrum: Spectrum) -> Density:
    """What a spec's `spectrum` means. Raises KeyError for an illuminant that there is not, SpectraMissing."""
    if spectrum.table is not None:
        samples = np.array(spectrum.table, dtype=np.float64)
        return Table(Sampled(samples[:, 0], samples[:, 1]))
    if spectrum.blackbody is not None:
        return Blackbody(spectrum.blackbody)
    if spectrum.illuminant is not None:
        return Table(illuminant(spectrum.illuminant))
    assert spectrum.line_nm is not None
    return Line(spectrum.line_nm)


def luminosity_over(interval_nm: tuple[float, float]) -> float:
    """∫ V(λ) dλ over an interval, nm. Raises SpectraMissing."""
    functions = matching_functions()
    return Table(Sampled(functions.wavelengths_nm, functions.values[:, 1])).over(interval_nm)


def _values(sampled: Sampled, wavelengths_nm: Floats) -> Floats:
    """(m,) or (m, k)."""
    columns = sampled.values.reshape(len(sampled.wavelengths_nm), -1)
    found = [np.interp(wavelengths_nm, sampled.wavelengths_nm, column, left=0.0, right=0.0) for column in columns.T]
    return np.stack(found, axis=1).reshape(len(wavelengths_nm), *sampled.values.shape[1:])


def _gauss(knots_nm: Floats) -> tuple[Floats, Floats]:
    """Points and weights that integrate between the knots, cell by cell."""
    knots = np.unique(knots_nm)
    half = np.diff(knots)[:, None] / 2
    middle = (knots[:-1] + knots[1:])[:, None] / 2
    return (middle + half * _GAUSS_POINTS).ravel(), (half * _GAUSS_WEIGHTS).ravel()
