"""The BRDFs of a case's materials, for the results tree: `cases/<case>/materials.json`."""

from __future__ import annotations

from typing import Any

from equilux.brdf.lobes import Brdf, brdf_of
from equilux.brdf.study import study
from equilux_scenes.case import Case

SCHEMA = "equilux/materials/1"
THETA_I_DEG = 45.0


def by_band(bands: list[Brdf]) -> dict[str, Brdf]:
    """"all" where the three bands are alike, else "r", "g", "b"."""
    return {"all": bands[0]} if len(set(bands)) == 1 else dict(zip("rgb", bands, strict=True))


def materials_json(case: Case) -> dict[str, Any]:
    """Every material that an object uses and that reflects light diffusely or in a highlight, examined band by band."""
    materials = []
    for name in dict.fromkeys(obj.material for obj in case.scene.objects):
        bands = [brdf_of(case.scene.materials[name], case.scene, band) for band in range(3)]
        if any(band.diffuse or band.specular for band in bands):
            studies = {band: study(one, THETA_I_DEG).to_json() for band, one in by_band(bands).items()}
            materials.append({"name": name, "kind": bands[0].kind, "bands": studies})
    return {"schema": SCHEMA, "case": case.name, "materials": materials}
