# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""camera_frame.h: effects that see more of the frame than their pixel do not depend on
how the frame is cut, and a prediction is what is drawn on average."""

import json

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from oracles import cameras

EFFECTS = {effect["name"]: effect for effect in cg2raw.effects()}
SECONDS = 0.25
PER_SITE = ("00", "01", "10", "11")
SPREAD = {
    "blur": {"ring_1": 0.2, "ring_2": 0.1, "ring_10": 0.05},
    "veiling_glare": {"uniform": 0.03, "wide": 0.05},
    "crosstalk": {"left": 0.01, "right": 0.02, "up": 0.03, "down": 0.01},
}
LISTED = {
    **SPREAD,
    "exposure": {"gain": 0.2},
    "shot_noise": {f"beta1_{site}": 4e-4 for site in PER_SITE},
    "read_noise": {f"beta2_{site}": 2e-6 for site in PER_SITE},
    "full_well": {"below_white": 0.3},
    "noise_reduction": {"blend": 0.4, "diagonal": 0.1},
    "prnu": {"sigma": 0.01},
    "hot_pixels": {"fraction": 0.01, "rate": 1.0},
}


def sensor_with(effects, **fields):
    """Parameters that are not given are null."""
    listed = [
        {
            "name": name,
            "parameters": {p["name"]: p["null"] for p in EFFECTS[name]["parameters"]}
            | values,
        }
        for name, values in effects.items()
    ]
    return cg2raw.Sensor.from_json(cameras.profile_text(effects=listed, **fields))


def scene(height, width, low=0.0, high=1.0):
    rng = np.random.default_rng(9)
    return rng.uniform(low, high, (height, width, 3)).astype(np.float32)


def run_of(**run):
    how = {"illuminant": "D65", "convention": "sensor", "exposure_time": SECONDS}
    return {**how, "camera_input": True, **run}


@pytest.mark.parametrize("shape", [(300, 530), (5, 700), (257, 3)])
def test_threads_make_no_difference(shape):
    """Of more than one block, and of frames that are smaller than the reach."""
    sensor, image = sensor_with(LISTED), scene(*shape)
    raw = [sensor.simulate(image, **run_of(threads=n)) for n in (1, 3)]
    np.testing.assert_array_equal(*raw)
    expected = [sensor.predict(image, **run_of(threads=n)) for n in (1, 3)]
    np.testing.assert_array_equal(*expected)
    signal = sensor.signal(image, **run_of())
    np.testing.assert_array_equal(sensor.raw_from_signal(signal), raw[0])


def settings_of(effects):
    return [
        (name, [values.get(p["name"], p["null"]) for p in EFFECTS[name]["parameters"]])
        for name, values in effects.items()
    ]


def test_blocks_with_halos_are_the_frame_in_one_piece():
    """The prediction of one block that is the frame: nothing is cut there."""
    sensor, image = sensor_with(LISTED), scene(300, 530)
    camera = np.ascontiguousarray(np.moveaxis(image, -1, 0))[None]
    neutral = sensor.illuminant("D65").neutral
    glare_context = _core.glare_context(image)
    whole = _core.predict_blocks(
        sensor.profile, settings_of(LISTED), camera, np.zeros((1, 2), np.int32),
        (300, 530), 0, neutral, SECONDS, glare_context,
    )  # fmt: skip
    mean, variance = sensor.predict(image, **run_of())
    np.testing.assert_array_equal(mean, whole[0][0])
    np.testing.assert_array_equal(variance, whole[1][0])
    margin, rows, cols = 20, 120, 150
    row, col = 91, 213
    part = _core.predict_blocks(
        sensor.profile, settings_of(LISTED),
        np.ascontiguousarray(camera[..., row : row + rows, col : col + cols]),
        np.array([[row + margin, col + margin]], np.int32),
        (300, 530), margin, neutral, SECONDS, glare_context,
    )  # fmt: skip
    inner = np.s_[
        row + margin : row + rows - margin, col + margin : col + cols - margin
    ]
    for of_part, of_whole in zip(part, whole, strict=True):
        np.testing.assert_array_equal(of_part[0], of_whole[0][inner])


@pytest.mark.parametrize("row", [0, 5, 100, 215, 220])
@pytest.mark.parametrize("col", [0, 19, 200, 420])
def test_blocks_at_the_frames_ends_are_those_of_the_whole_frame(row, col):
    """Their margins end there, and effects mirror."""
    sensor, image = sensor_with(LISTED), scene(300, 530)
    camera = np.ascontiguousarray(np.moveaxis(image, -1, 0))[None]
    neutral, glare_context = (
        sensor.illuminant("D65").neutral,
        _core.glare_context(image),
    )

    def predicted(block, origin, margin):
        return _core.predict_blocks(
            sensor.profile, settings_of(LISTED), np.ascontiguousarray(block),
            np.array([origin], np.int32), (300, 530), margin, neutral, SECONDS,
            glare_context,
        )  # fmt: skip

    margin, rows, cols = 20, 80, 110
    top = min(max(row - margin, 0), 300 - rows - 2 * margin)
    left = min(max(col - margin, 0), 530 - cols - 2 * margin)
    block = camera[..., top : top + rows + 2 * margin, left : left + cols + 2 * margin]
    part = predicted(block, (row, col), margin)
    whole = predicted(camera, (0, 0), 0)
    for of_part, of_whole in zip(part, whole, strict=True):
        inner = of_whole[0][row : row + rows, col : col + cols]
        np.testing.assert_array_equal(of_part[0], inner)


def test_one_effect_on_an_array_is_that_of_a_frame_in_blocks():
    image = scene(300, 530)
    for name, values in SPREAD.items():
        sensor = sensor_with({name: values})
        parameters = sensor.effects[0]["parameters"]
        of_camera = EFFECTS[name]["stage"] == "optics"
        given = image if of_camera else sensor.mosaic(image)
        seen = sensor.apply_effect(given, name, parameters)
        expected = sensor.signal(image, **run_of())
        np.testing.assert_array_equal(
            sensor.mosaic(seen) if of_camera else seen, expected
        )


def test_what_is_drawn_is_on_average_what_is_predicted():
    """Over frames: the mean, with fixed patterns, and the variance per site. Cut at a
    full well, where the normal is not one any more, and read out after it."""
    effects = {k: v for k, v in LISTED.items() if k != "noise_reduction"}
    sensor, image = sensor_with(effects), scene(48, 64, 0.3, 0.9)
    count = 600
    mean, variance = sensor.predict(image, **run_of())
    frames = np.stack(
        [sensor.signal(image, **run_of(frame=n)) for n in range(count)]
    ).astype(float)
    error = (frames.mean(0) - mean) / np.sqrt(variance / count)
    assert abs(error).max() < 6
    assert abs(error.mean()) < 0.1
    assert 0.9 < error.std() < 1.1
    clipped = mean > 0.7 - 1e-3
    assert 100 < clipped.sum() < clipped.size - 100
    for part in (clipped, ~clipped):
        ratio = frames.var(0, ddof=1)[part].mean() / variance[part].mean()
        assert ratio == pytest.approx(1.0, abs=5 * np.sqrt(2 / count / 100))


def test_hot_pixels_lie_where_they_are_predicted():
    sensor = sensor_with({"hot_pixels": {"fraction": 0.01, "rate": 1.0}})
    dark = np.zeros((64, 64, 3), np.float32)
    seen = sensor.signal(dark, **run_of())
    assert 10 < (seen > 0).sum() < 90
    np.testing.assert_array_equal(sensor.predict(dark, **run_of())[0], seen)
    twice = sensor.signal(dark, **run_of(exposure_time=2 * SECONDS, frame=3, seed=4))
    np.testing.assert_allclose(twice, 2 * seen, rtol=1e-6)


def test_dark_current_needs_an_exposure_time():
    sensor = sensor_with({"dark_current": {"per_second": 0.1}})
    with pytest.raises(ValueError, match="dark_current needs an exposure time.*Exif"):
        sensor.simulate(scene(8, 8), illuminant="A")
    with pytest.raises(ValueError, match="exposure_time -1 must be 0 to"):
        sensor.simulate(scene(8, 8), illuminant="A", exposure_time=-1.0)
    with pytest.raises(ValueError, match='exposure_time "long" must be seconds'):
        sensor.simulate(scene(8, 8), illuminant="A", exposure_time="long")
    longer = sensor.signal(np.zeros((8, 8, 3)), illuminant="A", exposure_time=2.0)
    np.testing.assert_allclose(longer, 0.2, rtol=1e-6)


def predict(effects, **options):
    given = {"glare_context": None, "exposure_time": None, "margin": 4, **options}
    return _core.predict_blocks(
        sensor_with({}).profile, settings_of(effects), np.zeros((1, 3, 20, 20), "f4"),
        np.full((1, 2), 9, np.int32), (40, 40), neutral=[1, 1, 1], **given,
    )  # fmt: skip


def test_a_prediction_says_what_it_needs():
    with pytest.raises(ValueError, match="veiling_glare needs the glare context"):
        predict({"veiling_glare": {}})
    with pytest.raises(ValueError, match="hot_pixels needs an exposure time"):
        predict({"hot_pixels": {}})
    with pytest.raises(ValueError, match="margin 0 is less than the 3 pixels"):
        predict({"crosstalk": {}, "noise_reduction": {}}, margin=0)


def test_the_glare_context_passes_the_effects_of_colour():
    """Twice the light has twice the glare."""
    camera = scene(20, 20)
    glare = {"veiling_glare": {"uniform": 0.1, "wide": 0.2}}
    how = {"margin": 0, "exposure_time": None, "neutral": [1, 1, 1]}
    results = []
    for gain, listed in ((1, glare | {"exposure": {"gain": 1.0}}), (2, glare)):
        planes = np.ascontiguousarray(np.moveaxis(gain * camera, -1, 0))
        results.append(
            _core.predict_blocks(
                sensor_with({}).profile, settings_of(listed), planes[None],
                np.zeros((1, 2), np.int32), (20, 20),
                glare_context=_core.glare_context(planes),
                **how,
            )[0]
        )  # fmt: skip
    np.testing.assert_allclose(*results, rtol=1e-6)


def test_convention_sensor_clips_at_white_alone():
    """Linear in the scene, above white and at it; noise falls on every site."""
    sensor = sensor_with({})
    dim, how = scene(20, 24, 0.05, 0.5), {"illuminant": "3200K"}
    light = sensor.to_camera(dim, convention="sensor", **how)
    plain = sensor.to_camera(dim, highlights=False, **how)
    np.testing.assert_array_equal(light[plain > 0], plain[plain > 0])
    bright = sensor.to_camera(16 * dim, convention="sensor", **how)
    np.testing.assert_array_equal(bright, 16 * light)
    assert bright.max() > 2.0 and bright.min() >= 0.0
    assert sensor.to_camera(16 * dim, **how).max() < 1.0 + 1e-6
    raw = sensor.simulate(16 * dim, convention="sensor", **how)
    assert raw.max() == sensor.white_level
    noisy = sensor_with({"read_noise": LISTED["read_noise"]})
    white = np.ones((32, 32, 3), np.float32)
    run = {**how, "camera_input": True}
    assert noisy.signal(white, **run).std() == 0.0
    assert noisy.signal(white, **run, convention="sensor").std() > 1e-3
    assert noisy.predict(white, **run, convention="sensor")[1].min() > 1e-6
    dark = sensor.signal(-white, **run, convention="sensor")
    assert dark.max() == dark.min() == 0.0
    with pytest.raises(ValueError, match="dng, paper, sensor or spectral"):
        sensor.to_camera(dim, convention="film", **how)


def test_full_well_cuts_noise_that_read_out_does_not():
    """After a full well only the read-out is noisy: its own and no more."""
    effects = {name: LISTED[name] for name in ("shot_noise", "read_noise")}
    effects["full_well"] = {"below_white": 0.5}
    bright = np.full((256, 256, 3), 0.9, np.float32)
    seen = sensor_with(effects).signal(bright, **run_of())
    assert seen.mean() == pytest.approx(0.5, abs=1e-4)
    assert seen.var() == pytest.approx(2e-6, rel=0.03)
    dim = sensor_with(effects).signal(bright / 9, **run_of())
    assert dim.var() == pytest.approx(4e-4 * 0.1 + 2e-6, rel=0.03)


def test_an_effect_without_a_place_changes_no_byte():
    """A null effect of stage saturation moves the noise to other draws, none else."""
    noise = {name: LISTED[name] for name in ("shot_noise", "read_noise")}
    image = scene(64, 64, 0.2, 0.8)
    plain = sensor_with(noise)
    glare = sensor_with(noise | {"veiling_glare": {}, "blur": {}})
    np.testing.assert_array_equal(
        plain.simulate(image, **run_of()), glare.simulate(image, **run_of())
    )
    assert json.loads(glare.to_json())["effects"]
