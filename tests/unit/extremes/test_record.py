"""extremes.json says what is documented."""

from __future__ import annotations

import json
from pathlib import Path

from equilux.extremes import record

SCHEMA_FILE = Path(record.__file__).with_name("extremes.schema.json")


def test_the_published_schema_is_that_of_the_code():
    expected = json.dumps(record.json_schema(), indent=1, ensure_ascii=False) + "\n"
    command = "python -m equilux.extremes.record > harness/equilux/extremes/extremes.schema.json"
    assert SCHEMA_FILE.read_text() == expected, f"run: {command}"
