# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""transform.h: both conventions and the highlights, against their oracles."""

import numpy as np
import pytest

import cg2raw
from oracles import adobe, cameras, dng_convention, paper

FULL_SCALE = 2e-6  # float32 pixels: 17 units of rounding at 1
D40 = cameras.oracle("NikonD40")
# The last one is red enough for R/G above 1.
LIGHTS = ("A", "3200K", "5000K", "D65", "neutral:0.38:0.79", "neutral:1.2:0.25")


def sensor_of(camera, **fields):
    return cg2raw.Sensor.from_json(cameras.profile_of(camera, **fields))


@pytest.fixture(scope="module")
def sensor():
    return sensor_of("NikonD40")


@pytest.fixture(scope="module")
def scene():
    """Colours (40, 50, 3): dark to far above white, some outside sRGB."""
    rng = np.random.default_rng(11)
    rgb = rng.uniform(0.0, 1.0, (40, 50, 3)) * 2.0 ** rng.uniform(-8, 3, (40, 50, 1))
    rgb[::7] -= 0.1
    rgb[3, :, :] = np.linspace(0.0, 2.0, 50)[:, None]
    return rgb.astype(np.float32)


def neutral_of(sensor, spec):
    return np.array(sensor.illuminant(spec).neutral)


@pytest.mark.parametrize("highlights", [True, False])
@pytest.mark.parametrize("spec", LIGHTS)
@pytest.mark.parametrize("camera", cameras.NINE)
def test_dng_convention_equals_the_oracle(camera, spec, highlights, scene):
    sensor, oracle = sensor_of(camera), cameras.oracle(camera)
    seen = sensor.to_camera(scene, illuminant=spec, highlights=highlights)
    expected = dng_convention.camera_rgb(
        scene, oracle, neutral_of(sensor, spec), keep_highlights=highlights
    )
    assert seen.dtype == np.float32 and seen.shape == scene.shape
    assert np.abs(seen - expected).max() < FULL_SCALE


def test_with_forward_matrices_the_inverse_of_that_path(scene):
    rows = np.array([[0.70, 0.20, 0.064], [0.28, 0.80, -0.08], [0.02, -0.10, 0.905]])
    # Each row's sum stays: white is D50.
    warm, cool = rows + 0.02 * (np.eye(3) - np.roll(np.eye(3), 1, axis=1)), rows
    fields = {
        "forward_matrix_1": warm.ravel().tolist(),
        "forward_matrix_2": cool.ravel().tolist(),
    }
    sensor = sensor_of("NikonD40", **fields)
    for spec in LIGHTS:
        neutral = neutral_of(sensor, spec)
        weight = D40.warm_weight(D40.xy_from_neutral(neutral)[0])
        forward = weight * warm + (1.0 - weight) * cool
        seen = sensor.to_camera(scene, illuminant=spec)
        expected = dng_convention.camera_rgb(scene, D40, neutral, forward=forward)
        assert np.abs(seen - expected).max() < FULL_SCALE


@pytest.mark.parametrize("spec", LIGHTS)
def test_white_is_the_neutral_over_its_maximum(sensor, spec):
    white = np.ones((1, 1, 3), np.float32)
    neutral = neutral_of(sensor, spec)
    seen = sensor.to_camera(white, illuminant=spec, highlights=False)[0, 0]
    assert seen == pytest.approx(neutral / neutral.max(), abs=FULL_SCALE)
    assert seen.max() == pytest.approx(1.0, abs=FULL_SCALE)


def test_grey_keeps_the_neutral(sensor):
    grey = np.full((1, 1, 3), 0.18, np.float32)
    neutral = neutral_of(sensor, "A")
    seen = sensor.to_camera(grey, illuminant="A")[0, 0]
    assert seen == pytest.approx(0.18 * neutral / neutral.max(), abs=FULL_SCALE)


def test_digital_gain_multiplies_the_neutral(sensor, scene):
    neutral = neutral_of(sensor, "A")
    for gain in (0.5, 0.8, 1.3):
        seen = sensor.to_camera(scene, illuminant="A", digital_gain=gain)
        expected = dng_convention.camera_rgb(scene, D40, neutral, digital_gain=gain)
        assert np.abs(seen - expected).max() < FULL_SCALE


@pytest.mark.parametrize("gain", [0.0, -1.0, np.nan, np.inf])
def test_digital_gain_must_be_positive(sensor, scene, gain):
    with pytest.raises(ValueError, match="gain"):
        sensor.to_camera(scene, illuminant="A", digital_gain=gain)


def test_an_illuminant_may_stand_for_its_word(sensor, scene):
    light = sensor.illuminant("sample:3")
    for convention in ("dng", "paper"):
        by_word, by_light = (
            sensor.simulate(scene, illuminant=i, convention=convention)
            for i in ("sample:3", light)
        )
        assert (by_word == by_light).all()


def twenty_neutrals(camera):
    """(R/G, B/G) of ten lights from 2000 to 8000 K, greenish and pinkish."""
    for mired in np.linspace(125.0, 500.0, 10):
        x, y = cg2raw.planckian_xy(1e6 / mired)
        for off in (0.012, -0.008):
            red, _, blue = cameras.oracle(camera).neutral_from_xy((x, y + off))
            yield round(float(red), 6), round(float(blue), 6)


@pytest.mark.parametrize("camera", cameras.NINE)
def test_paper_convention_equals_the_oracle(camera, scene):
    sensor, (cm_a, cm_d65) = sensor_of(camera), cameras.matrices(camera)
    for red, blue in twenty_neutrals(camera):
        neutral = np.array([red, 1.0, blue])
        cct, _ = sensor.paper_temperature(tuple(neutral))
        expected_cct, _ = paper.temperature(neutral, cm_a, cm_d65)
        assert cct == pytest.approx(expected_cct, rel=1e-9)
        for highlights, gain in ((True, 1.0), (False, 1.0), (True, 0.8)):
            seen = sensor.to_camera(
                scene,
                illuminant=f"neutral:{red}:{blue}",
                convention="paper",
                highlights=highlights,
                digital_gain=gain,
            )
            expected = paper.camera(scene, neutral, cm_a, cm_d65, gain, highlights)
            assert np.abs(seen - expected).max() < FULL_SCALE


def test_paper_convention_keeps_white_white(sensor):
    white = np.ones((1, 1, 3), np.float32)
    seen = sensor.to_camera(white, illuminant="neutral:0.5:0.6", convention="paper")
    assert seen[0, 0] == pytest.approx([1.0, 1.0, 1.0], abs=FULL_SCALE)


def test_paper_temperatures_are_not_true_ones():
    """2856 K comes out at 4108 to 5287 K. Source: DESIGN.md 3.3."""
    seen = [
        sensor_of(camera).paper_temperature(
            sensor_of(camera).illuminant("2856K").neutral
        )
        for camera in cameras.NINE
    ]
    kelvin = [cct for cct, _ in seen]
    assert min(kelvin) == pytest.approx(4108.0, abs=15.0)  # by what light is not said
    assert max(kelvin) == pytest.approx(5287.0, abs=15.0)


def test_the_conventions_are_named(sensor, scene):
    with pytest.raises(ValueError, match="dng.*paper"):
        sensor.to_camera(scene, illuminant="A", convention="adobe")


GREYS = np.linspace(0.0, 4.0, 4001)


@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("spec", LIGHTS)
def test_white_and_above_stay_white_and_nothing_jumps(sensor, spec, convention):
    ramp = np.repeat(GREYS, 3).reshape(1, -1, 3).astype(np.float32)
    seen = sensor.to_camera(ramp, illuminant=spec, convention=convention)[0]
    above = seen[GREYS >= 1.0]
    top = above[0].max()
    clipped = np.minimum(above, 1.0)
    assert np.ptp(clipped, axis=1).max() < 2 * FULL_SCALE, "a cast above white"
    assert top == pytest.approx(1.0, abs=0.05) or convention == "dng"
    step = np.diff(seen, axis=0)
    assert step.min() > -1e-6, "grey levels must not turn dark again"
    assert step.max() < 25.0 * (GREYS[1] - GREYS[0]), "a jump"


def test_the_mask_is_that_of_the_paper(sensor):
    """Half way into the highlights a quarter of the cast is gone."""
    grey = np.full((1, 1, 3), 0.95, np.float32)
    neutral = neutral_of(sensor, "A")
    gains = neutral / neutral.max()
    seen = sensor.to_camera(grey, illuminant="A")[0, 0]
    mask = 0.25
    assert seen == pytest.approx(0.95 * (mask + (1 - mask) * gains), abs=5e-6)


def test_pixels_that_are_no_numbers_are_legal(sensor):
    bad = np.array(
        [
            [
                [np.nan] * 3,
                [np.inf] * 3,
                [-np.inf] * 3,
                [-0.5] * 3,
                [1e30] * 3,
                [0.2] * 3,
            ]
        ],
        np.float32,
    )
    seen = sensor.to_camera(bad, illuminant="A")[0]
    white = sensor.to_camera(np.ones((1, 1, 3), np.float32), illuminant="A")[0, 0]
    assert np.isfinite(seen).all()
    assert (seen[[0, 2, 3]] == 0.0).all()
    assert (seen[1] == white).all() and (seen[4] == white).all()
    raw = sensor.simulate(np.tile(bad, (2, 1, 1)), illuminant="A")
    black, top = sensor.black_level[0], sensor.white_level
    assert (raw[:, 0] == black).all() and (raw[:, 1] == top).all()


@pytest.mark.parametrize("value", [np.copysign(np.nan, -1), -np.inf, -1e38])
def test_negatives_that_are_no_light_are_black(sensor, value):
    """By their bits, signs are no part of a magnitude; 0 divided by 0 is a -NaN."""
    rgb = np.full((3, 40, 3), 0.2, np.float32)
    rgb[1, 7] = value
    seen = sensor.to_camera(rgb, illuminant="A")
    rgb[1, 7] = 0.0
    assert (seen == sensor.to_camera(rgb, illuminant="A")).all()


def test_one_channel_that_is_no_number_spoils_only_itself(sensor):
    mixed = np.array([[[np.nan, 0.5, 0.25]]], np.float32)
    clean = np.array([[[0.0, 0.5, 0.25]]], np.float32)
    seen = [sensor.to_camera(rgb, illuminant="A") for rgb in (mixed, clean)]
    assert (seen[0] == seen[1]).all()


def test_input_may_be_float16_float64_or_a_view(sensor, scene):
    expected = sensor.to_camera(scene, illuminant="A")
    wide = np.zeros((40, 50, 5), np.float32)
    wide[..., 1:4] = scene
    for same in (scene.astype(np.float64), wide[..., 1:4], np.asfortranarray(scene)):
        assert (sensor.to_camera(same, illuminant="A") == expected).all()
    half = sensor.to_camera(scene.astype(np.float16), illuminant="A")
    assert half == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("shape", [(4, 4), (4, 4, 1), (4, 4, 2), (4, 4, 5), (0, 4, 3)])
def test_other_shapes_are_errors(sensor, shape):
    with pytest.raises(ValueError):
        sensor.simulate(np.zeros(shape, np.float32), illuminant="A")


def test_the_oracles_agree_on_what_a_renderer_undoes(sensor):
    """Bradford from D50 to the light and back is the identity."""
    there, back = (
        adobe.bradford((0.44, 0.40), adobe.D50),
        adobe.bradford(adobe.D50, (0.44, 0.40)),
    )
    assert there @ back == pytest.approx(np.eye(3), abs=1e-12)
