"""`equilux brdf`: what a material's BRDF looks like, what it reflects, and whether it is physical."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from equilux.cli import inputs
from equilux.complaint import BadUsage, nearest

if TYPE_CHECKING:
    from equilux.brdf import Brdf, Study

LECTURE_FIGURE = ((0.3, 0.0, 1.0), (0.2, 0.2, 5.0), (0.1, 0.4, 20.0), (0.05, 0.5, 100.0))
"""(K_diff, K_spec, p) shown when nothing else is asked for: from all diffuse to nearly a mirror."""


@dataclass(frozen=True)
class _Subject:
    """One material in one kind of BRDF: a study per band, or one for all three where they are alike."""

    name: str
    studies: dict[str, Study]


def brdf(
    *scenes: Path,
    diffuse: float | None = None,
    specular: float | None = None,
    exponent: float | None = None,
    kind: str | None = None,
    theta_i_deg: float = 45.0,
    out: Path = Path("equilux-brdf"),
    json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    limit: Annotated[tuple[str, ...], Parameter(name="--limit", negative="")] = (),
) -> int:
    """Examine BRDFs: polar plots for a fixed incoming direction, ρ(θ), reciprocity and energy; SVG and numbers.

    Of the materials of scenes, or of one given by its coefficients; with neither, of the lecture's figure.

    Parameters
    ----------
    scenes
        Scene files or folders: every material that an object uses.
    diffuse
        K_diff, 1/sr.
    specular
        K_spec, 1/sr.
    exponent
        p of the highlight.
    kind
        lambert, phong-classic, phong-cosine or half-vector, several separated by commas; none: phong-classic and phong-cosine, or
        for scenes what their model says.
    theta_i_deg
        Where the light comes from, degrees from the normal, in [0, 90).
    out
        Folder for the plots and brdf.json.
    json
        Print the numbers as JSON.
    limit
        Raise a limit on specs, NAME=VALUE.
    """
    if not 0 <= theta_i_deg < 90:
        raise BadUsage(f"--theta-i-deg: got {theta_i_deg:g}, allowed a number in [0, 90)")
    kinds = _kinds(kind)
    coefficients = {"--diffuse": diffuse, "--specular": specular, "--exponent": exponent}
    given = [name for name, value in coefficients.items() if value is not None]
    if given and scenes:
        raise BadUsage(f"{given[0]}: got it together with scenes, allowed coefficients or scenes")
    wrong = [f"{name}: got {value:g}, allowed a finite number ≥ 0" for name, value in coefficients.items() if not _allowed(value)]
    if wrong:
        raise BadUsage(*wrong)
    if "lambert" in kinds and specular:
        raise BadUsage(f"--specular: got {specular:g} with --kind lambert, which has no highlight; allowed 0")
    if out.exists() and not out.is_dir():
        raise BadUsage(f"--out: got '{out}', which is a file, allowed a folder")
    if scenes:
        subjects = list(_of_scenes(scenes, limit, kinds, theta_i_deg, as_json=json))
    else:
        triples = ((diffuse or 0.0, specular or 0.0, 1.0 if exponent is None else exponent),) if given else LECTURE_FIGURE
        subjects = [
            _subject(f"kd{d:g}-ks{s:g}-p{p:g}-{name}", [_one(name, d, s, p)] * 3, theta_i_deg)
            for d, s, p in triples
            for name in kinds or ("phong-classic", "phong-cosine")
        ]
    if not subjects:
        raise BadUsage("no object of these scenes has a material to examine")
    _write(subjects, out)
    if json:
        inputs.print_json(_as_json(subjects))
    else:
        sys.stdout.write(inputs.table(_rows(subjects), right=frozenset(range(2, 9))))
        sys.stdout.write(f"{inputs.shown(out / 'brdf.json')} and {2 * len(subjects)} plots beside it\n")
    return 0


def _allowed(value: float | None) -> bool:
    return value is None or 0 <= value < float("inf")


def _kinds(text: str | None) -> tuple[str, ...]:
    from equilux.brdf import KINDS

    names = inputs.split_names("--kind", text) or []
    for name in names:
        if name not in KINDS:
            raise BadUsage(f"--kind: got '{name}', allowed {', '.join(KINDS)}{nearest(name, KINDS)}")
    return tuple(names)


def _one(kind: str, diffuse: float, specular: float, exponent: float) -> Brdf:
    from equilux.brdf import Brdf

    return Brdf(kind, diffuse, specular, exponent)


def _of_scenes(
    paths: tuple[Path, ...], limit: tuple[str, ...], kinds: tuple[str, ...], theta_i_deg: float, *, as_json: bool
) -> Iterator[_Subject]:
    from dataclasses import replace

    from equilux.brdf import brdf_of

    seen: set[tuple[str, str, tuple[Brdf, ...]]] = set()
    for file in inputs.load(paths, limit, as_json=as_json):
        for case in file.cases:
            for name in dict.fromkeys(obj.material for obj in case.scene.objects):
                bands = [brdf_of(case.scene.materials[name], case.scene, band) for band in range(3)]
                for kind in kinds or (bands[0].kind,):
                    bare = {"specular": 0.0} if kind == "lambert" else {}
                    alike = tuple(replace(band, kind=kind, **bare) for band in bands)
                    if (file.scene.name, name, alike) not in seen:  # a sweep repeats the materials that it does not touch
                        seen.add((file.scene.name, name, alike))
                        yield _subject(f"{case.name}-{name}-{kind}", list(alike), theta_i_deg)


def _subject(name: str, bands: list[Brdf], theta_i_deg: float) -> _Subject:
    from equilux.brdf import study
    from equilux.brdf.ofcase import by_band

    return _Subject(name, {band: study(one, theta_i_deg) for band, one in by_band(bands).items()})


def _write(subjects: list[_Subject], out: Path) -> None:
    import re

    from equilux.wholefile import whole_file, write_json
    from equilux_report.brdfplots import Curve, polar_plot, reflectance_plot

    try:
        out.mkdir(parents=True, exist_ok=True)
        for subject in subjects:
            curves = [Curve(band, one.to_json()) for band, one in subject.studies.items()]
            stem = re.sub(r"[^A-Za-z0-9.=,_-]", "_", subject.name)
            for suffix, plot in (("", polar_plot), ("-reflectance", reflectance_plot)):
                with whole_file(out / f"{stem}{suffix}.svg") as path:
                    path.write_text(plot(curves, subject.name), encoding="utf-8")
        write_json(out / "brdf.json", _as_json(subjects))
    except OSError as problem:
        raise BadUsage(f"--out: the plots cannot be written: {problem}") from problem


def _as_json(subjects: list[_Subject]) -> list[dict[str, object]]:
    return [{"name": s.name, "bands": {band: one.to_json() for band, one in s.studies.items()}} for s in subjects]


def _rows(subjects: list[_Subject]) -> list[tuple[str, ...]]:
    head = ("BRDF", "band", "K_diff", "K_spec", "p", "ρ(0°)", "ρ(60°)", "largest ρ", "at", "energy", "reciprocity")
    rows: list[tuple[str, ...]] = [head]
    for subject in subjects:
        for band, one in subject.studies.items():
            rho = dict(zip(one.rho_deg, one.rho, strict=True))
            energy, reciprocity = one.energy, one.reciprocity
            grows = "grows like 1/cosθ" if energy.unbounded else ""
            above = f"ρ > 1 from {energy.above_one_from_deg:.4g}°" if energy.above_one_from_deg is not None else ""
            rows.append(
                (
                    subject.name, band, f"{one.brdf.diffuse:g}", f"{one.brdf.specular:g}", f"{one.brdf.exponent:g}",
                    f"{rho[0.0]:.6g}", f"{rho[60.0]:.6g}", f"{energy.largest:.6g}", f"{energy.theta_i_deg:g}°",
                    "conserved" if energy.conserved else ", ".join(filter(None, (above, grows))),
                    "yes" if reciprocity.reciprocal else f"off by {100 * reciprocity.largest:.3g} %",
                )
            )  # fmt: skip
    return rows
