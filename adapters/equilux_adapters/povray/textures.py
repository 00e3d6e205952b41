"""Materials as POV-Ray textures: one layer where the bands allow it, a stack of layers where they do not.

POV-Ray multiplies diffuse, ambient and emission by the pigment and the highlight by nothing (Q4), so one layer carries three
bands of diffuse light beside a grey highlight. Anything else is layered: a layer of transmit ½ contributes with weight ½ and
shows what lies below with weight ½, and powers of two in the coefficients restore the weights without rounding (Q6).

A transparent surface ends below in a clear layer that filters by what the layers above have left of t k_trans: the product of
all filters is what passes (Q30). Reflection is added whatever the layers do (Q31), so any one of them carries it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from equilux_adapters.povray.materials import BLACK, Coefficients, Triple
from equilux_adapters.povray.numbers import bands, grey, number, vector

LARGEST_RATIO = 1e6  # a pigment carries another term only up to this quotient, far inside float32
LEAST_EXPONENT = 1e-30  # stands for zero: the highlight is 1 to the last digit
LEAST_FILTER = 1e-20  # stands for zero where something must still come through; far inside float32


@dataclass(frozen=True)
class Texture:
    """The text of a texture, whether it has several layers (then `adc_bailout 0` is needed: Q7), and the smallest grey value, at
    most 1, that the layers above any one layer let through; and what those above the mirroring one do.
    """

    text: str
    layered: bool
    dimmest: float = 1.0
    above_mirror: float = 1.0


@dataclass(frozen=True)
class _Layer:
    """One layer. tint: it emits nothing of its own, and filters what lies below by these bands (None: it halves, or hides).

    shown: what it shows itself.
    """

    shown: Coefficients
    tint: Triple | None = None


def texture(material: Coefficients) -> Texture:
    """The simplest exact texture for `material`."""
    layers = list(_layers(material))
    texts, reaching = _stacked(layers)
    above_mirror = [grey for layer, grey in zip(layers, reaching, strict=True) if any(layer.shown.reflection)]
    return Texture("\n".join(texts), len(layers) > 1, min(reaching), min(above_mirror, default=1.0))


def _layers(material: Coefficients) -> Sequence[_Layer]:
    """Bottom first. The weights that upper layers take from lower ones are not in them yet."""
    plain = replace(material, reflection=BLACK, through=None)
    nothing = replace(plain, diffuse=BLACK, specular=BLACK, ambient=BLACK, emission=BLACK)
    glow = replace(plain, diffuse=BLACK, specular=BLACK)
    surface, above = plain, []
    if any(material.diffuse) and not all(_carries(material.diffuse, term) for term in (material.ambient, material.emission)):
        surface = replace(surface, ambient=BLACK, emission=BLACK)
        above.append(_Layer(glow))
    below, tint = nothing, None
    if len(set(material.specular)) > 1:
        below, tint = replace(nothing, specular=(1.0, 1.0, 1.0)), material.specular
        surface = replace(surface, specular=BLACK)
    visible = surface if any(surface.diffuse) or any(surface.ambient) or any(surface.emission) else None
    if material.through is None:
        return _opaque(material, surface, visible, below, tint, above)
    return _clear(material, surface, visible, below, tint, above)


def _opaque(
    material: Coefficients, surface: Coefficients, visible: Coefficients | None, below: Coefficients, tint: Triple | None,
    above: list[_Layer],
) -> list[_Layer]:
    if tint is None:
        return [_Layer(replace(surface, reflection=material.reflection)), *above]
    # a coloured highlight: a grey one on black, seen through a filter of its colour (Q6)
    under = [_Layer(below), _Layer(replace(below, specular=BLACK), tint)]
    if visible is None:
        return [replace(under[0], shown=replace(below, reflection=material.reflection)), under[1], *above]
    return [*under, _Layer(replace(visible, reflection=material.reflection)), *above]


def _clear(
    material: Coefficients, surface: Coefficients, visible: Coefficients | None, below: Coefficients, tint: Triple | None,
    above: list[_Layer],
) -> list[_Layer]:
    assert material.through is not None
    through = material.through
    if not any(through) and material.ior != 1:
        # where nothing passes no ray is sent, and a total reflection would be missed (Q32)
        through = (LEAST_FILTER,) * 3
    if tint is None:
        if visible is None:
            return [_Layer(replace(surface, reflection=material.reflection), through), *above]
        return [_Layer(below, through), _Layer(replace(visible, reflection=material.reflection)), *above]
    # the filter of a coloured highlight is undone below the highlight
    coloured = tuple(max(band, LEAST_FILTER) for band in tint)
    undone = tuple(k / band for k, band in zip(through, coloured, strict=True))
    bottom = replace(below, reflection=BLACK if visible is not None else material.reflection)
    under = [_Layer(bottom, undone), _Layer(replace(below, specular=BLACK), coloured)]
    return [*under, *([] if visible is None else [_Layer(replace(visible, reflection=material.reflection))]), *above]


def _stacked(layers: Sequence[_Layer]) -> tuple[list[str], list[float]]:
    """Bottom layer first, as POV-Ray wants it. A layer that neither tints nor lies at the bottom halves what is below it.

    And what reaches each layer through those above it, as a grey value.
    """
    texts: list[str] = []
    reaching, passing = [], (1.0, 1.0, 1.0)
    weight = 1.0
    restored = False
    for position in range(len(layers) - 1, -1, -1):
        layer = layers[position]
        half = position > 0 and layer.tint is None
        weight *= 2.0 if half else 1.0
        filter_weight = weight if not restored else 1.0
        reaching.append(min(1.0, grey(passing)))
        tint = (0.5,) * 3 if half else layer.tint or BLACK
        shares = [band * through * (1.0 if half else filter_weight) for band, through in zip(passing, tint, strict=True)]
        passing = (shares[0], shares[1], shares[2])
        texts.append(_text(layer, 1.0 if restored else weight, half, filter_weight))
        # the first filter from above restores the weight for all that lies below it
        restored = restored or layer.tint is not None
    return texts[::-1], reaching[::-1]


def _carries(pigment: Triple, term: Triple) -> bool:
    """Can `term` be written as a colour times the pigment?"""
    return all(t <= LARGEST_RATIO * p for p, t in zip(pigment, term, strict=True))


def _text(layer: _Layer, weight: float, half: bool, filter_weight: float) -> str:
    if layer.tint is not None:
        pigment: Triple = tuple(band * filter_weight for band in layer.tint)
        colour = f"rgbf {vector([*pigment, 1.0])}"
    else:
        # without diffuse light the pigment only carries the glow: white, or black where nothing glows
        glows = any(layer.shown.ambient) or any(layer.shown.emission)
        pigment = layer.shown.diffuse if any(layer.shown.diffuse) or not (half or glows) else (1.0, 1.0, 1.0)
        colour = f"rgbt {vector([*pigment, 0.5])}" if half else f"rgb {bands(pigment)}"
    # a highlight is weighed by the layers above alone, what the pigment shows by its own transparency too (Q6)
    finish = _finish(layer.shown, pigment, weight, weight / 2.0 if half else weight)
    return f"texture {{ pigment {{ {colour} }} finish {{ {' '.join(finish)} }} }}"


def _finish(shown: Coefficients, pigment: Triple, weight: float, highlight_weight: float) -> list[str]:
    parts = [_glow("ambient", shown.ambient, pigment, weight), _diffuse(shown, weight)]
    if any(shown.emission):
        parts.append(_glow("emission", shown.emission, pigment, weight) + " * Exposure")
    if any(shown.specular):
        parts.append(_highlight(shown, highlight_weight))
    if any(shown.reflection):
        parts.append(f"reflection {{ rgb {bands(shown.reflection)} }}")
    return parts


def _diffuse(shown: Coefficients, weight: float) -> str:
    if not any(shown.diffuse):
        return "diffuse 0"
    back = f", {number(shown.back * weight)}" if shown.back else ""
    return f"diffuse {number(shown.front * weight)}{back}"


def _highlight(shown: Coefficients, weight: float) -> str:
    strength = number(shown.specular[0] * weight)
    if shown.half_vector:
        # the exponent is 1 / roughness (Q40)
        return f"specular {strength} roughness {number(1.0 / max(shown.exponent, LEAST_EXPONENT))}"
    return f"phong {strength} phong_size {number(shown.exponent)}"


def _glow(keyword: str, term: Triple, pigment: Triple, weight: float) -> str:
    return f"{keyword} " + _rgb([weight * t / p if t else 0.0 for p, t in zip(pigment, term, strict=True)])


def _rgb(values: Triple) -> str:
    return "0" if not any(values) else f"rgb {bands(values)}"
