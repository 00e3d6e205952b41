"""What makes two renders the same render: hashes and versions that reuse and continuation go by."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any
from weakref import WeakKeyDictionary

from equilux.adapter import API_VERSION, Case, Knobs
from equilux.registry import Entry
from equilux.reuse import code_fingerprint, key

SHARED_CODE = ("equilux_scenes", "equilux.adapter", "equilux.budget", "equilux.budget_file", "equilux.worker")
"""Code of ours that has a part in every render."""
COMPARING_CODE = (
    "equilux.compare",
    "equilux.edges",
    "equilux.uncertainty",
    "equilux.planes",
    "equilux._compare",
    "equilux_tracer",
)
"""Code of ours that has a part in every comparison."""
DIAGNOSING_CODE = (*COMPARING_CODE, "equilux.diagnose", "equilux.diagnosing", "equilux.dialect", "equilux.peerpairs")
"""Code of ours that has a part in every diagnosis."""

_digests: WeakKeyDictionary[Case, str] = WeakKeyDictionary()


def case_digest(case: Case) -> str:
    """Hash of what determines the case's picture."""
    if case not in _digests:
        _digests[case] = hashlib.sha256(case.canonical()).hexdigest()
    return _digests[case]


def adapter_identity(entry: Entry, knobs: Knobs | None) -> dict[str, Any]:
    """Version, knobs and code of an adapter as it is installed here."""
    return {
        "version": entry.version,
        "distribution": f"{entry.distribution} {entry.distribution_version}",
        "knobs": knobs.model_dump(mode="json") if knobs is not None else {},
        "code": adapter_code(entry),
        "found": entry.probe.found,
    }


def version_is_known(identity: Mapping[str, Any]) -> bool:
    """Whether a renderer of this identity may be taken for the same one another day."""
    return not str(identity["version"]).startswith("unknown")


def adapter_code(entry: Entry) -> str:
    """Hash of the adapter's own package, and of the packages that it names in the optional attribute `code_packages`."""
    packages = tuple(getattr(entry.adapter, "code_packages", ()))
    return code_fingerprint(entry.entry_point.module, *packages)


def render_key(case: Case, identity: dict[str, Any], adapter: str) -> str | None:
    """Key of a render; None for one that must not be reused, because the renderer's version is not known."""
    if not version_is_known(identity):
        return None
    return key(
        what="render",
        protocol=API_VERSION,
        case=case_digest(case),
        adapter=adapter,
        identity=identity,
        shared=code_fingerprint(*SHARED_CODE),
    )


def comparer_identity() -> str:
    """Version and code of everything that turns two images into statistics."""
    from equilux.compare import COMPARER_VERSION

    return f"{COMPARER_VERSION} {code_fingerprint(*COMPARING_CODE)}"


def diagnoser_identity(rules: Mapping[str, Any]) -> str:
    """Version and code of everything that names a divergence: third parties' rules too."""
    from equilux.compare import COMPARER_VERSION

    foreign = {type(rule).__module__ for rule in rules.values() if not type(rule).__module__.startswith("equilux_tracer.")}
    return f"{COMPARER_VERSION} {code_fingerprint(*DIAGNOSING_CODE, *sorted(foreign))}"
