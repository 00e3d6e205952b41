"""Causes in sentences."""

import math

import pytest

from equilux.diagnose.words import SAID, sentence
from equilux_scenes.causes import CAUSES
from equilux_tracer.causes import RULES, Applied, Rule, Vector


@pytest.mark.parametrize(
    ("applied", "said"),
    [
        (Applied("exponent-clamped", 128.0), "the highlight's exponent is cut off at 128"),
        (Applied("clamped", 0.5), "radiance is cut off at 0.5 W/(m²·sr)"),
        (Applied("scaled", math.pi), "radiance is multiplied by 3.141593 (π)"),
        (Applied("light-missing", "key"), "the light key is left out"),
        (Applied("attenuation-term-missing", "linear"), "the linear term of the attenuation is left out"),
        (Applied("shifted", (3.0, -0.5)), "the picture is displaced by (3, -0.5) px to the right and down"),
        (Applied("quantised", 8), "radiance is rounded to 8 bits"),
        (Applied("spot-cone-ignored", 90.0), "the spot's cone has no effect from 90° on"),
        (Applied("recursion-cut", 2), "reflections end after 2 of them"),
        (Applied("diffuse-missing"), "the diffuse term is left out"),
    ],
)
def test_a_parameter_stands_in_the_sentence(applied, said):
    assert sentence(RULES[applied.cause], applied) == said


def test_what_a_fit_leaves_of_a_zero_is_not_shown():
    said = sentence(RULES["shifted"], Applied("shifted", (1.0, -8.3e-8)))
    assert "(1, 0) px" in said


def test_a_reading_is_told_in_its_own_words():
    reading = "black in mirrors"
    said = sentence(RULES["background-missing"], Applied("background-missing", None, reading))
    assert said.endswith(f"({RULES['background-missing'].readings[reading]})")


@pytest.mark.parametrize("cause", [id_ for id_, summary in CAUSES.items() if "[" in summary])
def test_no_sentence_shows_a_placeholder(cause):
    """Every cause that contracts §5 gives a parameter has a sentence for it."""
    rule = RULES[cause]
    value = (1.0,) * len(rule.parameter.names) if isinstance(rule.parameter, Vector) else 2.0
    said = sentence(rule, Applied(cause, value))
    assert cause in SAID, f"{cause}: no sentence with a parameter"
    assert "[" not in said, said
    assert "{" not in said, said


def test_every_rule_with_a_parameter_has_a_sentence_for_it():
    without = [id_ for id_, rule in RULES.items() if rule.parameter is not None and id_ not in SAID]
    assert not without, f"no sentence with a parameter: {', '.join(without)}"


def test_a_third_partys_parameter_is_told_by_name():
    class Fog(Rule):
        id, group, formula = "acme:fog", "transport", ("", "")
        parameter = RULES["clamped"].parameter

    assert sentence(Fog(), Applied("acme:fog", 0.5)) == "acme:fog: value = 0.5 W/(m²·sr)"
