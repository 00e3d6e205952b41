"""The verdicts in words: what diverges, where, by how much, and whether it was expected."""

from __future__ import annotations

import math
from collections.abc import Iterable

from equilux_report import numerals
from equilux_report.facts import Facts, count, items, mapping, number, numbers, objects, text
from equilux_report.tree import CaseRecord, Pair, Render

JUDGED = {
    "diverge_unexpected": "diverges unexpectedly",
    "improved": "expectation gone",
    "diverge_expected": "diverges as pinned",
    "not_comparable": "not comparable",
    "agree": "agrees",
}
"""The five judgements, gravest first."""

FINDING = {
    "unexplained": "unexplained",
    "implementation-bug": "implementation bug",
    "translation-bug": "translation bug",
    "model-difference": "model difference",
    "as-modelled": "as modelled",
}
"""What a render is found to do, gravest first."""

FINDING_MEANS = {
    "unexplained": "departs from the model, and no named cause accounts for it",
    "implementation-bug": "departs from what it declares, by rules of the renderer's own",
    "translation-bug": "departs by what is more likely a fault of the translation to it",
    "model-difference": "departs from the scene's model exactly as its adapter declares",
    "as-modelled": "agrees with the truth",
}

EXPECTATION = {"held": "holds", "gone": "no longer holds", "open": "could not be judged"}

STATUS = {
    "ok": "rendered",
    "invalid": "invalid pixels",
    "failed": "failed",
    "crashed": "crashed",
    "timeout": "timed out",
    "missing": "renderer missing",
    "unsupported": "unsupported",
    "incomplete": "incomplete",
}

CLASSES = ("agree", "diverge", "edge", "invalid")
INVALID_KINDS = {"nan": "NaN", "+inf": "+Inf", "-inf": "-Inf", "negative": "negative beyond its uncertainty"}
RADIANCE = "W/(m²·sr)"
TIMES = "\u202f×\u202f"


def causes(case: CaseRecord, pair: Pair) -> list[str]:
    """Cause ids that go with a pair: diagnosed ones, else those its expectations name."""
    diagnosed = [text(cause, "id") for cause in objects(pair.facts, "causes") if text(cause, "id")]
    if diagnosed or pair.judged not in ("diverge_expected", "improved"):
        return diagnosed
    return list(
        dict.fromkeys(text(item, "cause") for item in objects(case.facts, "expect") if text(item, "adapter") in (pair.a, pair.b))
    )


def worst_band(pair: Pair) -> tuple[float, float] | None:
    """The two radiances where they are farthest apart."""
    seen = _look_at(pair)
    a, b = numbers(seen, "a"), numbers(seen, "b")
    if not a or len(a) != len(b):
        return None
    return max(zip(a, b, strict=True), key=lambda values: abs(values[0] - values[1]))


def worst_pixel(pair: Pair) -> tuple[int, int] | None:
    """Column and row of the pixel where the two are farthest apart; of the first invalid one where nothing else diverges."""
    if count(pair.facts, "diverge") == 0 and pair.first_invalid is not None:
        return pair.first_invalid
    seen = _look_at(pair)
    x, y = number(seen, "x"), number(seen, "y")
    return None if x is None or y is None else (int(x), int(y))


def en_max(pair: Pair) -> float | None:
    """Largest |E_n|; ∞ where a difference meets no stated uncertainty at all."""
    return math.inf if count(pair.facts, "en_infinite") else number(pair.facts, "en_max")


def reason(pair: Pair) -> str:
    """What the engine says of the pair beyond its counts, which `pixels_of` puts better."""
    counts = f" of {count(pair.facts, 'pixels')} pixels "
    return "; ".join(part for part in text(pair.facts, "reason").split("; ") if part and counts not in part)


def pixels_of(pair: Pair) -> str:
    """ "312 of 49 152 pixels (0.63 %)", diverging and invalid ones apart."""
    whole, diverge, invalid = (count(pair.facts, key) for key in ("pixels", "diverge", "invalid"))
    parts = []
    if diverge or not invalid:
        parts.append(f"{numerals.count(diverge)} of {numerals.plural(whole, 'pixel')} ({numerals.percent(diverge, whole)})")
    if invalid:
        parts.append(f"{numerals.plural(invalid, 'invalid pixel')} ({numerals.percent(invalid, whole)})")
    return " and ".join(parts)


def _size(pair: Pair) -> str:
    en = en_max(pair)
    band, parts = worst_band(pair), []
    if band is not None:
        parts.append(f"{numerals.magnitude(band[0])} against {numerals.magnitude(band[1])} {RADIANCE}")
    if en is not None:
        up_to = "up to " if _is_elsewhere(pair) else ""
        times = f"{up_to}{numerals.magnitude(en)}{TIMES}the stated uncertainty"
        parts.append(times if math.isfinite(en) else "no uncertainty stated")
    return ", ".join(parts)


def _look_at(pair: Pair) -> Facts:
    """The pixel to be shown where there is room for one; results of before have only the one most beyond uncertainty."""
    return mapping(pair.facts, "farthest") or mapping(pair.facts, "worst")


def _is_elsewhere(pair: Pair) -> bool:
    """Whether E_n is largest at another pixel than the difference."""
    worst = mapping(pair.facts, "worst")
    return any(number(_look_at(pair), axis) != number(worst, axis) for axis in "xy")


def _gone(case: CaseRecord, pair: Pair) -> list[str]:
    """Expectations of a pair's sides that no longer hold; of results that do not say which, all."""
    pins = [item for item in objects(case.facts, "expect") if text(item, "adapter") in (pair.a, pair.b)]
    return list(dict.fromkeys(text(item, "cause") for item in [item for item in pins if item.get("held") is False] or pins))


def _fate(case: CaseRecord, pair: Pair) -> str:
    names = _gone(case, pair) if pair.judged == "improved" else list(dict.fromkeys(causes(case, pair)))
    if pair.judged == "diverge_expected":
        return f"pinned as {' and '.join(names)}" if names else "expected"
    if pair.judged == "improved":
        return (
            f"pinned as {' and '.join(names)}, which no longer shows: take the pin out"
            if names
            else "expected to diverge, and does not"
        )
    if pair.judged != "diverge_unexpected":
        return ""
    gone = [item for item in objects(case.facts, "expect") if text(item, "adapter") == pair.a and item.get("held") is False]
    return "not expected" + (f"; {listed(text(item, 'cause') for item in gone)} is expected, and not found" if gone else "")


def sentence(case: CaseRecord, pair: Pair) -> str:
    """One pair in one sentence, without the place of its worst pixel (the page links that)."""
    facts = pair.facts
    if pair.verdict == "not-comparable":
        return f"{pair.a} cannot be compared with {pair.b}: {text(facts, 'reason') or 'no reason was recorded'}."
    if pair.verdict == "diverge":
        if reason(pair) and count(facts, "diverge") + count(facts, "invalid") == 0:
            parts = [f"{pair.a} diverges from {pair.b}: {reason(pair)}"]
        else:
            parts = [f"{pair.a} diverges from {pair.b} on {pixels_of(pair)}"]
            worst = worst_pixel(pair)
            if worst is not None and count(facts, "diverge"):
                parts[0] += f", worst at ({worst[0]}, {worst[1]}): {_size(pair)}".rstrip(": ")
            kinds = mapping(facts, "invalid_kinds")
            for side, name in (("a", pair.a), ("b", pair.b)):
                if told := invalid_kinds(mapping(kinds, side)):
                    parts.append(f"{name} has {told}")
            if reason(pair):
                parts.append(reason(pair))
    else:
        parts = [
            f"{pair.a} agrees with {pair.b} on {_all(pair)}: largest |Eₙ| {numerals.magnitude(en_max(pair))}, "
            f"largest difference {numerals.magnitude(number(facts, 'max_abs'))} {RADIANCE}"
        ]
    edge = count(facts, "edge")
    if edge:
        parts.append(f"{numerals.plural(edge, 'edge pixel')} set apart")
    fate = _fate(case, pair)
    return "; ".join([*parts, *([fate] if fate else [])]) + "."


def _all(pair: Pair) -> str:
    whole, agree = count(pair.facts, "pixels"), count(pair.facts, "agree")
    return (
        f"all {numerals.plural(whole, 'pixel')}"
        if agree == whole
        else f"{numerals.count(agree)} of {numerals.plural(whole, 'pixel')}"
    )


def render_sentence(render: Render) -> str:
    """Why a render gave no image (or a bad one), in one sentence."""
    told, missing = text(render.facts, "reason"), [str(item) for item in items(render.facts, "missing_features")]
    if render.status == "unsupported":
        models = [feature for feature in missing if feature.startswith("model.")]
        if models:  # whoever does not do the model does nothing of the scene
            return f"{render.adapter} does not do {listed(models)}."
        what = (
            f"{render.adapter} does not support {listed(missing)}" if missing else f"{render.adapter} does not support this case"
        )
    elif render.status == "crashed":
        signal = number(render.facts, "signal")
        what = f"{render.adapter} crashed" + (f" (signal {int(signal)})" if signal is not None else "")
    elif render.status == "invalid":
        kinds = invalid_kinds(mapping(render.facts, "image"))
        what = f"{render.adapter} wrote invalid values" + (f": {kinds}" if kinds else "")
    else:
        what = {
            "timeout": f"{render.adapter} ran out of time",
            "missing": f"{render.adapter} is not installed",
            "failed": f"{render.adapter} failed",
            "incomplete": f"{render.adapter} left no record",
        }.get(render.status, f"{render.adapter}: {render.status}")
    return f"{what}: {told}." if told else f"{what}."


def invalid_kinds(kinds: Facts) -> str:
    """ "36 NaN, 3 +Inf" of the kinds that occur."""
    found = [f"{numerals.count(count(kinds, key))} {name}" for key, name in INVALID_KINDS.items() if count(kinds, key)]
    return ", ".join(found)


def listed(names: Iterable[str]) -> str:
    """ "a, b and c"."""
    *most, last = [*names] or [""]
    return f"{', '.join(most)} and {last}" if most else last
