"""Addresses inside the report. Case names hold brackets, equals signs and commas: percent-encoded in every link."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import quote, urlencode


def encode(name: str) -> str:
    """One path segment."""
    return quote(name, safe="")


@dataclass(frozen=True)
class Links:
    """Where things are, seen from a page: `root` leads from it to the report's root (`""` or `"../"`). Or all is in one file."""

    single_file: bool
    root: str = ""

    def overview(self) -> str:
        return "#" if self.single_file else f"{self.root}index.html"

    def dialects(self, adapter: str | None = None) -> str:
        """What the renderers' lighting models are; of one adapter alone."""
        state = {"page": "dialects"} if self.single_file else {}
        state |= {"adapter": adapter} if adapter else {}
        return ("" if self.single_file else f"{self.root}dialects.html") + (
            "#" + urlencode(state, quote_via=quote) if state else ""
        )

    def case(self, name: str, **state: object) -> str:
        """A case page; `state` becomes its fragment (`pair`, `x`, `y`)."""
        given = {key: value for key, value in state.items() if value is not None}
        if self.single_file:
            return "#" + urlencode({"case": name, **given}, quote_via=quote)
        return f"{self.root}cases/{encode(name)}.html" + ("#" + urlencode(given, quote_via=quote) if given else "")

    def state(self, name: str, **state: object) -> str:
        """A state of the case page that the link is on."""
        return self.case(name, **state) if self.single_file else "#" + urlencode(state, quote_via=quote)

    def data(self, case: str, name: str) -> str:
        return f"{self.root}data/{encode(case)}/{encode(name)}.js"

    def thumbnail(self, case: str, name: str) -> str:
        return f"{self.root}thumbnails/{encode(case)}/{encode(name)}.png"
