# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Mistyped sensors and illuminants: every way in that takes them suggests the words."""

import pickle

import numpy as np
import pytest

import cg2raw
from cg2raw import _core, near_words
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from dng import dng_files
from images import write_image
from python.commands import fails, write_dng

LIGHTS = {
    "5600": "5600K",
    "5600 K": "5600K",
    "3200kelvin": "3200K",
    "d56": "D55 or D65",  # the nearest number, and its digits the other way round
    "D60": "D55 or D65",
    "D6500": "D65",
    "d57": "D55 or D75",
    "1667": "1667K",
    "25000": "25000K",
    "tungsten": "A",
    "Flash": "D55",
    "cloudy": "D65",
    "shade": "D75",
    "fl 1": "FL1",
    "fl 2": "FL2",
    "FL_12": "FL12",
    "hp 5": "HP5",
    "LED B3": "LED-B3",
    "sampl:3": "sample:3",
    "smpl:0": "sample:0",
}
SENSORS = {
    "canon600d": "canon-600d",
    "NIKON-D40": "nikon-d40",
    "nikon-d41": "nikon-d40",
    "a57": "sony-a57",
    "sony": "sony-a57 or sony-a7s-ii",
    "canno": "canon-1ds-mark-iii, canon-5d or canon-5d-mark-iv",  # a word of the id
}


@pytest.mark.parametrize("word", LIGHTS)
def test_a_light_that_was_meant(word):
    with pytest.raises(ValueError) as found:
        cg2raw.Sensor("nikon-d40").illuminant(word)
    shown = f'"{word}"' if " " in word else word
    assert str(found.value) == (
        f"unknown illuminant {shown}; did you mean {LIGHTS[word]}?"
    )


@pytest.mark.parametrize(
    "word", ["moon", "E", "1666.9", "25000.1", "FLX", "as-shot:1:2", ""]
)
def test_a_light_like_no_other_is_told_the_grammar(word):
    with pytest.raises(ValueError) as found:
        cg2raw.Sensor("nikon-d40").illuminant(word)
    assert str(found.value) == (
        f"unknown illuminant {word or chr(34) * 2}; it may be: "
        f"{cg2raw.illuminant_grammar}"
    )


@pytest.mark.parametrize("word", SENSORS)
def test_a_sensor_that_was_meant(word):
    with pytest.raises(ValueError) as found:
        cg2raw.Sensor(word)
    start = f'unknown sensor "{word}"; did you mean {SENSORS[word]}? installed: '
    assert str(found.value).startswith(start + cg2raw.installed_profiles()[0])


def test_a_sensor_like_no_other_is_told_all():
    with pytest.raises(ValueError, match='unknown sensor "kodak"; installed: black'):
        cg2raw.Sensor("kodak")


def test_every_word_that_is_suggested_is_one():
    sensor = dng_files.sensor("canon-600d")
    for words in map(near_words.near_illuminants, LIGHTS):
        for word in words:
            assert sensor.illuminant(word).spec == word


def test_words_that_are_understood_have_nothing_nearer():
    """Or a message of another kind would suggest what was typed."""
    for word in ("D55", "5600K", "sample:3", "FL2"):
        assert near_words.near_illuminants(word) in ([], [word])


RGB = np.zeros((4, 4, 3), np.float32)


@pytest.mark.parametrize(
    "call",
    [
        lambda: cg2raw.Sensor("nikon-d40").simulate(RGB, illuminant="5600"),
        lambda: cg2raw.Sensor("nikon-d40").to_camera(RGB, illuminant="5600"),
        lambda: cg2raw.illuminant_list("A,5600"),
    ],
)
def test_every_way_in_suggests(call):
    with pytest.raises(ValueError, match="unknown illuminant 5600; did you mean 5600K"):
        call()


def test_an_error_that_was_sent_to_another_process_suggests():
    with pytest.raises(_core.Error) as found:
        cg2raw.illuminant_list("5600")
    assert str(pickle.loads(pickle.dumps(found.value))) == str(found.value)


def command(name, folder, sensor, light):
    """Return the words of a command that takes a sensor and a light."""
    image, out, captures = (
        folder / name for name in ("shot.exr", "out.ocio", "captures.yaml")
    )
    write_image(image, np.zeros((16, 24, 3), np.float32))
    dng = write_dng(folder / "flat.dng", shape=(64, 96))
    captures.write_text(
        f"sensor: {sensor}\nframes:\n"
        f"  - {{file: {dng.name}, kind: flat, scene: 0.5, illuminant: {light}}}\n"
    )
    pairs = ("--sensors", sensor, "--illuminants", light)
    return {
        "convert": ("convert", image, "-o", folder / "shot.dng")
        + ("--sensor", sensor, "--illuminant", light),
        "dataset": ("dataset", image, folder / "set", *pairs),
        "ocio": ("ocio", *pairs, "-o", out),
        "diagnose": ("diagnose", captures, "-o", folder / "report"),
        "calibrate": ("calibrate", dng, "--sensor", sensor),
        "synthesize": ("diagnose", "synthesize", "--effects", "prnu=1")
        + ("-s", sensor, "-o", folder / "set"),
    }[name]


@pytest.mark.parametrize("name", ["convert", "dataset", "ocio", "diagnose"])
def test_a_command_suggests_a_light(tmp_path, name):
    line = fails(*command(name, tmp_path, "nikon-d40", "d56"))
    assert "unknown illuminant d56; did you mean D55 or D65?" in line


@pytest.mark.parametrize(
    "name", ["convert", "dataset", "ocio", "diagnose", "calibrate", "synthesize"]
)
def test_a_command_suggests_a_sensor(tmp_path, name):
    line = fails(*command(name, tmp_path, "canon600d", "D65"))
    assert 'unknown sensor "canon600d"; did you mean canon-600d? installed: ' in line


def test_a_spectrum_by_name_is_suggested():
    with pytest.raises(ValueError, match="'tungsten' is unknown; did you mean A?"):
        illuminant_spectrum("tungsten")
    with pytest.raises(ValueError, match="'sampl' is unknown; it may be a name"):
        illuminant_spectrum("sampl")


@pytest.mark.parametrize("noise", [None, "physical"])
def test_a_sensor_without_noise_is_told_how_to_measure_it(noise):
    sensor = cg2raw.Sensor("nikon-d40")
    with pytest.raises(ValueError) as found:
        sensor.simulate(RGB, illuminant="D65", iso=100, noise=noise)
    assert (
        "has no measured noise: leave the ISO out, or measure it by cg2raw calibrate "
        "(docs/calibrate.md)"
    ) in str(found.value)


def test_a_sensor_with_noise_at_one_iso_says_so_for_all_others():
    """And not a range of ISOs for some of them."""
    row = {"iso": 252, "beta1": [1e-3] * 4, "beta2": [1e-6] * 4}
    sensor = dng_files.sensor(noise=[row])
    for iso in (100, 126, 251, 504, 1000):
        with pytest.raises(ValueError, match="is known at ISO 252 only"):
            sensor.noise_at(iso)


@pytest.mark.parametrize("letter", ["a", "\u00e9", "\U0001f4f7"])
def test_a_long_message_keeps_its_start_and_its_end(letter):
    """No letter of several bytes is cut in half; a short one stays as it is."""
    message = f"scene\n.exr: {2000 * letter} is unknown"
    found = near_words.one_line(message)
    start, _, end = found.partition(" ... ")
    assert start.startswith("scene?.exr: " + letter) and end.endswith(" is unknown")
    assert {*start[12:], *end.removesuffix(" is unknown")} == {letter}
    assert 1480 < len(f"{start}{end}".encode()) <= 1500
    whole = letter * (1500 // len(letter.encode()))  # bytes
    assert near_words.one_line(whole) == whole != near_words.one_line(whole + letter)
    assert near_words.one_line(message[:300]) == message[:300].replace("\n", "?")
