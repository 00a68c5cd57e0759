# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Structure of the bias, drift, spread of dark current, glow, correlation: planted
together, found one by one, and written into the profile."""

import json

import pytest

from calibration.planted import RANGE, frames_of, sensor_of
from cg2raw.calibration import calibrate

EFFECTS = {
    "bias_structure": {
        "horizontal": 4 / RANGE,
        "vertical": -2 / RANGE,
        "edge": 12 / RANGE,
        "edge_length": 12.0,
    },
    "black_level_drift": {"sigma": 0.6 / RANGE},
    "column_fixed_pattern": {"sigma": 0.5 / RANGE},
    "row_noise": {"sigma": 0.3 / RANGE},
    "read_noise_correlation": {"coefficient": -0.07},
    "dark_current": {"per_second": 0.8 / RANGE},
    "dark_current_nonuniformity": {"rate": 0.6 / RANGE, "log_sigma": 0.8},
    "hot_pixels": {"fraction": 0.005, "rate": 40 / RANGE},
    "amplifier_glow": {
        "per_second": 1.5 / RANGE, "row": 1.0, "column": -1.0, "extent": 0.15,
    },
}  # fmt: skip
# Relative, beyond three standard errors of the samples of 190 x 256 pixels, 10 biases
# and 8 darks: the drift of 10 frames is known to a quarter, columns' edge to a tenth.
TOLERANCE = {"sigma": 0.5, "edge_length": 0.3, "fraction": 0.2}


@pytest.fixture(scope="module")
def found():
    """Return {effect: parameters} of the profile that all of EFFECTS are found in."""
    sensor = sensor_of(EFFECTS)
    calibration = calibrate(sensor, frames_of(sensor, biases=10, darks=8, flats=4))
    profile = json.loads(calibration.updated_profile())
    return {e["name"]: e["parameters"] for e in profile["effects"]}


@pytest.mark.parametrize("name", EFFECTS)
def test_each_is_found_among_all(found, name):
    for parameter, truth in EFFECTS[name].items():
        most = TOLERANCE.get(parameter, 0.15)
        assert found[name][parameter] == pytest.approx(truth, rel=most), parameter


def test_nothing_else_is_found(found):
    assert set(found) == set(EFFECTS)
