"""What happens to the renders of one case once they are there: stated, saved, compared with one another, remembered."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from equilux import budget_file, compare, diagnosing, uncertainty
from equilux.accuracy import NOT_YET, Demand
from equilux.adapter import Budget, Case, Geometric, Image
from equilux.brdf.ofcase import materials_json
from equilux.diagnose.diagnosis import Diagnosis
from equilux.identity import case_digest, comparer_identity
from equilux.job import BUDGET_FILE, IMAGE_FILE, LOG_FILE, PROGRAM_FOLDER, WORK_FOLDER, Outcome
from equilux.lazytracer import LazyTracer
from equilux.luminance import luminance_of, photometry_of
from equilux.peerpairs import Explanation, Peers
from equilux.planes import read_planes, write_planes
from equilux.results import AccuracyRecord, Luminance
from equilux.reuse import Store, code_fingerprint, key
from equilux.tree import Tree, read_json
from equilux.trust import TRUTHS, ordered_pair, truth_among
from equilux.uncertainty import Uncertainty
from equilux.wholefile import write_json
from equilux.worker import BadDelivery, checked_image, describe_program

RENDER_SCHEMA = "equilux/render/1"
OUTCOME_FILE = "outcome.json"
MAPS_FILE = "uncertainty.exr"
MATERIALS_FILE = "materials.json"


@dataclass(frozen=True)
class Provenance:
    """Who rendered, beyond the outcome: what render.json says of it."""

    adapter: str
    version: str
    knobs: Mapping[str, Any]
    key: str | None
    """Key of the render in the store; None when it must not be reused."""


@dataclass(frozen=True)
class Delivered:
    """A picture that can be compared."""

    adapter: str
    load: Callable[[], compare.RenderedImage]
    """Gives the picture: one that was kept from an earlier run is only read where somebody looks at it."""
    digest: str
    """Hash of the image and its budget."""
    budget: Callable[[], Budget | None]
    """The budget that the image came with; None where it is not known any more."""

    @cached_property
    def side(self) -> compare.RenderedImage:
        return self.load()


@dataclass
class CaseWork:
    """One case of a run. `settle` and `settle_earlier` may be called from several threads at once, each for another adapter."""

    case: Case
    tree: Tree
    store: Store | None
    flip: bool = False
    records: dict[str, dict[str, Any]] = field(default_factory=dict)
    """render.json by adapter."""
    pairs: dict[tuple[str, str], dict[str, Any]] = field(default_factory=dict)
    luminance: dict[str, Luminance] = field(default_factory=dict)
    """By adapter, of the renders that delivered."""
    diagnoses: dict[str, Diagnosis] | None = None
    """By adapter, of the renders that diverge from the truth; None until `diagnose` was called."""
    explanations: dict[tuple[str, str], Explanation] = field(default_factory=dict)
    """By pair, of peers that diverge."""
    errors: list[str] = field(default_factory=list)
    """Faults of the engine itself: comparisons and diagnoses that raised."""
    _delivered: dict[str, Delivered] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def __post_init__(self) -> None:
        self._tracer = LazyTracer(self.case)
        self.photometry = photometry_of(self.case)

    def refuse(self, who: Provenance, status: str, reason: str | None, missing_features: tuple[str, ...]) -> None:
        """Record a render that was never run."""
        outcome = Outcome(status, reason, missing_features=list(missing_features), attempts=0)
        self.settle(who, outcome, self.tree.stage())

    def settle(
        self, who: Provenance, outcome: Outcome, folder: Path, *, reused: bool = False, compare_too: bool = True,
        demand: Demand | None = None,
    ) -> str:  # fmt: skip
        """Turn what a job left in `folder` into the render's folder in the tree, and compare it with its peers. Returns its
        status; or, where it claims less than is asked of it and more can be tried, NOT_YET: then nothing is done but that the
        render is remembered, and the folder stays."""
        delivered: Delivered | None = None
        image_facts: dict[str, Any] | None = None
        stated: Uncertainty | None = None
        accuracy: AccuracyRecord | None = None
        status, reason = outcome.status, outcome.reason
        if status == "ok":
            try:
                image, budget = self._load(folder)
                stated = self._stated(budget, image)
                digest = _digest(image, budget)
                image_facts = _image_facts(image, stated) | {"digest": digest}
                side = compare.RenderedImage(who.adapter, image, stated)
                delivered = Delivered(who.adapter, lambda: side, digest, lambda: budget)
                if any(image_facts[kind] for kind in ("nan", "+inf", "-inf", "negative")):
                    status, reason = "invalid", _invalid_reason(image_facts)
                elif not reused and self.store is not None and who.key is not None:
                    self._remember(who.key, outcome, folder)
                if demand is not None and status == "ok":
                    accuracy = demand.judged(image, stated, who.knobs)
                    if not accuracy.met and not demand.last:
                        return NOT_YET
                _save_pictures(folder, image, stated)
            except (BadDelivery, budget_file.MalformedBudget, ValueError) as problem:
                status, reason, delivered, stated, image_facts = "failed", str(problem), None, None, None
                accuracy = None
        _clean(folder, keep_picture=delivered is not None)
        record = {
            "schema": RENDER_SCHEMA,
            "case": self.case.name,
            "adapter": who.adapter,
            "status": status,
            "missing_features": outcome.missing_features,
            "reason": reason,
            "signal": outcome.signal,
            "attempts": outcome.attempts,
            "version": who.version,
            "seconds": outcome.seconds,
            "cpu_seconds": outcome.cpu_seconds,
            "uncertainty": stated.to_json() if stated is not None else None,
            "accuracy": accuracy.model_dump(mode="json") if accuracy is not None else None,
            "knobs": dict(who.knobs),
            "environment": outcome.environment,
            "stderr_tail": outcome.stderr_tail,
            "program": outcome.program,
            "image": image_facts,
            "reused": reused,
            "key": who.key,
            "files": _file_hashes(folder) if delivered is not None else {},
        }
        write_json(folder / "render.json", record)
        self.tree.drop_pairs(self.case.name, who.adapter)
        self.tree.install_render(folder, self.case.name, who.adapter)
        self._join(who.adapter, record, delivered, compare_too=compare_too)
        return status

    def settle_from_store(self, who: Provenance, demand: Demand | None = None) -> str | None:
        """Take the render from the store. Returns what `settle` does; None when it is not there."""
        if self.store is None or who.key is None:
            return None
        folder = self.tree.stage()
        try:
            if self.store.fetch("renders", who.key, folder) and (saved := read_json(folder / OUTCOME_FILE)) is not None:
                outcome = Outcome(**saved)
                (folder / OUTCOME_FILE).unlink()
                if (
                    outcome.program is None
                    or describe_program(folder / PROGRAM_FOLDER, outcome.program["entry"]) != outcome.program
                ):
                    raise ValueError("the program is not what it was")
                self._load(folder)
                status = self.settle(who, outcome, folder, reused=True, demand=demand)
                if status == NOT_YET:
                    shutil.rmtree(folder, ignore_errors=True)
                return status
        except (OSError, ValueError, TypeError, KeyError, BadDelivery, budget_file.MalformedBudget):
            pass  # written by something else than this code: as good as absent
        shutil.rmtree(folder, ignore_errors=True)
        return None

    def settle_earlier(self, who: Provenance, demand: Demand | None = None) -> bool:
        """Keep the render that a continued tree already holds. False when there is none that is whole, made from the same inputs
        and as accurate as is asked, or when the store has lost its budget: without that a diagnosis would be another."""
        folder = self.tree.render_folder(self.case.name, who.adapter)
        record = read_json(folder / "render.json")
        if record is None or who.key is None or record.get("status") != "ok" or record.get("key") != who.key:
            return False
        if self.store is not None and not self.store.holds("renders", who.key):
            return False
        try:
            if not record["files"] or record["files"] != _file_hashes(folder):
                return False
            stated, digest = record["uncertainty"], str(record["image"]["digest"])
        except (OSError, KeyError, TypeError):
            return False

        def side() -> compare.RenderedImage:
            return compare.RenderedImage(who.adapter, saved_picture(folder), Uncertainty.from_json(stated, folder / MAPS_FILE))

        if demand is not None:
            looked_at = side()
            accuracy = demand.judged(looked_at.image, looked_at.uncertainty, who.knobs)
            if not accuracy.met and not demand.last:
                return False
            record["accuracy"] = accuracy.model_dump(mode="json")
        record["reused"] = True
        diagnosing.save(None, folder)  # it is made again, or found in the store: what it was made against may have changed
        its_key = str(who.key)
        self._join(who.adapter, record, Delivered(who.adapter, side, digest, lambda: self._remembered_budget(its_key)))
        return True

    def _load(self, folder: Path) -> tuple[Image, Budget]:
        """Image and budget as a worker wrote them, checked again: third-party code ran in there."""
        film = self.case.scene.film
        shape = (film.height, film.width, 3)
        try:
            image = np.load(folder / IMAGE_FILE, allow_pickle=False)
        except (OSError, ValueError, EOFError) as problem:
            raise BadDelivery(f"the picture cannot be read back: {problem}") from problem
        return checked_image(image, shape), budget_file.check(budget_file.load(folder / BUDGET_FILE), shape)

    def _stated(self, budget: Budget, image: Image) -> Uncertainty:
        """The budget propagated to radiance; where that needs the tracer it is slow, and remembered."""
        if not any(isinstance(term, Geometric) and (term.normal or term.position_m) for term in budget.terms):
            return uncertainty.stated(budget, image, None)
        its_key = key(
            what="uncertainty",
            case=case_digest(self.case),
            budget=budget_file.digest(budget),
            dtype=str(image.dtype),
            shape=image.shape,
            comparer=comparer_identity(),
        )
        folder = self.tree.stage()
        try:
            if self.store is not None and self.store.fetch("uncertainties", its_key, folder):
                return Uncertainty.from_json(json.loads((folder / "uncertainty.json").read_bytes()), folder / MAPS_FILE)
            stated = uncertainty.stated(budget, image, self._tracer)
            if self.store is not None:
                self.store.put("uncertainties", its_key, lambda entry: _write_uncertainty(entry, stated))
            return stated
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _remember(self, its_key: str, outcome: Outcome, folder: Path) -> None:
        def fill(entry: Path) -> None:
            for name in (IMAGE_FILE, BUDGET_FILE):
                shutil.copyfile(folder / name, entry / name)
            shutil.copytree(folder / PROGRAM_FOLDER, entry / PROGRAM_FOLDER)
            write_json(entry / OUTCOME_FILE, vars(outcome))

        if self.store is not None:
            self.store.put("renders", its_key, fill)

    def _remembered_budget(self, its_key: str) -> Budget | None:
        """The budget of a render that the store holds."""
        folder = self.tree.stage()
        try:
            if self.store is not None and self.store.fetch("renders", its_key, folder):
                return budget_file.load(folder / BUDGET_FILE)
        except budget_file.MalformedBudget:
            pass  # as good as absent
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        return None

    def _join(self, adapter: str, record: dict[str, Any], delivered: Delivered | None, *, compare_too: bool = True) -> None:
        """Add a render to the case and compare it with those that are already there."""
        with self._lock:
            partners = dict(self._delivered)
            self.records[adapter] = record
            if delivered is not None:
                self._delivered[adapter] = delivered
        if delivered is not None and self.photometry is not None:
            luminance = luminance_of(delivered.side.image, self.photometry.luminance_weights)
            if luminance is not None:
                self.luminance[adapter] = luminance
        if delivered is not None and compare_too:
            for name, partner in partners.items():
                self._compare(*((delivered, partner) if ordered_pair(adapter, name) == (adapter, name) else (partner, delivered)))

    def _compare(self, a: Delivered, b: Delivered) -> None:
        names = (a.adapter, b.adapter)
        try:
            result = self._compared(a, b)
        except Exception as problem:  # ours, not a renderer's: recorded, reported, and the run goes on
            self.errors.append(
                f"{self.case.name}: comparing {names[0]} with {names[1]} failed: {type(problem).__name__}: {problem}"
            )
            return
        with self._lock:
            self.pairs[names] = result

    def _compared(self, a: Delivered, b: Delivered) -> dict[str, Any]:
        """Statistics of a pair, from the store or computed, with their files in the tree."""
        stem = f"{a.adapter}--{b.adapter}"
        pairs = self.tree.pairs_folder(self.case.name)
        its_key = key(
            what="pair",
            case=case_digest(self.case),
            sides=[a.adapter, b.adapter],
            images=[a.digest, b.digest],
            flip=self.flip,
            comparer=comparer_identity(),
        )
        if self.tree.continued and (kept := _kept_pair(pairs, stem, its_key)) is not None:
            return kept
        folder = self.tree.stage()
        try:
            if self.store is not None and self.store.fetch("pairs", its_key, folder):
                found = read_json(folder / f"{stem}.json")
                if found is not None:
                    for path in sorted(folder.glob(f"{stem}.*")):  # .exr before .json
                        os.replace(path, pairs / path.name)
                    return found
            result = compare.compare_pair(a.side, b.side, self._tracer, flip=self.flip)
            result.json["key"] = its_key
            compare.write_pair(self.tree.case_folder(self.case.name), result)
            if self.store is not None:
                self.store.put("pairs", its_key, lambda entry: _copy_pair(pairs, stem, entry))
            return result.json
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    @property
    def diverges(self) -> bool:
        """Whether there is anything to diagnose."""
        return bool(self._divergent())

    def _divergent(self) -> dict[str, tuple[Delivered, dict[str, Any]]]:
        """The renders of laboratories that have pixels which diverge from the truth, each with its pair."""
        truth = truth_among(self._delivered)
        pairs = {name: self.pairs.get((name, truth)) for name in sorted(self._delivered) if truth and name not in TRUTHS}
        return {
            name: (self._delivered[name], pair)
            for name, pair in pairs.items()
            if pair is not None and pair["verdict"] == "diverge" and pair["diverge"]
        }

    def diagnose(self, method: diagnosing.Method) -> None:
        """Say why each render diverges from the truth, where one does. To be called once, when the case is complete."""
        self.diagnoses = {}
        for name, (delivered, pair) in self._divergent().items():
            try:
                found = self._diagnosed(delivered, self._delivered[pair["b"]], pair, method)
                diagnosing.save(found, self.tree.render_folder(self.case.name, name))
                self.diagnoses[name] = found
            except Exception as problem:  # ours, not the renderer's
                self.errors.append(f"{self.case.name}: diagnosing {name} failed: {type(problem).__name__}: {problem}")

    def explain_peers(self) -> None:
        """Say how far what was found of each render accounts for how it differs from its peers. To be called after `diagnose`."""
        found = self.diagnoses or {}
        asked = {
            names: pair
            for names, pair in self.pairs.items()
            if not set(names) & set(TRUTHS) and set(names) & set(found) and pair["verdict"] == "diverge" and pair["diverge"]
        }
        truth = truth_among(self._delivered)
        if not asked or truth is None:
            return
        subjects = {
            name: (self._subject(self._delivered[name], self._delivered[truth], self.pairs[name, truth]), found.get(name))
            for name in sorted({name for names in asked for name in names})
        }
        peers = Peers(self.case, subjects, self.store, self.tree)
        for names, pair in sorted(asked.items()):
            try:
                explanation = peers.explained(self._scored(pair))
            except Exception as problem:  # ours, not a renderer's
                what = f"explaining {names[0]} with {names[1]} failed"
                self.errors.append(f"{self.case.name}: {what}: {type(problem).__name__}: {problem}")
            else:
                self.explanations |= {} if explanation is None else {names: explanation}

    def _diagnosed(self, render: Delivered, truth: Delivered, pair: dict[str, Any], method: diagnosing.Method) -> Diagnosis:
        return diagnosing.diagnosed(self.case, self._subject(render, truth, pair), method, self.store, self.tree)

    def _subject(self, render: Delivered, truth: Delivered, pair: dict[str, Any]) -> diagnosing.Subject:
        name = render.adapter
        return diagnosing.Subject(
            render.side,
            render.digest,
            truth.side,
            truth.digest,
            lambda: self._scored(pair),
            render.budget,
            tuple(expectation.cause for expectation in self.case.expectations if expectation.adapter == name),
        )

    def _scored(self, pair: dict[str, Any]) -> compare.PairResult:
        return diagnosing.scored_pair(pair, self.tree.pairs_folder(self.case.name))

    def write_materials(self) -> None:
        """Write materials.json, from the store or computed. Raises OSError."""
        target = self.tree.case_folder(self.case.name) / MATERIALS_FILE
        its_key = key(what="materials", case=case_digest(self.case), code=code_fingerprint("equilux.brdf"))
        folder = self.tree.stage()
        try:
            if self.store is None or not self.store.fetch("materials", its_key, folder):
                write_json(folder / MATERIALS_FILE, materials_json(self.case))
                if self.store is not None:
                    self.store.put("materials", its_key, lambda entry: _copy_file(folder, entry, MATERIALS_FILE))
            os.replace(folder / MATERIALS_FILE, target)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def forget_pictures(self) -> None:
        """Give back the memory of a case that is complete."""
        with self._lock:
            self._delivered.clear()
        self._tracer.release()


def _kept_pair(pairs: Path, stem: str, its_key: str) -> dict[str, Any] | None:
    """A pair that a continued tree holds already, made from the same inputs; None where there is none that is whole."""
    kept = read_json(pairs / f"{stem}.json")
    if kept is None or kept.get("key") != its_key:
        return None
    without_planes = kept.get("film_delta_px") is None  # the images could not be laid over each other
    return kept if without_planes or (pairs / f"{stem}.exr").exists() else None


def _copy_file(folder: Path, entry: Path, name: str) -> None:
    shutil.copyfile(folder / name, entry / name)


def _copy_pair(pairs: Path, stem: str, entry: Path) -> None:
    for suffix in (".json", ".exr"):
        if (pairs / f"{stem}{suffix}").exists():
            shutil.copyfile(pairs / f"{stem}{suffix}", entry / f"{stem}{suffix}")


def _write_uncertainty(entry: Path, stated: Uncertainty) -> None:
    write_json(entry / "uncertainty.json", stated.to_json())
    stated.save_maps(entry / MAPS_FILE)


def _digest(image: Image, budget: Budget) -> str:
    return key(
        image=hashlib.sha256(image.tobytes()).hexdigest(),
        dtype=str(image.dtype),
        shape=image.shape,
        budget=budget_file.digest(budget),
    )


def _file_hashes(folder: Path) -> dict[str, str]:
    """Of the files that hold a render's picture and its uncertainty, by name. Raises OSError."""
    return {
        name: hashlib.sha256((folder / name).read_bytes()).hexdigest()
        for name in ("image.exr", IMAGE_FILE, MAPS_FILE)
        if (folder / name).exists()
    }


def _image_facts(image: Image, stated: Uncertainty) -> dict[str, Any]:
    """Size, type, hash, and how many pixels hold at least one value that is no radiance, by kind."""
    finite = np.isfinite(image)
    with np.errstate(invalid="ignore", over="ignore"):
        negative = finite & (image < 0) & (-image.astype(np.float64) > stated.bound(np.where(finite, image, 0.0)))

    def pixels(which: Any) -> int:
        return int(which.any(axis=2).sum())

    return {
        "width": image.shape[1],
        "height": image.shape[0],
        "dtype": str(image.dtype),
        "sha256": hashlib.sha256(image.tobytes()).hexdigest(),
        "largest": float(np.abs(image[finite]).max(initial=0.0)),
        "nan": pixels(np.isnan(image)),
        "+inf": pixels(np.isposinf(image)),
        "-inf": pixels(np.isneginf(image)),
        "negative": pixels(negative),
    }


def _invalid_reason(facts: Mapping[str, Any]) -> str:
    kinds = [
        f"{facts[kind]} {words}"
        for kind, words in (
            ("nan", "NaN"),
            ("+inf", "+Inf"),
            ("-inf", "-Inf"),
            ("negative", "negative beyond its own uncertainty"),
        )
        if facts[kind]
    ]
    return f"of {facts['width'] * facts['height']} pixels: {', '.join(kinds)}"


def _save_pictures(folder: Path, image: Image, stated: Uncertainty) -> None:
    with np.errstate(over="ignore"):
        write_planes(folder / "image.exr", {band: image[..., index] for index, band in enumerate("RGB")})
    stated.save_maps(folder / MAPS_FILE)
    if image.dtype != np.float64:
        (folder / IMAGE_FILE).unlink()


def saved_picture(folder: Path) -> Image:
    """The picture of a render in the tree: the double one where there is one."""
    if (folder / IMAGE_FILE).exists():
        image: Image = np.ascontiguousarray(np.load(folder / IMAGE_FILE, allow_pickle=False))
        return image
    planes = read_planes(folder / "image.exr")
    return np.ascontiguousarray(np.stack([planes[band] for band in "RGB"], axis=-1))


def _clean(folder: Path, *, keep_picture: bool) -> None:
    """Leave in a job's folder only what belongs into the tree."""
    shutil.rmtree(folder / WORK_FOLDER, ignore_errors=True)
    unwanted = [BUDGET_FILE, LOG_FILE] + ([] if keep_picture else [IMAGE_FILE, "image.exr", MAPS_FILE])
    for name in unwanted:
        (folder / name).unlink(missing_ok=True)
