# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The field lamps of a profile: a lamp's word takes its own neutral and matrix."""

import json

import numpy as np
import pytest

import cg2raw
from dng import dng_files
from oracles import adobe, cameras

M = [0.6021, -0.0423, -0.0807, -0.4895, 1.2823, 0.2299, -0.1044, 0.2026, 0.6376]
FL2 = {
    "name": "FL2",
    "calibration_illuminant": "cool white fluorescent",
    "neutral": [0.52594, 0.555568],
    "color_matrix": M,
}
STUDIO = {
    "name": "my-Studio_2",
    "neutral": [0.9, 0.35],
    "color_matrix": [0.65, -0.16, 0.0, -0.36, 1.07, 0.34, -0.03, 0.09, 0.7],
}
LED = {**FL2, "name": "LED-B3", "calibration_illuminant": "other"}
SCENE = np.random.default_rng(7).uniform(0.0, 1.5, (8, 12, 3)).astype(np.float32)


def load(*lamps, **fields):
    text = cameras.profile_text(lamps=list(lamps), **fields)
    return cg2raw.Sensor.from_json(text, name="inline.json")


def with_matrix_of(lamp, light_source):
    """Return the sensor whose only matrix is that of a lamp."""
    fields = dict.fromkeys(("calibration_illuminant_2", "color_matrix_2"))
    return cg2raw.Sensor.from_json(
        cameras.profile_text(
            calibration_illuminant_1=light_source,
            color_matrix_1=lamp["color_matrix"],
            **fields,
        )
    )


@pytest.mark.parametrize("word", ["FL2", "fl2", "lamp:FL2", "LAMP:fl2"])
def test_its_neutral_and_white_are_the_lamps(word):
    light = load(FL2).illuminant(word)
    red, blue = FL2["neutral"]
    assert light.neutral == pytest.approx((red, 1.0, blue), abs=1e-12)
    white = np.linalg.solve(np.reshape(M, (3, 3)), light.neutral)
    assert light.xy == pytest.approx(adobe.chromaticity(white), abs=1e-4)


@pytest.mark.parametrize("convention", ["dng", "sensor", "paper"])
@pytest.mark.parametrize("lamp", [FL2, STUDIO], ids=["FL2", "studio"])
def test_pixels_are_those_of_a_camera_with_its_matrix_alone(lamp, convention):
    red, blue = lamp["neutral"]
    asked = {"convention": convention, "effects": False}
    seen = load(FL2, STUDIO).signal(SCENE, illuminant=f"lamp:{lamp['name']}", **asked)
    alone = with_matrix_of(lamp, "cool white fluorescent")
    expected = alone.signal(SCENE, illuminant=f"neutral:{red}:{blue}", **asked)
    assert np.array_equal(seen, expected)


def test_other_lights_are_as_before():
    for word in ("A", "D65", "3200K", "neutral:0.52594:0.555568"):
        with_lamps, without = (
            sensor.signal(SCENE, illuminant=word) for sensor in (load(FL2), load())
        )
        assert np.array_equal(with_lamps, without)


def test_a_lamp_called_like_a_light_comes_before_it():
    lamp = {**FL2, "name": "D50"}
    assert load(lamp).illuminant("D50").neutral[0] == FL2["neutral"][0]
    assert load().illuminant("D50").neutral[0] != FL2["neutral"][0]


def test_a_file_has_the_lamps_matrix_alone(tmp_path):
    sensor = load(FL2, LED)
    for word, source in (("FL2", 14), ("LED-B3", 255)):
        path = tmp_path / f"{word}.dng"
        dng_files.write(path, sensor, illuminant=word)
        tags = dng_files.tags_of(path)[0]
        assert tags["CalibrationIlluminant1"] == source
        matrix = np.divide(tags["ColorMatrix1"][::2], tags["ColorMatrix1"][1::2])
        assert matrix == pytest.approx(M, abs=1e-9)
        assert "ColorMatrix2" not in tags
    path = tmp_path / "d65.dng"
    dng_files.write(path, sensor, illuminant="D65")
    assert "ColorMatrix2" in dng_files.tags_of(path)[0]


def test_the_alias_of_its_colour_space_finds_it(tmp_path, monkeypatch):
    text = cameras.profile_text(lamps=[LED, STUDIO])
    (tmp_path / "test-sensor.json").write_text(text)
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(tmp_path))
    sensor = cg2raw.Sensor("test-sensor")
    for word in ("LED-B3", "lamp:LED-B3", "lamp:my-Studio_2"):
        alias = cg2raw.raw_space_alias("test-sensor", word)
        found, again = cg2raw.raw_space_from_name(alias)
        assert found == "test-sensor"
        assert sensor.illuminant(again).neutral == sensor.illuminant(word).neutral


def test_it_reads_back():
    kept = json.loads(load(FL2, STUDIO).to_json())["lamps"]
    assert kept == [FL2, {"calibration_illuminant": "other", **STUDIO}]
    lamp = load(FL2).lamps[0]
    assert (lamp["name"], lamp["light_source"]) == ("FL2", "cool white fluorescent")
    assert lamp["camera_from_xyz"].ravel().tolist() == M


UNKNOWN = [
    (load, "FL3", 'no matrix for lamp "fl3": its profile lists no lamp.*--illuminant'),
    (lambda: load(FL2, LED), "lamp:x", "its lamps are FL2, LED-B3"),
    (lambda: load(FL2), "lamp:", "needs the name of a lamp"),
    (lambda: load(FL2), "FLX", "unknown illuminant FLX; it may be: .*lamp:NAME"),
    (lambda: load(FL2), "lamp:a:b", "unknown illuminant lamp:a:b"),
]


@pytest.mark.parametrize(("sensor", "word", "message"), UNKNOWN)
def test_an_unknown_lamp_is_an_error_that_lists_those_known(sensor, word, message):
    with pytest.raises(ValueError, match=message):
        sensor().illuminant(word)


WRONG = [
    ([{**FL2, "name": "my lamp"}], 'name "my lamp" must be of letters'),
    ([{**FL2, "name": ""}], r"lamps\[0\].name.*text"),
    ([LED, {**LED, "name": "led_b3"}], '"led_b3" and "LED-B3" are one name'),
    ([{**FL2, "neutral": [0.5]}], r"lamps\[0\].neutral.*2"),
    ([{**FL2, "neutral": [0.5, 0.001]}], "lamp FL2 0.001 must be within 0.01"),
    ([{**FL2, "color_matrix": [1, 2, 3] * 3}], "lamp FL2: .*singular"),
    ([{**FL2, "color_matrix": [-v for v in M]}], "lamp FL2 maps white"),
    ([{**FL2, "calibration_illuminant": "LED"}], "must be one of A, B.*, other"),
    ([{**FL2, "watts": 5}], "watts is unknown"),
    ([{**FL2, "power": [1]}], "power.*object"),
    ({}, "list"),
]


@pytest.mark.parametrize(("lamps", "message"), WRONG, ids=[case[1] for case in WRONG])
def test_a_wrong_lamp_is_refused(lamps, message):
    with pytest.raises(ValueError, match=message) as caught:
        cg2raw.Sensor.from_json(cameras.profile_text(lamps=lamps), name="inline.json")
    assert str(caught.value).startswith("inline.json: ")
