# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Lenses and noise that others measured, hidden in captures and found again."""

import csv
import gzip
from dataclasses import replace

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose import diagnose
from cg2raw.synthetic.captures import simulate_captures
from cg2raw.synthetic.measured import (
    Measured,
    ReadNoise,
    gain_map_transmission,
    polynomial_transmission,
)
from cg2raw.synthetic.sensors import drawn_sensor
from diagnose.planted import changed

SHAPE = (112, 144)
LARGEST = 8.0  # coefficient that lens_shading may have
EDGE = 8  # pixels along the edges of a frame that the diagnosis leaves out
LEAST_FALL_OFF = 0.002  # rms over the frame, that small frames must show
HERO6 = "real/Hero6_GOPR0024.dng"
# Cameras of Wei et al., CVPR 2020: their profiles hold lambda and the row noise.
ELD = ("canon-5d-mark-iv", "canon-70d", "canon-700d", "nikon-d850", "sony-a7s-ii")
PIXELS = (
    ("hg-Pixel6_1x_ProShot-v7_Ali", 3199),
    ("hg-Pixel9Pro_1x_ProShot-v7_Ali", 3199),
    ("hg-Pixel9Pro_3x_ProShot-v7_Ali", 785),
)


def names_of(found):
    return {finding.name for finding in found.effects}


def field_of(sensor, bare, shape):
    """Return the (H, W) factor between two sensors' pictures of a grey wall."""
    grey = np.full((*shape, 3), 0.2, np.float32)
    lit, plain = (s.predict(grey, illuminant="D65")[0] for s in (sensor, bare))
    return lit / plain


def rms_errors(found, sensor, hidden):
    """Return relative rms errors of the field: where it was looked at, and in all."""
    new = cg2raw.Sensor.from_json(found.profile_json, "found")
    error = field_of(new, sensor, hidden.shape) / hidden - 1
    seen = error[EDGE:-EDGE, EDGE:-EDGE]
    return float(np.sqrt(np.mean(seen**2))), float(np.sqrt(np.mean(error**2)))


def lensfun(folder):
    """Return [(k1, k2, k3)] of lensfun's table that are no artefacts of a fit."""
    with gzip.open(folder / "tables/lens/lensfun_vignetting_pa.csv.gz", "rt") as file:
        rows = [
            [float(row[k]) for k in ("k1", "k2", "k3")] for row in csv.DictReader(file)
        ]
    return [row for row in rows if polynomial_transmission(row, (48, 64)).min() > 0]


@pytest.mark.slow
def test_the_gain_map_of_a_hero6(camera_data):
    """Its 23 x 23 points are no polynomial: the nearest of ours, by squares, is 0.3 %
    rms off, most of it in the very corners, and 1.1 % if it sees no more than the
    diagnosis does."""
    maps = cg2raw.read_dng_metadata(str(camera_data / HERO6)).gain_maps
    assert len(maps) == 4 and np.shape(maps[0]["gains"]) == (23, 23)
    shape = (144, 192)
    hidden = gain_map_transmission(maps, 4, shape)
    sensor = changed("gopro-hero6-black", effects=[])
    captures = simulate_captures(
        sensor, {}, seed=3, shape=shape, measured=Measured(transmission=hidden)
    )
    found = diagnose(captures, details=False)
    assert found.verdict in ("explained", "partially_explained")
    assert names_of(found) <= {"lens_shading", "color_shading"} and found.effects
    seen, whole = rms_errors(found, sensor, hidden)
    print(f"rms {seen:.4f} where looked at, {whole:.4f} in all")
    assert seen < 0.004 and whole < 0.011
    assert found.gap.after < 1e-3 * found.gap.before


@pytest.mark.slow
@pytest.mark.parametrize("number", range(50))
def test_fall_offs_of_lensfun(camera_data, number):
    within = [row for row in lensfun(camera_data) if np.abs(row).max() < LARGEST]
    row = within[np.random.default_rng([550, number]).integers(len(within))]
    hidden = polynomial_transmission(row, SHAPE)
    sensor = drawn_sensor(number)
    captures = simulate_captures(
        sensor, {}, seed=number, shape=SHAPE, measured=Measured(transmission=hidden)
    )
    found = diagnose(captures, details=False)
    if hidden.std() < LEAST_FALL_OFF:  # may be missed, not misnamed
        assert names_of(found) <= {"lens_shading"}
        return
    assert (found.verdict, names_of(found)) == ("explained", {"lens_shading"})
    seen, whole = rms_errors(found, sensor, hidden)
    print(f"corner loss {1 - hidden[0, 0]:.3f}: rms {seen:.5f}, {whole:.5f} in all")
    assert whole < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("camera", ELD)
def test_read_noise_of_the_eld_cameras(camera):
    """Tukey-lambda read noise, row noise and photons that are counted, against a
    Gaussian profile of the same variance."""
    row = next(r for r in cg2raw.Sensor(camera).noise if r["iso"] == 1600)
    plain = {k: row[k] for k in ("iso", "beta1", "beta2")}
    sensor = changed(camera, noise=[plain], effects=[])
    read = np.sqrt(row["beta2"][0])
    share = row["row_sigma"] / read
    noise = ReadNoise(row["tukey_lambda"], np.sqrt(1 - share**2), share)
    hidden = {"poisson_shot_noise": {"photons_are_counted": 1.0}}
    captures = simulate_captures(
        sensor, hidden, seed=5, shape=(160, 216), iso=1600,
        measured=Measured(read_noise=noise), twice=True,
    )  # fmt: skip
    found = diagnose(captures, details=False)
    by_name = {finding.name: finding for finding in found.effects}
    print(camera, found.verdict, list(by_name), [t.name for t in found.unexplained])
    heavy = {"heavy_tailed_noise"} if row["tukey_lambda"] < 0 else set()
    assert {"row_noise", *heavy} <= set(by_name)
    assert set(by_name) <= {"heavy_tailed_noise", "row_noise", "poisson_shot_noise"}
    sigma = by_name["row_noise"].parameters["sigma"]
    assert sigma.value == pytest.approx(row["row_sigma"], rel=0.25)
    # Two Gaussians have no tails as far out as these.
    assert {test.name for test in found.unexplained} <= {"kurtosis"}


def pixel_noise(folder, model, iso):
    """Return a noise row of variance b1 DN + b2, DN with the black level of 64."""
    black, span = 64, 1023 - 64
    with open(folder / "tables/noise/samsung_pixel_model_params.csv") as file:
        every = csv.DictReader(file)
        rows = [r for r in every if (r["model"], r["iso"]) == (model, str(iso))]
    rows.sort(key=lambda row: int(row["bayer_pos_00_01_10_11"]))
    slope = np.array([float(row["beta1_DN"]) for row in rows])
    offset = np.array([float(row["beta2_DN2"]) for row in rows])
    beta2 = (slope * black + offset) / span**2
    return {"iso": iso, "beta1": list(slope / span), "beta2": list(beta2)}


@pytest.mark.slow
@pytest.mark.parametrize(("model", "iso"), PIXELS)
def test_a_pixels_noise_against_that_of_an_s20(camera_data, model, iso):
    """Its read noise differs from site to site, which one number cannot say."""
    true = pixel_noise(camera_data, model, iso)
    doubted = cg2raw.Sensor("samsung-s20fe")
    assert doubted.black_level[0] == 64 and doubted.white_level == 1023
    frames = simulate_captures(
        changed("samsung-s20fe", noise=[true]), {}, seed=8, shape=SHAPE, iso=iso
    )
    found = diagnose(replace(frames, sensor=doubted), details=False)
    assert names_of(found) == {"shot_noise", "read_noise"}
    values = {f.name: next(iter(f.parameters.values())).value for f in found.effects}
    told = doubted.noise_at(iso)
    gain = np.log(np.divide(true["beta1"], told["beta1"]))
    excess = np.log(np.divide(true["beta2"], told["beta2"]))
    print(model, values, gain, excess)
    assert values["shot_noise"] == pytest.approx(gain.mean(), abs=0.02)
    assert excess.min() < values["read_noise"] < excess.max()
    of_noise = {"channel variance", "variance by level", "variance by radius"}
    left = {test.name for test in found.unexplained}
    assert left <= {*of_noise, "chi-square of whole frames"}
