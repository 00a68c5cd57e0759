# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Values of what is named, with the errors of their own parameters."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.verdict.values import (
    _before_reduction,
    _moved,
    _of_levels,
    _of_well,
    _withheld,
    limits_of_levels,
    of_amplifiers,
)
from cg2raw.model.full_well import FullWell
from cg2raw.model.lags import variance_left, variance_left_of_lines
from cg2raw.model.values import Value
from cg2raw.normal import CI95
from diagnose.planted import sensor_of, stating

SENSOR = sensor_of()
WHITE = SENSOR.signal_range  # DN


def in_order(values):
    """Return {(effect, parameter): (value, low, high)}."""
    return {(v.effect, v.parameter): v[2:] for v in values}


def test_effects_of_levels_have_the_value_and_error_of_each_parameter():
    """Of crosstalk, both neighbours along a line have half."""
    numbers = np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    levels = SimpleNamespace(
        fitted=lambda names: numbers,
        covariance_of=lambda names, values: np.diag((numbers / 10) ** 2),
    )
    found = SimpleNamespace(
        statistics=SimpleNamespace(of_splits=lambda splits: None),
        both=None,
        levels_of=lambda *_: levels,
    )
    named = ("crosstalk", "white_balance", "exposure")
    values = in_order(_of_levels(found, named))
    expected = {
        ("exposure", "gain"): 0.1,
        ("white_balance", "red"): 0.2,
        ("white_balance", "blue"): 0.3,
        **{("crosstalk", way): 0.2 for way in ("left", "right")},
        **{("crosstalk", way): 0.25 for way in ("up", "down")},
    }
    assert values.keys() == expected.keys()
    for key, value in expected.items():
        ends = (value, value * (1 - CI95 / 10), value * (1 + CI95 / 10))
        assert values[key] == pytest.approx(ends)


def test_what_figures_withhold_is_told_as_the_fit_has_it():
    """Deviations are roots of squares, in shares of white or relative; where a square
    may be less than none, the low end is 0."""
    fitted = {"row_noise": (9.0, 1.0), "prnu": (4e-4, 3e-4), "dark_current": (2.0, 0.5)}
    fitted["dsnu"] = (1.0, 0.1)
    found = SimpleNamespace(
        values=[SimpleNamespace(effect="dsnu")],
        captures=SimpleNamespace(sensor=SENSOR),
        both=SimpleNamespace(of=fitted.__getitem__),
    )
    values = in_order(_withheld(found, [*fitted]))
    assert values.keys() == {
        ("row_noise", "sigma"),
        ("prnu", "sigma"),
        ("dark_current", "per_second"),
    }
    rows = np.sqrt([9, 9 - CI95, 9 + CI95]) / WHITE
    assert values["row_noise", "sigma"] == pytest.approx(rows)
    prnu = (0.02, 0.0, np.sqrt(4e-4 + 3e-4 * CI95))
    assert values["prnu", "sigma"] == pytest.approx(prnu)
    rate = np.array([2, 2 - 0.5 * CI95, 2 + 0.5 * CI95]) / WHITE
    assert values["dark_current", "per_second"] == pytest.approx(rate)
    assert [*_withheld(found, [])] == []


def test_steps_between_halves_are_shares_of_white_or_of_light():
    found = SimpleNamespace(captures=SimpleNamespace(sensor=SENSOR))
    steps = {"horizontal_offset": (8.0, 1.0), "vertical_response": (0.02, 0.001)}
    values = in_order(of_amplifiers(found, steps))
    ends = np.array([8, 8 - CI95, 8 + CI95]) / WHITE
    assert values["amplifier_mismatch", "horizontal_offset"] == pytest.approx(ends)
    ends = (0.02, 0.02 - CI95 / 1000, 0.02 + CI95 / 1000)
    assert values["amplifier_mismatch", "vertical_response"] == pytest.approx(ends)


@pytest.mark.parametrize(
    ("stated", "value"), [({}, 0.2), ({"below_white": 0.05}, 0.15)]
)
def test_a_full_well_is_told_below_white_beyond_what_the_profile_states(stated, value):
    sensor = stating(SENSOR, {"full_well": stated} if stated else {})
    well = FullWell((0,), 0.8 * WHITE, 0.01 * WHITE, 99.0)
    found = SimpleNamespace(
        frames=SimpleNamespace(well=well), captures=SimpleNamespace(sensor=sensor)
    )
    [one] = _of_well(found, {"full_well"})
    ends = (value, value - 0.01 * CI95, value + 0.01 * CI95)
    assert one[2:] == pytest.approx(ends)
    assert [*_of_well(found, {"prnu"})] == []


def test_an_error_that_is_added_widens_both_ends_of_an_interval():
    """In squares, each end by its own."""
    one = Value("dsnu", "sigma", 0.02, 0.01, 0.05)
    found = _moved(one, 2 * np.array(one[2:]), 0.01)
    assert found[:3] == ("dsnu", "sigma", 0.04)
    low, high = (np.hypot(half, 0.01 * CI95) for half in (0.02, 0.06))
    assert found[3:] == pytest.approx((0.04 - low, 0.04 + high))


def test_deviations_are_told_as_they_were_before_a_stated_filter_lowered_them():
    """Of frames without repeats, which show no filter: the profile's. Factors of its
    noise have it in both."""
    single = SimpleNamespace(
        pairs=np.zeros(3, int), planes=[SimpleNamespace(shape=(40, 50))]
    )
    stated = {"noise_reduction": {"blend": 0.3, "diagonal": 0.1}}
    found = SimpleNamespace(
        statistics=SimpleNamespace(of_splits=lambda splits: single),
        captures=SimpleNamespace(sensor=stating(SENSOR, stated)),
        both=None,
        profile=None,
    )
    given = [
        Value("dsnu", "sigma", 0.02, 0.01, 0.03),
        Value("row_noise", "sigma", 0.02, 0.01, 0.03),
        Value("read_noise", "log_variance", 0.5, 0.4, 0.6),
        Value("dark_current", "per_second", 0.2, 0.1, 0.3),
    ]
    values = in_order(_before_reduction(found, [], given))
    left = variance_left(0.3, 0.1), variance_left_of_lines(0.3, 0.1), 1.0, 1.0
    for one, share in zip(given, left, strict=True):
        expected = np.array(one[2:]) / np.sqrt(share)
        assert values[one.effect, one.parameter] == pytest.approx(expected)


def test_limits_of_levels_are_the_errors_of_each_effect_alone_at_0():
    """By flats that decide, of the first parameter of each."""
    counts = {"exposure": 1, "white_balance": 2, "crosstalk": 2}

    def covariance_of(names, values):
        assert len(names) == 1 and values.tolist() == [0.0] * counts[names[0]]
        return np.diag([0.01, 0.5][: len(values)]) ** 2

    levels = SimpleNamespace(names=[*counts], covariance_of=covariance_of)
    found = SimpleNamespace(
        statistics=SimpleNamespace(of_splits=lambda splits: splits),
        selection=SimpleNamespace(validation="fit"),
        levels_of=lambda splits, fit: levels if fit == "fit" else None,
    )
    half = 0.01 * CI95
    assert in_order(limits_of_levels(found)) == {
        ("exposure", "gain"): pytest.approx((0, -half, half)),
        ("white_balance", "red"): pytest.approx((0, -half, half)),
        ("crosstalk", "left"): pytest.approx((0, -half / 2, half / 2)),
    }
    found.selection.validation = None
    assert [*limits_of_levels(found)] == []
