# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The report's numbers and sentences."""

import math
import unicodedata
from dataclasses import replace

import pytest

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.report import text as words
from diagnose.made_up_diagnosis import made_up_diagnosis

NAN = float("nan")


def ascii_words(text):
    """Return a text with plain digits, signs and spaces."""
    text = text.replace(words.TIMES, "x").replace(words.MINUS, "-")
    return unicodedata.normalize("NFKC", text).replace(words.MINUS, "-")


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0, "0"), (-0.0, "0"), (0.41129, "0.411"), (-0.3412, "-0.341"),
        (1.0012, "1.00"), (18342.1, "18 300"), (999.6, "1 000"), (999999.0, "1.00x106"),
        (2.5e7, "2.50x107"), (0.000123, "0.000123"), (0.0000999999, "0.000100"),
        (1.234e-5, "1.23x10-5"), (4.9e-324, "4.94x10-324"), (-1e-9, "-1.00x10-9"),
        (9.999e-9, "1.00x10-8"),
        (None, "unknown"), (NAN, "unknown"), (math.inf, "unknown"),
    ],
)  # fmt: skip
def test_numbers(value, shown):
    assert ascii_words(words.number(value)) == shown


@pytest.mark.parametrize(
    ("value", "shown"),
    [(18342.14, "18 342"), (31.70, "31.7"), (-2.1, "-2.1"), (-0.04, "0.0"),
     (NAN, "unknown"), (4.56e7, "4.560x107")],
)  # fmt: skip
def test_nats(value, shown):
    assert ascii_words(words.nats(value)) == shown


@pytest.mark.parametrize(
    ("value", "ci95", "shown"),
    [
        (-0.34123, (-0.34412, -0.33834), ("-0.3412", "-0.3441 to -0.3383")),
        (0.412, (0.31, 0.51), ("0.41", "0.31 to 0.51")),
        (1234.6, (1200.0, 1270.0), ("1 235", "1 200 to 1 270")),
        (0.25, (0.25, 0.25), ("0.2500", "0.250 to 0.250")),
        (0.25, (NAN, 0.3), ("0.2500", "unknown")),
        (3e-9, (2e-9, 4e-9), ("3.000x10-9", "2.00x10-9 to 4.00x10-9")),
    ],
)  # fmt: skip
def test_a_parameter_has_the_digits_of_its_interval(value, ci95, shown):
    got = words.estimate(Estimate(value, "1", ci95))
    assert tuple(map(ascii_words, got)) == shown


@pytest.mark.parametrize(
    ("verdict", "count", "shown"),
    [
        ("explained", 1, "Lens shading is missing from the profile"),
        ("explained", 2, "Two effects are missing from the profile"),
        ("ambiguous", 2, "Two effects are missing from the profile"),
        ("explained", 12, "12 effects are missing from the profile"),
        ("consistent", 0, "Nothing in these frames contradicts the profile"),
    ],
)
def test_the_headline_counts(verdict, count, shown):
    found = made_up_diagnosis(verdict=verdict)
    effects = (6 * found.effects)[:count]
    assert words.headline(replace(found, effects=effects)) == shown


def test_what_the_profile_has_already_is_not_missing():
    found = made_up_diagnosis()
    shading, rows = found.effects
    found = replace(found, effects=[shading, replace(rows, stated=True)])
    assert words.headline(found) == (
        "One effect is missing from the profile and one is not as it says"
    )
    alone = replace(found, effects=found.effects[1:])
    assert words.headline(alone) == "Row noise is not as the profile says"


NAMES = "Lens shading and row noise. "
NOISE = "residuals of the test frames cannot be told from noise."
LEFT = "Most of what is left is in: row autocorrelation"


@pytest.mark.parametrize(
    ("verdict", "count", "shown"),
    [
        ("consistent", 0, f"The {NOISE}"),
        ("explained", 1, f"With it, the {NOISE}"),
        ("explained", 2, f"{NAMES}With them, the {NOISE}"),
        ("ambiguous", 2, f"{NAMES}These frames cannot tell row noise or read noise."),
        ("incomplete", 0, "More may be missing."),
        ("incomplete", 2, f"{NAMES}More may be missing."),
        ("unexplained", 0, f"{LEFT}."),
        ("partially_explained", 2, f"{NAMES}{LEFT}, and the names are provisional."),
    ],
)
def test_the_summary_has_several_names_and_what_is_left(verdict, count, shown):
    found = made_up_diagnosis(verdict=verdict)
    assert words.summary(replace(found, effects=found.effects[:count])) == shown


@pytest.mark.parametrize(
    ("names", "shown"),
    [([], ""), (["a"], "a"), (["a", "b"], "a or b"), (["a", "b", "c"], "a, b or c")],
)
def test_lists(names, shown):
    assert words.listed(names, "or") == shown


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [(12.34, "12.3 s"), (60, "1 min 0 s"), (3 * 60 + 7.9, "3 min 7 s")],
)
def test_runs_from_a_minute_on_are_told_in_minutes(seconds, shown):
    assert words.duration(seconds) == shown
