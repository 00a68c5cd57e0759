# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Parameters in the units that a reader measures."""

import math
from dataclasses import replace

import pytest

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.report.values import Shown, in_unit, limit_words, powers, shown
from diagnose.made_up_diagnosis import WHITE, made_up_diagnosis
from diagnose.report.test_text import ascii_words

MADE_UP = made_up_diagnosis(electrons_per_dn=2.0)
PROFILE = "times the profile's"


@pytest.mark.parametrize(
    ("effect", "parameter", "low", "high", "unit", "expected"),
    [
        ("row_noise", "sigma", 3 / WHITE, 5 / WHITE, "1",
         ("standard deviation", "4.0", "3.0 to 5.0 DN (6.0 to 10.0 e-)", "DN")),
        ("dark_current", "per_second", 3 / WHITE, 5 / WHITE, "1/s",
         ("", "4.0", "3.0 to 5.0 DN/s (6.0 to 10.0 e-/s)", "DN/s")),
        ("exposure", "gain", 0.03, 0.05, "1", ("gain", "4.0", "3.0 to 5.0 %", "%")),
        ("hot_pixels", "fraction", 0.03, 0.05, "1",
         ("fraction", "4.0", "3.0 to 5.0 %", "%")),
        ("lens_shading", "tilt_x", 0.3, 0.5, "1",
         ("tilt x", "0.40", "0.30 to 0.50", "")),
        ("lateral_chromatic_aberration", "red_r1", 3, 5, "px",
         ("red r1", "4.0", "3.0 to 5.0 px", "px")),
        ("read_noise", "log_variance", math.log(1.5), math.log(6), "1",
         ("variance", "3.0", "1.5 to 6.0", PROFILE)),
        ("read_noise", "log_variance", 0, 120, "1",
         ("variance", "unknown", "unknown", PROFILE)),
    ],
)  # fmt: skip
def test_values_and_intervals_in_units(effect, parameter, low, high, unit, expected):
    one = Estimate((low + high) / 2, unit, (low, high))
    found = in_unit(effect, parameter, one, MADE_UP)
    words = (found.name, found.value, found.interval, found.unit)
    assert tuple(map(ascii_words, words)) == expected


def test_electrons_and_dn_are_said_where_they_are_known():
    sigma = Estimate(4 / WHITE, "1", (3 / WHITE, 5 / WHITE))
    no_electrons, no_white = (
        in_unit("row_noise", "sigma", sigma, replace(MADE_UP, **{name: None}))
        for name in ("electrons_per_dn", "white_dn")
    )
    assert (no_electrons.interval, no_electrons.unit) == ("3.0 to 5.0 DN", "DN")
    assert (no_white.value, no_white.unit) == ("0.000250", "")


def test_of_the_only_site_no_name_is_said():
    one, _ = MADE_UP.effects
    offset = Estimate(1 / WHITE, "1", (0.9 / WHITE, 1.1 / WHITE))
    for sites, names in ((1, ["offset"]), (2, ["offset 00", "offset 01"])):
        parameters = {f"offset_0{n}": offset for n in range(sites)}
        given = replace(one, name="black_level", parameters=parameters)
        assert [each.name for each in shown(given, MADE_UP)] == names
    assert Shown("", "4", "", "DN").words == "4 DN"


@pytest.mark.parametrize(
    ("effect", "parameter", "strength", "unit", "expected"),
    [
        ("read_noise", "log_variance", math.log(1.1), "1", "10 % of the variance"),
        ("exposure", "gain", 4.2e-4, "1", "0.042 % (gain)"),
        ("dark_current", "per_second", 4 / WHITE, "1/s", "4.0 DN/s"),
        ("lens_shading", "r2", 0.013, "1", "0.013 (r2)"),
    ],
)
def test_limits_have_two_digits(effect, parameter, strength, unit, expected):
    assert limit_words(effect, parameter, strength, unit, MADE_UP) == expected


@pytest.mark.parametrize(
    ("likelier", "expected"),
    [(0.1, "1"), (9876.4, "9 876"), (1.01e4, "104"), (9.9e13, "1013"),
     (1.01e300, "10300"), (math.inf, "more than 10300")],
)  # fmt: skip
def test_how_much_likelier_nats_make(likelier, expected):
    nats = min(math.log(likelier), 302 * math.log(10))
    assert ascii_words(powers(nats)) == f"{expected} times"
