"""Materials as POV-Ray textures: one layer where the bands allow it, a stack of layers where they do not.

POV-Ray multiplies diffuse, ambient and emission by the pigment and the highlight by nothing (Q4), so one layer carries three
bands of diffuse light beside a grey highlight. Anything else is layered: a layer of transmit ½ contributes with weight ½ and
shows what lies below with weight ½, and powers of two in the coefficients restore the weights without rounding (Q6).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from equilux_adapters.povray.numbers import bands, number, vector
from equilux_scenes.model import Material

Triple = Sequence[float]
Layer = Callable[[float, bool], str]
"""(weight to restore, half-transparent?) → text"""

BLACK = (0.0, 0.0, 0.0)
LARGEST_RATIO = 1e6  # a pigment carries another term only up to this quotient, far inside float32


@dataclass(frozen=True)
class Coefficients:
    """What a material does in its scene: terms that cannot show are zero."""

    diffuse: Triple
    specular: Triple
    exponent: float
    ambient: Triple
    emission: Triple


@dataclass(frozen=True)
class Texture:
    """The text of a texture, and whether it has several layers (then `adc_bailout 0` is needed: Q7)."""

    text: str
    layered: bool


def coefficients(material: Material, ambient: Triple) -> Coefficients:
    shown = tuple(k if light else 0.0 for k, light in zip(material.ambient, ambient, strict=True))
    return Coefficients(material.diffuse, material.specular, material.exponent, shown, material.emission)


def texture(material: Coefficients) -> Texture:
    """The simplest exact texture for `material`."""
    glow = replace(material, diffuse=BLACK, specular=BLACK)
    surface = material
    layers: list[Layer] = []
    above: list[Layer] = []
    if any(material.diffuse) and not all(_carries(material.diffuse, term) for term in (material.ambient, material.emission)):
        surface = replace(material, ambient=BLACK, emission=BLACK)
        above.append(_surface(glow))
    if len(set(material.specular)) > 1:
        layers += [_highlight(material.exponent), _filter(material.specular)]
        surface = replace(surface, specular=BLACK)
    if not layers or any(surface.diffuse) or any(surface.ambient) or any(surface.emission):
        layers.append(_surface(surface))
    layers += above
    return Texture("\n".join(_stacked(layers)), len(layers) > 1)


def _stacked(layers: Sequence[Layer]) -> list[str]:
    """Bottom layer first, as POV-Ray wants it; only the bottom one is opaque, and a filter above halves nothing."""
    texts: list[str] = []
    weight = 1.0
    for position in range(len(layers) - 1, -1, -1):
        layer, half = layers[position], position > 0 and not _is_filter(layers[position])
        weight *= 2.0 if half else 1.0
        texts.append(layer(weight, half))
    return texts[::-1]


def _carries(pigment: Triple, term: Triple) -> bool:
    """Can `term` be written as a colour times the pigment?"""
    return all(t <= LARGEST_RATIO * p for p, t in zip(pigment, term, strict=True))


def _surface(material: Coefficients) -> Layer:
    """Diffuse light with three bands, what glows, and a grey highlight: one layer."""
    # without diffuse light the pigment only carries the glow: white
    pigment = material.diffuse if any(material.diffuse) else (1.0, 1.0, 1.0)

    def text(weight: float, half: bool) -> str:
        colour = f"rgbt {vector([*pigment, 0.5])}" if half else f"rgb {bands(pigment)}"
        diffuse = weight if any(material.diffuse) else 0.0
        finish = [_glow("ambient", material.ambient, pigment, weight), f"diffuse {number(diffuse)}"]
        if any(material.emission):
            finish.append(_glow("emission", material.emission, pigment, weight) + " * Exposure")
        if any(material.specular):
            finish.append(f"phong {number(material.specular[0] * weight)} phong_size {number(material.exponent)}")
        return f"texture {{ pigment {{ {colour} }} finish {{ {' '.join(finish)} }} }}"

    return text


def _glow(keyword: str, term: Triple, pigment: Triple, weight: float) -> str:
    return f"{keyword} " + _rgb([weight * t / p if t else 0.0 for p, t in zip(pigment, term, strict=True)])


def _rgb(values: Triple) -> str:
    return "0" if not any(values) else f"rgb {bands(values)}"


def _highlight(exponent: float) -> Layer:
    """The bottom of a coloured highlight: a grey one on black, seen through a filter of the highlight's colour (Q6)."""

    def text(weight: float, half: bool) -> str:
        return f"texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 phong 1 phong_size {number(exponent)} }} }}"

    return text


class _Filter:
    """Tints what lies below, and restores the weight that the layers above take from it."""

    def __init__(self, colour: Triple) -> None:
        self.colour = colour

    def __call__(self, weight: float, half: bool) -> str:
        colour = vector([*(band * weight for band in self.colour), 1.0])
        return f"texture {{ pigment {{ rgbf {colour} }} finish {{ ambient 0 diffuse 0 }} }}"


def _filter(colour: Triple) -> Layer:
    return _Filter(colour)


def _is_filter(layer: Layer) -> bool:
    return isinstance(layer, _Filter)
