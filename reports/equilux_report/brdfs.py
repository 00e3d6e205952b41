"""The BRDFs of a case's materials: plots and what the checks say, from `materials.json`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from equilux_report.brdfplots import Curve, polar_plot, reflectance_plot
from equilux_report.facts import Facts, mapping, number, numbers, objects, text
from equilux_report.tree import CaseRecord


@dataclass(frozen=True)
class BandFacts:
    """One band's row in the table."""

    band: str
    coefficients: tuple[float | None, float | None, float | None]
    """K_diff, K_spec, p."""
    rho_normal: float | None
    largest_rho: float | None
    energy: str
    reciprocity: str


@dataclass(frozen=True)
class BrdfView:
    """One material: two SVGs (ours, with nothing of the scene's in them but escaped names) and a table."""

    name: str
    kind: str
    polar: str
    reflectance: str
    bands: tuple[BandFacts, ...]


def brdf_views(case: CaseRecord) -> tuple[BrdfView, ...]:
    """The materials that reflect, in the order of the scene; those whose numbers are not whole are left out."""
    found = (_view(material) for material in objects(case.materials, "materials"))
    return tuple(view for view in found if view is not None)


def _view(material: Facts) -> BrdfView | None:
    studies = {band: study for band, study in mapping(material, "bands").items() if isinstance(study, Mapping)}
    curves = [Curve(band, study) for band, study in studies.items() if band in ("all", "r", "g", "b") and _is_whole(study)]
    if not curves:
        return None
    name, kind = text(material, "name"), text(material, "kind")
    title = f"{name}, {kind}"
    facts = tuple(_facts(curve) for curve in curves)
    return BrdfView(name, kind, polar_plot(curves, title, style=""), reflectance_plot(curves, title, style=""), facts)


def _is_whole(study: Facts) -> bool:
    pairs = (("curve_deg", "curve"), ("rho_deg", "rho"))
    return number(study, "theta_i_deg") is not None and all(
        len(numbers(study, x)) == len(numbers(study, y)) > 0 for x, y in pairs
    )


def _facts(curve: Curve) -> BandFacts:
    study = curve.study
    brdf, energy, reciprocity = (mapping(study, key) for key in ("brdf", "energy", "reciprocity"))
    above = number(energy, "above_one_from_deg")
    words = [f"ρ > 1 from {above:.4g}°"] if above is not None else []
    words += ["grows like 1/cosθ"] if energy.get("unbounded") is True else []
    apart = number(reciprocity, "largest")
    return BandFacts(
        {"all": "R G B"}.get(curve.band, curve.band.upper()),
        (number(brdf, "diffuse"), number(brdf, "specular"), number(brdf, "exponent")),
        numbers(study, "rho")[0],
        number(energy, "largest"),
        "conserved" if energy.get("conserved") is True else ", ".join(words) or "not conserved",
        "reciprocal" if reciprocity.get("reciprocal") is True else f"off by up to {100 * (apart or 0):.3g} %",
    )
