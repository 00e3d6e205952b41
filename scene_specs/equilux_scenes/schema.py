"""The JSON Schema (draft 2020-12) of a spec, for editors: completion, descriptions and early errors while typing.

Made from the typed model. `python -m equilux_scenes.schema` writes it to `scene.schema.json` beside this file, which is shipped.
The schema knows types and ranges; what holds between values (an undefined material, eye = target) only the loader knows.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from equilux_scenes.model import Part, Scene, Strength
from equilux_scenes.units import bands_key, strengths
from equilux_scenes.values import OnlyIn

DIALECT = "https://json-schema.org/draft/2020-12/schema"


class _Generator(GenerateJsonSchema):
    schema_dialect = DIALECT

    def default_schema(self, schema: Any) -> dict[str, Any]:
        """Optional keys are left out, never written as null, so a null default says nothing to an editor."""
        result = super().default_schema(schema)
        return {key: value for key, value in result.items() if key != "default" or value is not None}


def json_schema() -> dict[str, Any]:
    """The schema as a JSON-compatible dictionary."""
    schema = Scene.model_json_schema(schema_generator=_Generator)
    for cls in _parts(Part):
        properties = (schema if cls is Scene else schema["$defs"].get(cls.__name__, {})).get("properties", {})
        for name, field in cls.model_fields.items():
            only = next((item for item in field.metadata if isinstance(item, OnlyIn)), None)
            if only is not None and name in properties:
                words = f"Only in the model {only}; in a scene of another model, leave it out."
                properties[name]["description"] = f"{field.description} {words}" if field.description else words
        if issubclass(cls, Strength) and (part := schema["$defs"].get(cls.__name__)) is not None:
            _one_strength(part, cls)
    return {"$schema": DIALECT, **schema, "title": "equilux scene spec"}


def _one_strength(part: dict[str, Any], cls: type[Strength]) -> None:
    """Bands are required, or else what they are worked out from."""
    bands = bands_key(cls)
    part["required"].remove(bands)
    each = [{"required": [key]} for key in strengths(cls)]
    alone = [{"required": [bands], "not": {"required": ["spectrum"]}}, {"required": ["spectrum"], "not": {"anyOf": each}}]
    part["oneOf"] = [*alone, *each[1:]]


def _parts(base: type[Part]) -> Iterator[type[Part]]:
    for cls in base.__subclasses__():
        yield cls
        yield from _parts(cls)


def schema_text() -> str:
    """The schema as the text of `scene.schema.json`."""
    return json.dumps(json_schema(), indent=2, ensure_ascii=False, sort_keys=True) + "\n"


def schema_file() -> Path:
    """Where the shipped schema lies."""
    return Path(__file__).with_name("scene.schema.json")


if __name__ == "__main__":
    schema_file().write_text(schema_text(), encoding="utf-8")
