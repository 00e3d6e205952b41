"""Every texture weighs every term as the model asks, by POV-Ray's rules for layers (QUIRKS.md, Q4, Q6, Q30, Q31)."""

from __future__ import annotations

import random
import re
from dataclasses import dataclass, field

import numpy as np
import pytest

from equilux_adapters.povray.materials import Coefficients, coefficients
from equilux_adapters.povray.textures import LEAST_FILTER, texture
from equilux_scenes.model import Scene

FLOAT32 = 2.0**-24
ROUNDINGS = 8
"""Products and quotients in double precision that a weight goes through: far more than there are; they round in 2⁻⁵³."""


@dataclass
class Weights:
    """What a texture makes of each term, per band."""

    front: np.ndarray = field(default_factory=lambda: np.zeros(3))
    back: np.ndarray = field(default_factory=lambda: np.zeros(3))
    highlight: np.ndarray = field(default_factory=lambda: np.zeros(3))
    ambient: np.ndarray = field(default_factory=lambda: np.zeros(3))
    emission: np.ndarray = field(default_factory=lambda: np.zeros(3))
    reflection: np.ndarray = field(default_factory=lambda: np.zeros(3))
    through: np.ndarray = field(default_factory=lambda: np.ones(3))


def bands_of(text: str) -> np.ndarray:
    """`0.5`, `rgb 0.5` or `rgb <1, 2, 3>`."""
    numbers = [float(n) for n in re.findall(r"-?\d[\d.e+-]*", text)]
    return np.array(numbers if len(numbers) == 3 else numbers * 3)


def weighed(text: str) -> Weights:
    """POV-Ray's rules, applied to a written texture from the top layer down (trace.cpp, ComputeLightedTexture)."""
    result = Weights()
    passing = result.through
    for line in reversed(text.splitlines()):
        pigment, finish = re.fullmatch(r"texture { pigment { (.*?) } finish { (.*) } }", line.strip()).groups()
        kind, numbers = pigment.split(" ", 1)
        values = np.array([float(n) for n in numbers.strip("<>").split(",")])
        colour = values[:3] if len(values) >= 3 else np.repeat(values, 3)
        filtered, transmitted = (values[3] if kind == "rgbf" else 0.0), (values[3] if kind == "rgbt" else 0.0)
        own = passing * colour * (1.0 - filtered - transmitted)
        terms = dict(re.findall(r"(\w+) (rgb [^a-z{}]*|{ rgb [^}]*}|[\d.e+-]+(?:, [\d.e+-]+)?)", finish))
        front, _, back = terms["diffuse"].partition(", ")
        result.front = result.front + own * float(front)
        result.back = result.back + own * float(back or 0)
        result.ambient = result.ambient + own * bands_of(terms["ambient"])
        result.emission = result.emission + own * bands_of(terms.get("emission", "0"))
        result.highlight = result.highlight + passing * float(terms.get("phong", terms.get("specular", "0")))
        result.reflection = result.reflection + bands_of(terms.get("reflection", "0"))
        passing = passing * (filtered * colour + transmitted)
    result.through = passing
    return result


def random_material(rng: random.Random) -> dict:
    def bands(high: float) -> list[float]:
        grey = rng.random() < 0.3
        values = [rng.choice([0.0, rng.uniform(0, high), rng.uniform(0, high)]) for _ in range(3)]
        return [values[0]] * 3 if grey else values

    return {
        "diffuse": bands(2), "specular": bands(2), "exponent": 7.0, "ambient": bands(1), "emission": bands(3),
        "reflection": bands(1), "transmission": bands(1.5), "transparency": rng.choice([0.0, 1.0, rng.random(), rng.random()]),
        "ior": rng.choice([1.0, 1.5]),
    }


def terms_of(material: dict, model: str = "raytraced") -> Coefficients:
    scene = Scene.model_validate({
        "equilux": 1, "name": "n", "model": model, "ambient": (1.0, 0.5, 0.25), "film": {"width": 1, "height": 1},
        "camera": {"projection": "perspective", "eye": (0.0, 0.0, 3.0), "target": (0.0, 0.0, 0.0), "fov_y_deg": 30.0},
        "materials": {"m": {key: tuple(value) if isinstance(value, list) else value for key, value in material.items()}},
    })
    return coefficients(scene.materials["m"], scene)


def test_any_material_comes_out_with_the_weights_of_the_model():
    rng = random.Random("textures")
    for _ in range(3000):
        m = random_material(rng)
        got, t = weighed(texture(terms_of(m)).text), m["transparency"]
        wanted = {
            "front": (1 - t) * np.array(m["diffuse"]), "back": t * np.array(m["diffuse"]),
            "highlight": (1 - t) * np.array(m["specular"]),
            "ambient": np.array(m["ambient"]), "emission": np.array(m["emission"]),
            "reflection": (1 - t) * np.array(m["reflection"]), "through": t * np.array(m["transmission"]),
        }
        for name, value in wanted.items():
            error = np.abs(getattr(got, name) - value)
            allowed = ROUNDINGS * 2.0**-53 * value + 1.001 * LEAST_FILTER
            assert (error <= allowed).all(), f"{name} of {m}: {getattr(got, name)}, wanted {value}\n{texture(terms_of(m)).text}"


def test_all_numbers_stay_far_inside_float32():
    rng = random.Random("ranges")
    for _ in range(1000):
        text = texture(terms_of(random_material(rng))).text
        numbers = [abs(float(n)) for n in re.findall(r"(?<![a-z_])-?\d[\d.]*(?:e[+-]?\d+)?", text)]
        # a quotient by LEAST_FILTER and LEAST_FILTER itself are the extremes
        assert all(n == 0 or LEAST_FILTER / 10 <= n <= 10 / LEAST_FILTER for n in numbers), text


# --- as a user would write them ---------------------------------------------------------------------------------------

SNAPSHOTS = {
    "a mirror": (
        {"reflection": [0.9, 0.8, 0.7]},
        ["texture { pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection { rgb <0.9, 0.8, 0.7> } } }"]),
    "clear glass": (
        {"transparency": 1.0, "transmission": [0.9, 0.9, 0.8], "ior": 1.5},
        ["texture { pigment { rgbf <0.9, 0.9, 0.8, 1> } finish { ambient 0 diffuse 0 } }"]),
    "glass that shines and mirrors": (
        {"transparency": 0.75, "transmission": [1, 1, 1], "specular": [0.5, 0.5, 0.5], "exponent": 20.0, "reflection": [1, 1, 1]},
        ["texture { pigment { rgbf <0.75, 0.75, 0.75, 1> } finish { ambient 0 diffuse 0 phong 0.125 phong_size 20"
         " reflection { rgb 0.25 } } }"]),
    "milk glass is lit on both sides": (
        {"transparency": 0.25, "transmission": [1, 0.5, 1], "diffuse": [0.5, 0.25, 0.5]},
        ["texture { pigment { rgbf <0.5, 0.25, 0.5, 1> } finish { ambient 0 diffuse 0 } }",
         "texture { pigment { rgbt <0.5, 0.25, 0.5, 0.5> } finish { ambient 0 diffuse 1.5, 0.5 } }"]),
    "a highlight's colour is taken out again below it": (
        {"transparency": 0.5, "transmission": [1, 1, 1], "specular": [1, 0.5, 0.25], "exponent": 3.0},
        ["texture { pigment { rgbf <1, 2, 4, 1> } finish { ambient 0 diffuse 0 phong 1 phong_size 3 } }",
         "texture { pigment { rgbf <0.5, 0.25, 0.125, 1> } finish { ambient 0 diffuse 0 } }"]),
    "glass that lets nothing through still reflects totally": (
        {"transparency": 0.5, "transmission": [0, 0, 0], "ior": 1.5},
        ["texture { pigment { rgbf <1e-20, 1e-20, 1e-20, 1> } finish { ambient 0 diffuse 0 } }"]),
}


@pytest.mark.parametrize("name", SNAPSHOTS)
def test_snapshot(name):
    material, layers = SNAPSHOTS[name]
    assert texture(terms_of(material)).text.splitlines() == layers


def test_an_opengl_highlight_is_by_the_half_vector():
    material = {"specular": [0.5, 0.5, 0.5], "exponent": 8.0}
    assert "specular 0.5 roughness 0.125" in texture(terms_of(material, "opengl")).text
    assert "phong 0.5 phong_size 8" in texture(terms_of(material)).text
