# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensor and RawFrame: what they take, refuse and remember."""

import pickle

import numpy as np
import pytest
import rawpy

import cg2raw

IMAGE = np.full((8, 10, 3), 0.5, np.float32)


@pytest.fixture
def sensor():
    return cg2raw.Sensor("samsung-s20fe")


BAD_RUNS = [
    {"seed": -1},
    {"seed": 2**64},
    {"seed": 1.5},
    {"iso": "800"},
    {"iso": float("nan")},
    {"noise": "poisson"},
    {"noise": 5},
    {"noise": "physical"},
    {"noise": "physical", "iso": 800},
    {"digital_gain": "some"},
    {"illuminant": None},
    {"illuminant": ["A", "D65"]},
    {"illuminant": b"A"},
    {"illuminant": "as-shot"},
    {"illuminant": "as-shot", "as_shot": [float("nan"), 1, 0.5]},
    {"illuminant": "as-shot", "as_shot": [-1, 1, 0.5]},
]


@pytest.mark.parametrize("run", BAD_RUNS, ids=str)
def test_bad_runs_are_value_errors_of_one_line(sensor, run):
    with pytest.raises(ValueError, match=r"\A[^\n]+\Z"):
        sensor.simulate(IMAGE, **{"illuminant": "D65", **run})


BAD_IMAGES = [
    None,
    3.0,
    IMAGE[..., 0],
    IMAGE[..., :2],
    np.ones((4, 4, 5)),
    np.ones((0, 4, 3)),
    (IMAGE * 255).astype(np.uint8),
    IMAGE > 0,
    IMAGE.astype(complex),
    "an image",
]


@pytest.mark.parametrize("image", BAD_IMAGES, ids=lambda i: str(np.shape(i)))
def test_bad_images_are_value_errors(sensor, image):
    with pytest.raises(ValueError):
        sensor.simulate(image, illuminant="D65")


def test_rows_of_other_lengths_are_no_image(sensor):
    with pytest.raises(ValueError, match=r"is no image: .* inhomogeneous"):
        sensor.simulate([[0.5, 0.5], [0.5]], illuminant="D65")


def test_any_float_and_any_strides(sensor):
    raw = sensor.simulate(IMAGE, illuminant="D65")
    for image in (IMAGE.astype(np.float16), IMAGE.astype(float), IMAGE[::-1, ::-1]):
        np.testing.assert_array_equal(sensor.simulate(image, illuminant="D65"), raw)


def test_a_sensor_is_not_altered_and_can_be_pickled(sensor):
    with pytest.raises(AttributeError):
        sensor.white_level = 5
    again = pickle.loads(pickle.dumps(sensor))
    assert again.to_json() == sensor.to_json()


def test_a_sensor_has_the_fields_of_its_profile(sensor):
    assert repr(sensor) == "Sensor('samsung-s20fe')"
    assert {"white_level", "simulate", "noise_at"} <= set(dir(sensor))
    black = np.mean(sensor.black_level)
    assert sensor.signal_range == sensor.white_level - black == 1023 - 64
    for owner in (sensor, cg2raw.Sensor.__new__(cg2raw.Sensor), cg2raw):
        with pytest.raises(AttributeError):
            _ = owner.whitelevel


def test_an_illuminant_belongs_to_its_sensor(sensor):
    light = sensor.illuminant("A")
    np.testing.assert_array_equal(
        sensor.simulate(IMAGE, illuminant=light), sensor.simulate(IMAGE, illuminant="A")
    )
    with pytest.raises(ValueError, match="nikon-d40"):
        cg2raw.Sensor("nikon-d40").simulate(IMAGE, illuminant=light)


def test_a_frame_remembers_its_simulation_while_its_cfa_holds(sensor, tmp_path):
    raw = sensor.simulate(np.full((32, 32, 3), 0.5), illuminant="D65")
    out = tmp_path / "shot.dng"
    cg2raw.write_dng(out, np.maximum(raw - 1, 0))
    assert out.exists()
    for other in (
        raw[::-1],
        raw[:, ::-1],
        raw.T,
        raw[:4],
        raw.astype(float),
        raw + 2000,
    ):
        with pytest.raises(ValueError):
            cg2raw.write_dng(tmp_path / "other.dng", other)
    with pytest.raises(ValueError, match="NUL"):
        cg2raw.write_dng(str(tmp_path / "a\0b.dng"), raw)
    assert [path.name for path in tmp_path.iterdir()] == ["shot.dng"]


def plain_frame(sensor, shape=(48, 64), **run):
    """DN that remember nothing."""
    image = np.random.default_rng(3).uniform(0, 1, (*shape, 3))
    return np.array(sensor.simulate(image, illuminant="3200K", **run))


def test_a_plain_array_is_written_as_a_frame_would_be(sensor, tmp_path):
    image = np.random.default_rng(3).uniform(0, 1, (48, 64, 3))
    frame = sensor.simulate(image, illuminant="3200K", iso=800)
    cg2raw.write_dng(tmp_path / "frame.dng", frame)
    light = sensor.illuminant("3200K")
    for illuminant in ("3200K", light):
        plain = {"sensor": sensor, "illuminant": illuminant, "iso": 800}
        cg2raw.write_dng(tmp_path / "plain.dng", np.array(frame), **plain)
        told = [
            cg2raw.read_dng_metadata(str(tmp_path / n))
            for n in ("frame.dng", "plain.dng")
        ]
        for field in ("as_shot_neutral", "noise_profile", "cfa", "black_level", "shot"):
            assert getattr(told[0], field) == getattr(told[1], field), field
    assert told[1].shot["iso"] == 800 and told[1].noise_profile
    with rawpy.imread(str(tmp_path / "plain.dng")) as read:
        np.testing.assert_array_equal(read.raw_image_visible, frame)


def test_effects_of_a_plain_array_are_said_or_not(tmp_path):
    gopro = cg2raw.Sensor("gopro-hero6-black")
    raw, path = plain_frame(gopro), tmp_path / "shot.dng"
    for effects in (True, False):
        how = {"sensor": gopro, "illuminant": "D50", "effects": effects}
        cg2raw.write_dng(path, raw, **how)
        assert bool(cg2raw.read_dng_metadata(str(path)).gain_maps) == effects


def test_a_plain_array_needs_sensor_and_light_and_dn(sensor, tmp_path):
    raw, path = plain_frame(sensor), tmp_path / "no.dng"
    both = {"sensor": sensor, "illuminant": "A"}
    for bad, how, reason in (
        (raw, {}, "sensor and illuminant"),
        (raw, {"sensor": sensor}, "needs an illuminant"),
        (raw, {"illuminant": "A"}, "its sensor"),
        (raw, {"iso": 100}, "its sensor"),
        (raw.astype(np.int32), both, "uint16"),
        (raw[0], both, "uint16"),
        (raw + np.uint16(60000), both, "white level"),
        (raw, {**both, "illuminant": "E"}, "illuminant"),
        (raw, {**both, "iso": 1e6}, "iso|ISO"),
        (raw[:1], both, "height"),
    ):
        with pytest.raises(ValueError, match=reason):
            cg2raw.write_dng(path, bad, **how)
        assert list(tmp_path.iterdir()) == []
