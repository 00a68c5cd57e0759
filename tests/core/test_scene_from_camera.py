# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""transform.h: camera RGB back to the scene, in both conventions."""

import numpy as np
import pytest

import cg2raw
from oracles import adobe, cameras, dng_convention, paper

LIGHTS = ("A", "3200K", "D65", "neutral:0.38:0.79", "neutral:1.2:0.25")
FULL_SCALE = 1e-5  # float32 pixels, times the gains and rows that undo the matrices


@pytest.fixture(scope="module", params=["NikonD40", "Canon600D"])
def camera(request):
    return request.param


@pytest.fixture(scope="module")
def camera_rgb():
    """(30, 40, 3), black to above white."""
    return np.random.default_rng(5).uniform(-0.1, 1.3, (30, 40, 3)).astype(np.float32)


def sensor_of(camera):
    return cg2raw.Sensor.from_json(cameras.profile_of(camera))


@pytest.mark.parametrize("spec", LIGHTS)
def test_dng_is_what_a_renderer_computes(camera, spec, camera_rgb):
    sensor, oracle = sensor_of(camera), cameras.oracle(camera)
    neutral = np.array(sensor.illuminant(spec).neutral)
    xy = oracle.xy_from_neutral(neutral)[0]
    balanced = np.clip(camera_rgb / (neutral / neutral.max()), 0, 1)
    matrix = np.linalg.inv(dng_convention.balanced_from_srgb(oracle, xy))
    seen = sensor.to_scene(camera_rgb, illuminant=spec)
    assert seen.dtype == np.float32 and seen.flags.c_contiguous
    assert np.abs(seen - balanced @ matrix.T).max() < FULL_SCALE


@pytest.mark.parametrize("spec", LIGHTS)
def test_paper_clips_between_its_two_matrices(camera, spec, camera_rgb):
    sensor = sensor_of(camera)
    neutral = np.array(sensor.illuminant(spec).neutral)
    cm_a, cm_d65 = cameras.matrices(camera)
    weight = paper.weight_of_d65(paper.temperature(neutral, cm_a, cm_d65)[0])
    warm, cool = np.clip(1.0 - weight, 0.0, 1.0), np.maximum(weight, 0.0)
    matrix = paper.row_normalised(paper.mixed(cm_a, cm_d65, warm, cool))
    balanced = np.clip(camera_rgb / neutral, 0, 1)
    XYZ = np.clip(balanced @ np.linalg.inv(matrix).T, 0, 1)
    expected = XYZ @ paper.row_normalised(paper.SRGB_FROM_XYZ).T
    seen = sensor.to_scene(camera_rgb, illuminant=spec, convention="paper")
    assert np.abs(seen - expected).max() < FULL_SCALE


@pytest.mark.parametrize("gain", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("spec", LIGHTS)
def test_there_and_back(camera, spec, convention, gain):
    """Greyish colours, which no camera clips."""
    rng = np.random.default_rng(6)
    grey = rng.uniform(0.02, 0.2, (30, 40, 1))
    scene = (grey * rng.uniform(0.9, 1.1, (30, 40, 3))).astype(np.float32)
    sensor, how = sensor_of(camera), {"convention": convention, "digital_gain": gain}
    seen = sensor.to_camera(scene, illuminant=spec, **how)
    back = sensor.to_scene(seen, illuminant=sensor.illuminant(spec), **how)
    assert np.abs(back - scene).max() < FULL_SCALE


@pytest.mark.parametrize("highlights", [True, False])
def test_white_comes_back_as_white(highlights):
    sensor = sensor_of("NikonD40")
    scene = np.array([[[1, 1, 1], [7, 7, 7]]], np.float32)
    seen = sensor.to_camera(scene, illuminant="A", highlights=highlights)
    back = sensor.to_scene(seen, illuminant="A")
    assert back == pytest.approx(np.ones((1, 2, 3)), abs=FULL_SCALE)


def test_pixels_that_are_not_finite():
    bad = np.array([[[np.nan, 0, 0], [np.inf, np.inf, np.inf]]], np.float32)
    seen = sensor_of("NikonD40").to_scene(bad, illuminant="D65")
    assert (seen[0, 0] == 0).all()
    assert seen[0, 1] == pytest.approx(np.ones(3), abs=FULL_SCALE)


def test_bad_requests():
    sensor, image = sensor_of("NikonD40"), np.ones((2, 2, 3), np.float32)
    with pytest.raises(ValueError, match="convention"):
        sensor.to_scene(image, illuminant="A", convention="adobe")
    with pytest.raises(ValueError, match="digital gain 0"):
        sensor.to_scene(image, illuminant="A", digital_gain=0)


def test_the_dng_oracle_is_that_of_the_specification():
    """D50 is the connection space's white, so balanced white is sRGB's white."""
    xyz = adobe.xyz_d50_from_srgb() @ np.ones(3)
    assert xyz == pytest.approx(adobe.xyz(adobe.D50), abs=1e-9)
