# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How many pixels of a dark a profile's own defects put far out."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.outliers import MOST_EXPECTED, expected_outliers
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import READ, capture_of, frames_of, sensor_of

HOT = {"name": "hot_pixels", "parameters": {"fraction": 0.02, "rate": 0.001}}
SPREAD = {
    "name": "dark_current_nonuniformity",
    "parameters": {"rate": 0.001, "log_sigma": 1.0},
}
FAR = 6 * READ


def expected(effects, seconds, kind="dark"):
    sensor = sensor_of(effects=effects)
    [frame] = frames_of(sensor, [capture_of(kind, exposure_time=seconds)])
    return expected_outliers(Model(sensor), frame) / MOST_EXPECTED


@pytest.mark.parametrize("seconds", [1.0, 10.0, 100.0])
def test_rates_of_hot_pixels_are_exponential(seconds):
    share = 0.02 * np.exp(-FAR / (0.001 * seconds))
    assert expected([HOT], seconds) == pytest.approx(share, rel=0.02)


def test_rates_of_the_others_are_log_normal():
    """By counting."""
    drawn = 0.01 * np.expm1(np.random.default_rng(1).standard_normal(400000))
    share = float(np.mean(drawn > FAR))
    assert expected([SPREAD], 10.0) == pytest.approx(share, rel=0.02)


def test_what_a_map_knows_is_not_expected():
    sensor = sensor_of(effects=[HOT, SPREAD])
    [frame] = frames_of(sensor, [capture_of("dark", exposure_time=10.0)])
    without = expected_outliers(Model(sensor), frame, [SPREAD["name"]])
    assert without / MOST_EXPECTED == pytest.approx(expected([HOT], 10.0))


def test_nothing_is_expected_without_defects_charge_or_darkness():
    assert expected([], 10.0) == 0
    assert expected([HOT, SPREAD], 0.0) == 0
    assert expected([HOT], 10.0, "flat") == 0
