"""The report's style sheet and script: many small files, put together in a fixed order."""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache
from importlib.resources import files

from equilux_report import colour

STYLES = (
    "tokens",
    "base",
    "controls",
    "verdict",
    "overview",
    "skyline",
    "matrix",
    "charts",
    "case",
    "why",
    "dialects",
    "extremes",
    "brdf",
    "tradeoff",
    "viewer",
    "print",
)
SCRIPTS = (
    "namespace",
    "theme",
    "fragment",
    "numerals",
    "decode",
    "data",
    "colormap",
    "looks",
    "view",
    "classmap",
    "panel",
    "legend",
    "inspector",
    "toolbar",
    "viewer",
    "matrix",
    "dialects",
    "copy",
    "router",
)


@cache
def style() -> str:
    """All of static/css, in cascade order."""
    return "".join(f"/* {name} */\n{_read(f'css/{name}.css')}\n" for name in STYLES)


@cache
def script() -> str:
    """All of static/js, in order of dependence, after the colour tables that thumbnails use too."""
    tables = {
        "sequential": colour.encode(colour.sequential()),
        "diverging": colour.encode(colour.diverging()),
        "nan": colour.NAN_COLOUR,
        "plusInf": colour.PLUS_INF_COLOUR,
        "minusInf": colour.MINUS_INF_COLOUR,
        "heatDecades": colour.HEAT_DECADES,
    }
    return f"window.equiluxTables = {json.dumps(tables)};\n" + "".join(map(_wrapped, SCRIPTS))


def _wrapped(name: str) -> str:
    """One file of static/js in a scope of its own; what others use, it puts on `eq`."""
    return f'// {name}\n(function (eq) {{\n"use strict";\n{_read(f"js/{name}.js")}}})(window.equilux ??= {{}});\n'


def csp(*, single_file: bool) -> str:
    """The content-security policy of a page: nothing from outside the report, and no inline script but the one we wrote.

    `unsafe-eval` lets those who drive a browser over the report (our tests, yours) wait for a condition on the page; nothing in
    the report evaluates text, and no text of a results tree reaches a place where it could be.
    """
    digest = base64.b64encode(hashlib.sha256(script().encode()).digest()).decode("ascii")
    scripts = f"'sha256-{digest}'" if single_file else "'self' file:"
    rules = (
        "default-src 'none'",
        f"script-src {scripts} 'unsafe-eval'",
        "style-src 'self' file: 'unsafe-inline'",
        "img-src 'self' file: data: blob:",
        "base-uri 'none'",
        "form-action 'none'",
    )
    return "; ".join(rules)


def _read(name: str) -> str:
    return files("equilux_report").joinpath("static").joinpath(name).read_text(encoding="utf-8")
