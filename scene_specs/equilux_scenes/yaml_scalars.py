"""What a plain YAML scalar is, by the core schema of YAML 1.2.

YAML 1.1 readers turn `1e2` into text and `no` into false; here `1e2`, `.5` and `7.5` are numbers and `no` is text.
"""

from __future__ import annotations

import re

_NULL = {"", "~", "null", "Null", "NULL"}
_BOOL = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INT = re.compile(r"[-+]?[0-9]+\Z")
_OCTAL = re.compile(r"0o[0-7]+\Z")
_HEX = re.compile(r"0x[0-9a-fA-F]+\Z")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_INF = re.compile(r"([-+]?)\.(inf|Inf|INF)\Z")
_NAN = {".nan", ".NaN", ".NAN"}
_EXACT_DIGITS = 15
"""Integers of up to this many decimal digits are exact as doubles; longer ones become the nearest double."""

Scalar = None | bool | int | float | str


def resolve(text: str) -> Scalar:
    """The value of a plain (unquoted) scalar. A number beyond the range of doubles is ±inf, which no field accepts."""
    if text in _NULL:
        return None
    if text in _BOOL:
        return _BOOL[text]
    if _INT.match(text):
        return int(text) if len(text) <= _EXACT_DIGITS else float(text)
    if _FLOAT.match(text):
        return float(text)
    for pattern, base in ((_OCTAL, 8), (_HEX, 16)):
        if pattern.match(text):
            return int(text, base) if len(text) <= _EXACT_DIGITS else float("inf")
    if match := _INF.match(text):
        return float(match.group(1) + "inf")
    return float("nan") if text in _NAN else text
