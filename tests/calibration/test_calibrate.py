# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Planted numbers are found within three of their own standard errors."""

import json
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from calibration.planted import BLACK, GAIN, RANGE, READ, frames_of, sensor_of
from cg2raw.calibration import calibrate
from cg2raw.calibration.fitting import values_of
from cg2raw.calibration.flats import light_of
from cg2raw.calibration.sites import sites_of
from cg2raw.model.evaluation import Parameters

EFFECTS = {
    "row_noise": {"sigma": 1.0 / RANGE},
    "column_fixed_pattern": {"sigma": 1.5 / RANGE},
    "dsnu": {"sigma": 1.2 / RANGE},
    "prnu": {"sigma": 0.006},
    "dark_current": {"per_second": 0.4 / RANGE},
    "hot_pixels": {"fraction": 0.01, "rate": 20 / RANGE},
    "lens_shading": {
        "r2": -0.2, "r4": 0.05, "r6": 0.0, "tilt_x": 0.01, "tilt_y": 0.0,
        "tilt_x_r2": 0.0, "tilt_y_r2": 0.0,
    },
}  # fmt: skip
# What a calibration finds of the planted profile, and its truth. Fixed patterns are one
# draw of the sensor: their sample has a deviation of its own, which is in the error.
TRUTHS = {
    "black level": (lambda c: c.each("black level")[0], 256.0),
    "drift": (lambda c: c.figure("black level drift"), 0.5),
    "read noise": (lambda c: c.each("read noise")[2], READ),
    "temporal dark noise": (
        lambda c: c.each("temporal dark noise")[1],
        np.sqrt(READ**2 + 1.0**2 + 1 / 12),  # with rows' and rounding
    ),
    "row noise": (lambda c: c.figure("row noise"), 1.0),
    "column noise": (lambda c: c.figure("column noise"), 0.0),
    "correlation": (lambda c: c.figure("correlation, next in row"), 0.0),
    "kurtosis": (lambda c: c.tails.excess_kurtosis, 0.0),
    "column pattern": (lambda c: c.figure("fixed column pattern"), 1.5),
    "dsnu": (lambda c: c.figure("DSNU"), 1.2),
    "dark current": (lambda c: c.dark.rate, 0.4),
    "hot pixels": (lambda c: c.spread.fraction, 0.01),
    "hot rate": (lambda c: c.spread.hot_rate, 20.0),
    "gain": (lambda c: c.figure("gain"), GAIN),
    "prnu": (lambda c: c.figure("PRNU"), 0.006),
    "tilt": (lambda c: c.light.shading["tilt_x"], 0.01),
    "lamp": (lambda c: c.lamp, 0.002),
}
# Of a chi-square of few frames the error is lopsided.
WIDE = {"drift": 4.0, "lamp": 4.0}


@cache
def found(seed, black=BLACK):
    """Return the calibration of the planted sensor's frames. black : DN, of the profile
    that is calibrated."""
    plan = {"drift": 0.5, "lamp": 0.002, "flat_times": (0.1, 0.3, 0.6, 1.0, 1.5)}
    frames = frames_of(sensor_of(EFFECTS), seed, **plan)
    return calibrate(sensor_of(EFFECTS, black_level=[black] * 4), frames)


@pytest.mark.parametrize("name", TRUTHS)
def test_a_planted_number_is_found_within_its_error(name):
    look, truth = TRUTHS[name]
    measured = look(found(1))
    assert measured.standard_error > 0
    off = abs(measured.value - truth) / measured.standard_error
    assert off < WIDE.get(name, 3.0), measured


def test_kurtosis_is_known_by_how_many_samples_there_are():
    """24 / N is the variance of that of N of a normal, here of the differences of three
    pairs; that of one frame is twice as large."""
    known = found(1).tails.excess_kurtosis.standard_error
    assert known == pytest.approx(2 * np.sqrt(24 / (3 * 192 * 256)), rel=0.05)


def test_charge_of_darks_is_taken_off_flats():
    """Of a time between: an even light is one for all pixels, also for hot ones."""
    sensor = sensor_of(shape=(32, 48))
    rate, offset = (np.random.default_rng(n).uniform(0, 50, (32, 48)) for n in (1, 2))
    seen = SimpleNamespace(
        sites=sites_of(sensor),
        mean_over=lambda _: 256 + offset + rate * 3.0 + 4000.0,
        white=10**6,
        statistics=SimpleNamespace(excluded=None),
        time=(0.5, 3.5).__getitem__,
        shortest=[0],
    )
    darks = SimpleNamespace(offset=offset, rate=rate)
    _, response = light_of(seen, [1], np.full(4, 256.0), darks)
    assert response == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("name", ["black level", "dark current", "gain", "lamp"])
def test_a_black_level_of_the_profile_that_is_off_moves_no_number(name):
    look, _ = TRUTHS[name]
    assert look(found(1, 250.0)).value == pytest.approx(look(found(1)).value, rel=1e-6)


def test_the_profile_has_what_was_planted_and_nothing_else():
    profile = json.loads(found(1).updated_profile())
    effects = {e["name"]: e["parameters"] for e in profile["effects"]}
    assert set(effects) - {"black_level_drift"} == set(EFFECTS)
    assert effects["dsnu"]["sigma"] * RANGE == pytest.approx(1.2, rel=0.03)
    row = profile["noise"][0]
    # beta2 is of pixels alone: rows' noise, 1 DN of 3, would add 11 % to it.
    assert row["beta2"][2] * RANGE**2 == pytest.approx(READ**2, rel=0.03)
    assert row["beta1"][2] * RANGE == pytest.approx(1 / GAIN, rel=0.03)


@pytest.mark.parametrize(
    ("cfa", "names"),
    [
        ("RGGB", ["R", "Gr", "Gb", "B"]),
        ("GBRG", ["Gb", "B", "R", "Gr"]),
        ("MONO", [""]),
    ],
)
def test_names_of_sites(cfa, names):
    assert [*sites_of(SimpleNamespace(cfa=cfa)).names] == names


def test_a_sensor_without_effects_gets_none():
    sensor = sensor_of()
    profile = json.loads(calibrate(sensor, frames_of(sensor)).updated_profile())
    assert profile["effects"] == []


def test_rows_of_noise_that_say_their_shape_keep_it():
    """beta2 has rows' noise in it then, and rows of other ISOs stay."""
    shape = {"tukey_lambda": 0.1, "row_sigma": 0.0}
    betas = {"beta1": [1 / (GAIN * RANGE)] * 4, "beta2": [(READ / RANGE) ** 2] * 4}
    noise = [{"iso": iso, **betas, **shape} for iso in (100.0, 400.0)]
    sensor = sensor_of({"row_noise": EFFECTS["row_noise"]}, noise=noise)
    found = calibrate(sensor, frames_of(sensor, darks=0))
    profile = json.loads(found.updated_profile())
    new, old = profile["noise"]
    assert profile["effects"] == []
    assert new["row_sigma"] * RANGE == pytest.approx(1.0, rel=0.1)
    both = np.hypot(READ, 1.0)
    assert np.sqrt(new["beta2"][1]) * RANGE == pytest.approx(both, rel=0.02)
    assert old["tukey_lambda"] == 0.1 and old["iso"] == 400


@pytest.mark.parametrize("iso", [100.0, 400.0])
def test_noise_that_no_dark_shows_is_that_of_the_iso(iso):
    betas = {"beta1": [1e-4] * 4}
    noise = [{"iso": n, **betas, "beta2": [n * 1e-9] * 4} for n in (100.0, 400.0)]
    seen = SimpleNamespace(sensor=sensor_of(noise=noise))
    found = values_of(seen, np.full(4, 256.0), iso, "", 1, 0)
    at = Parameters(4).of("read_noise")
    assert found[at] == pytest.approx(iso * 1e-9 * RANGE**2)


@pytest.mark.slow
def test_errors_are_what_they_say():
    """Over sensors and frames, 95 % of the truths lie within 1.96 standard errors: of
    16 numbers and 24 sensors, some of them bound to each other, within 3 % of that."""
    offs = []
    plan = {"drift": 0.5, "lamp": 0.002, "flat_times": (0.1, 0.3, 0.6, 1.0, 1.5)}
    for seed in range(1, 25):
        sensor = sensor_of(EFFECTS, id=f"planted-{seed}")
        calibration = calibrate(sensor, frames_of(sensor, seed, **plan))
        for look, truth in TRUTHS.values():
            measured = look(calibration)
            if measured is None and truth == 0:
                continue  # less than none was measured
            offs.append((measured.value - truth) / measured.standard_error)
    assert 0.9 < np.mean(np.abs(offs) < 1.96) < 0.985
    assert 0.8 < np.std(offs) < 1.2
