"""`equilux adapters …`: what is installed, and what it can do."""

from __future__ import annotations

import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Parameter

from equilux.cli import inputs
from equilux.dialect import declared_dialect

if TYPE_CHECKING:
    from equilux.registry import Entry


def build() -> App:
    app = App(name="adapters", help="What renderers are installed, and what each supports.")
    app.command(list_, name="list")
    return app


def list_(*, json: Annotated[bool, Parameter(name="--json", negative="")] = False) -> int:
    """List the installed adapters: version, whether the renderer was found, what it supports, its knobs. One that cannot be
    loaded is listed with its error.

    Parameters
    ----------
    json
        Print a JSON list.
    """
    from equilux.registry import Registry

    entries = list(Registry.discover().entries.values())
    described = [describe(entry) for entry in entries]
    if json:
        inputs.print_json(described)
        return 0
    if not entries:
        sys.stdout.write("no adapter is installed\n")
        return 0
    rows = [("adapter", "version", "renderer", "supports", "from")]
    rows += [(found["name"], found["version"], _state(found), _support(found), found["distribution"]) for found in described]
    sys.stdout.write(inputs.table(rows))
    for found in described:
        sys.stdout.write(_details(found))
    return 0


def describe(entry: Entry) -> dict[str, Any]:
    """All there is to say of an adapter, as JSON."""
    from equilux.registry import last_line

    error = entry.error
    capabilities: dict[str, Any] = {}
    try:
        capabilities = {
            feature: {"level": capability.level, "note": capability.note} for feature, capability in entry.capabilities.items()
        }
    except Exception as problem:
        error = f"capabilities() raised {last_line(problem)}"
    schemas = entry.adapter.Knobs.model_json_schema().get("properties", {}) if entry.adapter is not None else {}
    knobs = {name: schema | {"allowed": _allowed(schema)} for name, schema in schemas.items()}
    return {
        "name": entry.name,
        "version": entry.version,
        "found": entry.probe.found,
        "detail": entry.probe.detail,
        "error": error,
        "api_version": entry.adapter.api_version if entry.adapter is not None else None,
        "distribution": f"{entry.distribution} {entry.distribution_version}".strip(),
        "entry_point": entry.entry_point.value,
        "capabilities": capabilities,
        "knobs": knobs,
        "lack_causes": dict(entry.adapter.lack_causes) if entry.adapter is not None else {},
        "dialect": [asdict(declared) for declared in declared_dialect(entry.adapter)],
    }


def _state(found: dict[str, Any]) -> str:
    return "error" if found["error"] else ("found" if found["found"] else "missing")


def _support(found: dict[str, Any]) -> str:
    levels = [capability["level"] for capability in found["capabilities"].values()]
    return f"{levels.count('exact')} exact, {levels.count('approximate')} approximate" if levels else ""


def _details(found: dict[str, Any]) -> str:
    """What is worth a line of its own: an error, where the renderer is, what it lacks, its knobs."""
    from equilux_scenes.features import FEATURES

    lines = [f"{found['name']}: {found['error'] or found['detail']}"]
    can = found["capabilities"]
    lacking = [feature for feature in FEATURES if feature not in can or can[feature]["level"] == "none"]
    if lacking and not found["error"]:
        lines.append(f"  lacks {', '.join(lacking)}")
    for name, knob in found["knobs"].items():
        lines.append(f"  --set {found['name']}.{name}={knob.get('default')}  {knob.get('description', '')}".rstrip())
        if trade := _trade(knob):
            lines.append(f"      {trade}")
    return "".join(f"{line}\n" for line in lines)


def _trade(knob: dict[str, Any]) -> str:
    """What a knob may be set to, which way is faster, and the steps that are worth trying, the fastest first."""
    parts = [f"allowed {knob['allowed']}"] if knob["allowed"] else []
    if "faster" in knob:
        faster = knob["faster"]
        parts.append(f"faster {_listed(faster) if isinstance(faster, list) else faster}")
    if "steps" in knob:
        parts.append(f"steps {_listed(knob['steps'])}")
    return "; ".join(parts)


def _listed(values: Any) -> str:
    return ", ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values)


def _allowed(schema: dict[str, Any]) -> str:
    """The values that a knob takes, from its JSON schema: `8 … 4096`, `png16 | exr`, `scene | 1 … 256`; "" where all are."""
    if "anyOf" in schema:
        return " | ".join(part for part in map(_allowed, schema["anyOf"]) if part)
    if "enum" in schema or "const" in schema:
        return " | ".join(str(value) for value in schema.get("enum", [schema.get("const")]))
    low, above = schema.get("minimum"), schema.get("exclusiveMinimum")
    high, below = schema.get("maximum"), schema.get("exclusiveMaximum")
    start = f"{low:g}" if low is not None else f"> {above:g}" if above is not None else ""
    end = f"{high:g}" if high is not None else f"< {below:g}" if below is not None else ""
    return f"{start} … {end}".strip() if start or end else ""
