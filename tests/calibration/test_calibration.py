# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is measured goes into the profile in the profile's units."""

import json

import numpy as np
import pytest

from calibration.planted import ISO, WHITE, sensor_of
from calibration.test_table import figure
from cg2raw.calibration.calibration import Calibration
from cg2raw.calibration.fitting import Fitted
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.sites import sites_of
from cg2raw.calibration.structure import BiasStructure
from cg2raw.normal import CI95

SENSOR = sensor_of()
WIDTH = 200  # px
LEVELS, READ = np.array([260.0, 261.0, 262.0, 265.0]), 4.0  # DN, of the sites
GAINS, RANGE = np.array([2.0, 2.1, 2.2, 2.3]), WHITE - 262.0  # e-/DN, DN


def profile_of(structure=None, read=READ, lost="", **figures):
    """Return (profile, calibration) of levels, gain and noise of each site, and of
    figures, name -> (value, error). read : DN; 0 of noise that was not measured."""
    own = {"black level": LEVELS, "gain": GAINS, "read noise": 4 * [read]}
    units = {"gain": "e-/DN", "PRNU": "1"}
    each = [
        figure(name, units.get(name, "DN"), value, value / 100, site)
        for name, values in own.items()
        for site, value in enumerate(values)
        if value
    ]
    each += [figure(name, units.get(name, "DN"), *one) for name, one in figures.items()]
    found = Calibration(
        sensor=SENSOR,
        sites=sites_of(SENSOR),
        shape=(100, WIDTH),
        iso=ISO,
        frames=(3, 2),
        fit=Fitted(each, lost=lost),
        structure=structure,
    )
    return json.loads(found.updated_profile()), found


@pytest.mark.parametrize(
    ("given", "beta2"),
    [
        ({}, (READ / RANGE) ** 2),
        ({"read": 0.0}, SENSOR.noise_at(ISO)["beta2"][0]),
        ({"read": 0.0, "lost": "coarse"}, 0.0),
    ],
)
def test_noise_is_in_shares_of_white_above_the_mean_black_level(given, beta2):
    """Read noise that was not measured is the profile's, unless codes hide it."""
    profile, _ = profile_of(**given)
    (row,) = [row for row in profile["noise"] if row["iso"] == ISO]
    assert row["beta1"] == pytest.approx(1 / GAINS / RANGE, rel=1e-5)
    assert row["beta2"] == pytest.approx(4 * [beta2], rel=1e-5)
    assert profile["black_level"] == pytest.approx(LEVELS)
    assert "3 darks and 2 flats" in profile["sources"]["noise"]


def test_an_effect_has_its_interval_and_is_within_the_registrys_bounds():
    """A deviation of 4 +- 0.2 DN; PRNU at its bound is left out with a note."""
    profile, found = profile_of(DSNU=(4.0, 0.2), PRNU=(0.2, 0.01))
    [effect] = profile["effects"]
    assert effect["name"] == "dsnu"
    assert effect["parameters"]["sigma"] == pytest.approx(4 / RANGE, rel=1e-5)
    ends = np.array([4 - 0.2 * CI95, 4 + 0.2 * CI95]) / RANGE
    assert effect["ci95"]["sigma"] == pytest.approx(ends, rel=1e-5)
    [note] = found.profile_notes()
    assert note.startswith("prnu: sigma is 0.2; must be between 0 and 0.2")


def test_the_black_level_is_without_first_columns_that_an_effect_adds():
    """Their mean over the columns, of 12 DN that fall by e in 10 px."""
    none = Measured(0.0, 1.0, "DN")
    edge, length = Measured(12.0, 0.5, "DN"), Measured(10.0, 0.5, "px")
    profiles = 4 * [np.zeros(WIDTH)]
    profile, _ = profile_of(BiasStructure(none, none, edge, length, *profiles))
    [effect] = profile["effects"]
    assert effect["parameters"]["edge"] == pytest.approx(12 / RANGE, rel=1e-5)
    mean = 12 * np.exp(-np.arange(WIDTH) / 10).mean()
    assert profile["black_level"] == pytest.approx(LEVELS - mean, rel=1e-5)
