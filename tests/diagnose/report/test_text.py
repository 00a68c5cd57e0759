# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The report's numbers and sentences."""

import math
import unicodedata

import pytest

from cg2raw.diagnose.diagnosis import Estimate, Gap
from cg2raw.diagnose.report import text as words

NAN = float("nan")
EFFECTS = """
    exposure white_balance color_matrix blur lateral_chromatic_aberration veiling_glare
    lens_shading color_shading crosstalk gr_gb_imbalance nonlinearity full_well
    prnu dsnu column_fixed_pattern hot_pixels black_level dark_current shot_noise
    read_noise row_noise noise_reduction heavy_tailed_noise poisson_shot_noise
""".split()


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
    ("count", "shown"),
    [(0, "0 darks"), (1, "1 dark"), (2, "2 darks"), (1234567, "1 234 567 darks"),
     (NAN, "unknown darks")],
)  # fmt: skip
def test_counts_are_whole_numbers(count, shown):
    assert ascii_words(words.counted(count, "dark")) == shown


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
    ("before", "after", "shown"),
    [(0.41, 0.00031, "99.92 %"), (1.0, 1e-9, "99.99 %"), (0.3, 0.0, "100 %"),
     (0.3, -0.001, "100 %"), (0.2, 0.3, "-50.00 %"), (0.0, 0.0, "unknown"),
     (NAN, 0.0, "unknown"), (0.4, NAN, "unknown")],
)  # fmt: skip
def test_the_closed_share_is_never_rounded_up(before, after, shown):
    gap = Gap(before, after, 1, 1, None, None, [])
    assert ascii_words(words.percent(words.closed(gap))) == shown


@pytest.mark.parametrize(
    ("e_value", "shown", "strength", "odds"),
    [
        (1e300, "at least 10300", "Decisive", "1 in 10300 "),
        (5.8e13, "5.8x1013", "Decisive", "1 in 1013 "),
        (150.0, "150", "Decisive", "1 in 150 "),
        (40.0, "40", "Very strong", "1 in 40 "),
        (12.0, "12", "Strong", "1 in 12 "),
        (5.0, "5.0", "Substantial", "1 in 5.0 "),
        (1.5, "1.5", "Barely worth mentioning", "1 in 1.5 "),
        (0.2, "0.20", "No evidence", "against"),
        (NAN, "unknown", "The strength", "not known"),
    ],
)
def test_an_e_value_in_words(e_value, shown, strength, odds):
    number, sentence = map(ascii_words, words.evidence(e_value))
    assert number == shown and sentence.startswith(strength) and odds in sentence


def test_long_runs_are_told_in_minutes():
    assert words.duration(12.34) == "12.3 s"
    assert words.duration(3 * 60 + 7.9) == "3 min 7 s"
