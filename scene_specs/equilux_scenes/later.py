"""Words of the spec language that this version does not have yet, so that an error can say so instead of calling them unknown.

Each lighting model that arrives moves its words from here into `model`.
"""

from __future__ import annotations

_PHOTOMETRY = "spectra and photometric units are not in this version"

TERMS_OF_LATER_VERSIONS: dict[tuple[str, str], str] = {
    ("lights", "spectrum"): _PHOTOMETRY,
    ("lights", "luminous_intensity"): _PHOTOMETRY,
}
"""(group of parts, key) → where it belongs."""

KINDS_OF_LATER_VERSIONS: dict[tuple[str, str], str] = {}
"""(group of parts or key, value) → why it is not there."""
