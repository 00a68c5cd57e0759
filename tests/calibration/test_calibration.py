# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is measured goes into the profile in the profile's units."""

import json
from dataclasses import replace

import numpy as np
import pytest

from calibration import planted
from calibration.planted import ISO, WHITE, sensor_of
from calibration.test_bounds import found_with
from calibration.test_table import GLOW, TAILS, figure, structure
from cg2raw.calibration.calibration import Calibration, effects_found
from cg2raw.calibration.darks import DarkCurrent
from cg2raw.calibration.fitting import Fitted
from cg2raw.calibration.flats import (
    AT_WHITE,
    FULL_WELL,
    Light,
    Linearity,
    PhotonTransfer,
)
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.sites import Sites, sites_of
from cg2raw.calibration.structure import BiasStructure, Glow
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


def dark(rate):
    """Return a dark current that is known to 0.1 DN/s, and where a glow of 0.25 DN/s in
    the mean, of 2 DN/s at its place, is part of it."""
    line = DarkCurrent(((None, Measured(rate, 0.1, "DN/s")),), None, ())
    return {"dark": line, "glow": Glow(PER_SECOND, *GLOW, 0.1, 0.25, 20.0)}


def bent(bend, error=0.001):
    """Return linearity with such a bend, and losses of 2 and 1 % with such an error."""
    losses = (Measured(loss, error, "1") for loss in (0.02, 0.01))
    return {"linearity": Linearity(ZERO, *losses, bend, np.ones(3), np.zeros(3))}


def full(clipped_by):
    """Return saturation of 12,000 DN."""
    level = Measured(12_000.0, 5.0, "DN")
    return {"transfer": PhotonTransfer([], level, clipped_by)}


def shaded(fall_off):
    """Return light that falls off so much, known to a hundredth of that."""
    rms = Measured(fall_off, fall_off / 100, "1")
    return {"light": Light({"r2": PER_SECOND}, rms, 0.0, np.ones((2, 2)))}


def next_in_row(value):
    """Return a correlation, known to 0.001."""
    one = figure("correlation, next in row", "1", value, 0.001)
    return {"fit": Fitted([one])}


ZERO, PER_SECOND = Measured(0.0, 0.1, "%"), Measured(2.0, 0.1, "DN/s")
UNIT = 1 / planted.RANGE
NORMAL = replace(TAILS, excess_kurtosis=None, tukey_lambda=None)
AROUND = {"row": -1.0, "column": 0.5, "extent": 0.25}


@pytest.mark.parametrize(
    ("fields", "name", "values"),
    [
        (
            {"structure": structure(9.0)},
            "bias_structure",
            {"horizontal": 2 * UNIT, "vertical": 2 * UNIT, "edge": 5 * UNIT}
            | {"edge_length": 9.0},
        ),
        (
            {"structure": structure(50.0)},  # as long as any that is tried
            "bias_structure",
            {"horizontal": 2 * UNIT, "vertical": 2 * UNIT},
        ),
        (dark(1.0), "dark_current", {"per_second": 0.75 * UNIT}),
        (dark(0.2), "dark_current", None),
        (dark(1.0), "amplifier_glow", {"per_second": 2 * UNIT, **AROUND}),
        (bent(0.005), "nonlinearity", {"quadratic": 0.02, "cubic": 0.01}),
        (bent(0.0049), "nonlinearity", None),  # lamps and shutters may
        (bent(0.01, error=0.01), "nonlinearity", None),
        (full(FULL_WELL), "full_well", {"below_white": 1 - 12_000 * UNIT}),
        (full(AT_WHITE), "full_well", None),
        ({"sites": Sites(("",), step=4)}, "quantisation", {"step": 4 * UNIT}),
        ({}, "quantisation", None),
        (shaded(0.0011), "lens_shading", {"r2": 2.0}),
        (shaded(0.0009), "lens_shading", None),  # no lamp is flatter
        (next_in_row(-0.006), "read_noise_correlation", {"coefficient": -0.006}),
        (next_in_row(0.0049), "read_noise_correlation", None),
    ],
)
def test_what_stands_out_is_an_effect_in_units_of_the_signal(fields, name, values):
    found = effects_found(found_with(**fields), False)[name]
    if values is None:
        assert found is None
    else:
        numbers = {key: getattr(one, "value", one) for key, one in found.items()}
        assert numbers == pytest.approx(values)


@pytest.mark.parametrize(
    ("fields", "note"),
    [
        ({"tails": TAILS}, "(excess kurtosis 3.00, Tukey lambda -0.20)"),
        ({"fit": [figure("gain", "e-/DN", 2.0, 0.1)]}, "give darks, too"),
        ({"fit": [figure("read noise", "DN", 2.0, 0.1)]}, "give flats, too"),
        (
            {"fit": [figure("read noise", "DN", 2.0, 0.1)], "lost": "cut"},
            "give flats of several levels from faint ones on, too",
        ),
    ],
)
def test_what_cannot_be_written_into_a_profile_is_said(fields, note):
    """Of a sensor whose profile has no noise."""
    fields = {"fit": [], "lost": "", **fields}
    fit = Fitted(fields.pop("fit"), lost=fields.pop("lost"))
    sensor = sensor_of(noise=[])
    [said] = found_with(sensor=sensor, iso=ISO, fit=fit, **fields).profile_notes()
    assert note in said


@pytest.mark.parametrize(
    ("tails", "row_sigma", "tukey_lambda"),
    [
        (replace(TAILS, tukey_lambda=0.12), 2.0 * UNIT, 0.12),
        (NORMAL, 2.0 * UNIT, 0.14),  # as nothing else is known
        (None, 0.0005, 0.1),  # as before
    ],
)
def test_rows_of_noise_that_say_their_shape_have_it_in_shares_of_white(
    tails, row_sigma, tukey_lambda
):
    """beta2 has rows' noise in it, which is no effect; nor is a black level then."""
    row = {"beta1": [1e-4] * 4, "beta2": [1e-6] * 4}
    row |= {"tukey_lambda": 0.1, "row_sigma": 0.0005}
    levels = {f"offset_{site}": 0.01 for site in ("00", "01", "10", "11")}
    effects = {"black_level": levels, "row_noise": {"sigma": 0.01}}
    noise = [{"iso": iso, **row} for iso in (ISO, 4 * ISO)]
    sensor = sensor_of(effects, noise=noise, sources={"noise": "a paper"})
    measured = [("black level", 256.0), ("read noise", 4.0), ("row noise", 2.0)]
    figures = [figure(name, "DN", value, value / 100) for name, value in measured]
    fit = Fitted([*figures, figure("gain", "e-/DN", 2.0, 0.1)])
    found = found_with(sensor=sensor, iso=ISO, dark=None, fit=fit, tails=tails)
    profile = json.loads(found.updated_profile())
    new, old = profile["noise"]
    assert (new["row_sigma"], new["tukey_lambda"]) == (
        pytest.approx(row_sigma, rel=1e-5),
        tukey_lambda,
    )
    assert new["beta1"] == pytest.approx([UNIT / 2] * 4, rel=1e-5)
    assert new["beta2"] == pytest.approx([16 * UNIT**2 + row_sigma**2] * 4, rel=1e-5)
    assert (old["iso"], old["beta1"]) == (4 * ISO, row["beta1"])
    assert profile["effects"] == []
    words = profile["sources"]["noise"]
    assert words.startswith("ISO 100: cg2raw calibrate (EMVA 1288 R4.0): 4 darks and 0")
    assert words.endswith("; other ISOs: a paper")
