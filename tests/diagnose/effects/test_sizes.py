# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sizes of effects on a sensor are those that the registry's physics gives."""

import re

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.catalogue import effect
from cg2raw.diagnose.effects.lens_shading import CORNERS, corner_losses
from cg2raw.diagnose.scenes.predict import predict
from diagnose.planted import (
    FULL_WELL,
    capture_of,
    frames_of,
    model_of,
    sensor_of,
    stating,
)

# Of a lens that is not round.
SHADING = (-0.2, 0.05, -0.03, 0.04, -0.02, 0.03, 0.01, *np.linspace(-0.05, 0.06, 20))


def estimates(name, values, half=0.0):
    """Return estimates of an effect's parameters."""
    return {
        parameter: Estimate(value, "1", (value - half, value + half))
        for parameter, value in zip(effect(name).parameters, values, strict=True)
    }


@pytest.mark.parametrize("shape", [(400, 600), (480, 640), (600, 400)])
def test_the_corners_are_as_dark_as_predicted(shape):
    sensor = sensor_of()
    [frame] = frames_of(sensor, [capture_of("flat", shape=shape)], pixels=10**6)
    ratio = predict(model_of(sensor, lens_shading=SHADING), frame).mean[0]
    ratio = ratio / predict(model_of(sensor), frame).mean[0]
    ends = [ratio[row, col] for row in (0, -1) for col in (0, -1)]
    losses = corner_losses(estimates("lens_shading", SHADING), shape)
    # A corner's pixel lies half a pixel inside it, which is 0.2 % of the way.
    np.testing.assert_allclose(1 - np.array(ends), losses, atol=3e-3)


def test_all_four_corners_are_said():
    sensor = Sensor("nikon-d40")
    values = estimates("lens_shading", SHADING)
    words = effect("lens_shading").size_on(values, sensor)
    assert [corner in words for corner in CORNERS] == [True] * 4
    losses = corner_losses(values, (sensor.height, sensor.width))
    found = [float(text) / 100 for text in re.findall(r"(-?[\d.]+) %", words)]
    assert found == pytest.approx(losses, rel=0.005)


def test_offsets_are_said_in_dn():
    sensor = sensor_of()
    span = sensor.white_level - sensor.black_level[0]
    values = estimates("black_level", (0.01, -0.02, 0.0, 0.005), half=0.001)
    words = effect("black_level").size_on(values, sensor)
    numbers = [float(text) for text in re.findall(r"[RGB] ([+-][\d.]+) DN", words)]
    assert numbers == pytest.approx(np.array([0.01, -0.02, 0, 0.005]) * span, rel=1e-3)
    assert f"({0.009 * span:.4g} to {0.011 * span:.4g})" in words


@pytest.mark.parametrize(
    ("gains", "words"),
    [
        ({"r2": 0.08}, ["gains", "8 %"]),
        ({"r2": -0.08}, ["loses", "8 %"]),
        ({"r2": 0.01, "tilt_x": 0.05}, ["loses", "-5.16 %", "a corner gains"]),
    ],
)
def test_corners_that_are_brighter_than_the_middle_gain(gains, words):
    """No corner is told a loss of minus something where all of them gain."""
    zeros = dict.fromkeys(effect("lens_shading").parameters, 0.0)
    values = estimates("lens_shading", ({**zeros, **gains}).values())
    said = effect("lens_shading").size_on(values, sensor_of(width=600, height=400))
    assert [word in said for word in words] == [True] * len(words), said
    assert ("-" in said) == ("a corner gains" in words), said
    assert [corner in said for corner in CORNERS] == [True] * 4


OF_WHITE = {
    "dsnu": "sigma",
    "column_fixed_pattern": "sigma",
    "row_noise": "sigma",
    "black_level_drift": "sigma",
    "amplifier_glow": "per_second",
    "amplifier_mismatch": "horizontal_offset",
    "random_telegraph_noise": "amplitude",
    "dark_current_nonuniformity": "rate",
}


@pytest.mark.parametrize("name", OF_WHITE)
def test_shares_of_white_are_said_in_dn_and_electrons(name):
    sensor, several = sensor_of(), Sensor("canon-70d")
    values = {OF_WHITE[name]: Estimate(2e-4, "1", (1e-4, 3e-4))}
    for camera, electrons in ((sensor, f" ({2e-4 * FULL_WELL:.3g} e-)"), (several, "")):
        dn = 2e-4 * (camera.white_level - camera.black_level[0])
        words = effect(name).size_on(values, camera)
        assert f"{dn:.3g} DN{electrons}" in words and "of white" not in words


def test_what_the_profile_says_stands_beside_it():
    values = {"sigma": Estimate(0.006, "1", (0.005, 0.007))}
    sensor = stating(sensor_of(), {"prnu": {"sigma": 0.004}})
    assert effect("prnu").size_on(values, sensor) == (
        "standard deviation 0.6 % of the signal; by the profile, standard deviation "
        "0.4 % of the signal"
    )


def test_gains_of_pixels_are_no_share_of_white():
    values = {"sigma": Estimate(0.006, "1", (0.005, 0.007))}
    said = effect("prnu").size_on(values, sensor_of())
    assert said == "standard deviation 0.6 % of the signal"


@pytest.mark.parametrize(("ring", "percent"), [(1, 90), (2, 80), (4, 100), (9, 90)])
def test_a_blur_is_said_by_the_contrast_of_its_cosines(ring, percent):
    """1 + a (cos(n pi / 2) - 1) at half the Nyquist frequency, a of 0.1."""
    values = dict.fromkeys(effect("blur").parameters, Estimate(0.0, "1", (0.0, 0.0)))
    values[f"ring_{ring}"] = Estimate(0.1, "1", (0.1, 0.1))
    assert f"is {percent} %" in effect("blur").size(values)


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("exposure", {"gain": -0.05}, "5 % darker"),
        ("lens_distortion", {"r2": 1.0, "r4": -0.3}, "0.7 px at the corner, as by a b"),
        ("lens_distortion", {"r2": -1.0}, "moved 1 px at the corner, as by a pin"),
        (
            "lateral_chromatic_aberration",
            {"red": 0.5, "red_r2": 0.25, "blue": -0.4, "blue_r2": -0.1},
            "red is moved 0.75 px and blue -0.5 px",
        ),
        ("crosstalk", {"red": 0.01, "green": 0.02, "blue": 0.03}, "loses 6 %"),
        ("veiling_glare", {"uniform": 0.03, "wide": 0.02}, "5 % of the light"),
        ("nonlinearity", {"quadratic": 0.06, "cubic": 0.02}, "reads 8 % too low"),
        ("nonlinearity", {"quadratic": -0.06, "cubic": 0.02}, "reads 4 % too high"),
        ("shot_noise", {"log_gain": np.log(2)}, "is 2 times the profile's (2 to 2)"),
        ("pdaf_pixels", {"gain": -0.1, "pitch": 9.0}, "lack 10 % of the light"),
        ("pdaf_pixels", {"gain": 0.1, "pitch": 9.0}, "have 10 % more of the light"),
        ("dark_current_nonuniformity", {"log_sigma": np.log(2)}, "by a factor 2"),
        ("mains_flicker", {"amplitude": 0.02, "period": 37.0}, "2 % of the light, one"),
        ("mains_flicker", {"amplitude": 0.02, "period": 37.0}, "one wave in 37 rows"),
        (
            "hot_pixels",
            {"fraction": 0.01, "rate": 0.01},
            "1 % of the pixels are hot, by 161 DN (50 e-) per second",
        ),
        (
            "random_telegraph_noise",
            {"fraction": 0.02, "amplitude": 0.01},
            "2 % of the pixels jump by 161 DN (50 e-)",
        ),
        ("full_well", {"below_white": 0.2}, "charge clips 20 % below white"),
        ("read_noise_correlation", {"coefficient": 0.25}, "correlation 0.25 (0.25 to"),
        (
            "dust",
            {"density": 3.0, "depth": 0.05, "radius": 4.0},
            "3 spots per megapixel take 5 % of the light, of a radius of 4 px",
        ),
        (
            "amplifier_glow",
            {"per_second": 0.01, "row": -1.0, "column": 0.5, "extent": 0.25},
            "161 DN (50 e-) per second at row -1.00, column +0.50",
        ),
        (
            "amplifier_mismatch",
            {"vertical_offset": 0.01, "vertical_response": 0.02},
            "lower half less the upper: 161 DN (50 e-) of black level and 2 % of resp",
        ),
    ],
)
def test_sizes_are_said_with_their_direction(name, values, words):
    """Of 161.27 DN and 50 electrons to a hundredth of white."""
    known = {one: Estimate(x, "1", (x, x)) for one, x in values.items()}
    assert words in effect(name).size_on(known, sensor_of())


@pytest.mark.parametrize(
    ("rate", "words"), [(0.04, "12.0 K warmer"), (0.005, "6.0 K colder"), (0, None)]
)
def test_dark_current_is_said_as_a_difference_of_temperature(rate, words):
    """From the profile's 0.01 of white a second; twice as much every 6 K."""
    sensor = stating(sensor_of(), {"dark_current": {"per_second": 0.01}})
    values = {"per_second": Estimate(rate, "1/s", (rate, rate))}
    said = effect("dark_current").size_on(values, sensor)
    assert words in said if words else "K" not in said
    assert "K" not in effect("dark_current").size_on(values, sensor_of())
