# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw profile --ssf: measured sensitivities, alone or with a camera's DNG."""

import json

import numpy as np
import pytest

import cg2raw
from cg2raw.profile.from_sensitivities import on_colour
from cg2raw.profile.lamps import calibration_illuminant, lamp_name
from cg2raw.profile.spectral import profile_from_ssf
from python.commands import fails, run, write_dng

ALONE = {
    "--cfa": "GRBG",
    "--size": "600x400",
    "--bits": "12",
    "--black-level": "0",
    "--white-level": "4000",
}
LIGHTS = ("A", "D65", "FL2")


@pytest.fixture
def ssf(tmp_path):
    """Return a file of the sensitivities of a camera that does not exist."""
    steps = np.arange(380, 781, 5)
    peaks = {"R": (600, 40), "G": (540, 45), "B": (460, 35)}
    curves = [
        np.exp(-(((steps - at) / width) ** 2) / 2) for at, width in peaks.values()
    ]
    lines = [
        f"{n},{r:.6f},{g:.6f},{b:.6f}"
        for n, r, g, b in zip(steps, *curves, strict=True)
    ]
    path = tmp_path / "ssf.csv"
    path.write_text("\n".join(["wavelength,R,G,B", *lines]) + "\n")
    return path


def options(**changes):
    """Return the words of ALONE with changes; None leaves an option out."""
    wanted = {**ALONE, **{f"--{k.replace('_', '-')}": v for k, v in changes.items()}}
    return [word for k, v in wanted.items() if v is not None for word in (k, v)]


def lights():
    """Return the words that name LIGHTS."""
    return [word for light in LIGHTS for word in ("--illuminant-spd", light)]


def colour_of(fields):
    """Return those fields that sensitivities tell."""
    starts = (
        "calibration_illuminant",
        "color_matrix",
        "forward_matrix",
        "illuminants",
        "lamps",
        "spectral_sensitivities",
    )
    return {name: value for name, value in fields.items() if name.startswith(starts)}


def expected(ssf, **known):
    """Return the fields that the library computes."""
    names = {"make": "Acme", "model": "One"}
    known = {"cfa": "GRBG", "width": 600, "height": 400, "bits": 12, **known}
    levels = {"black_level": 0, "white_level": 4000}
    return profile_from_ssf(
        ssf, lights=LIGHTS, lamps=LIGHTS, **names, **known, **levels
    )


def test_sensitivities_alone(ssf, tmp_path):
    out = tmp_path / "my.json"
    names = ("--make", "Acme", "--model", "One")
    done = run("profile", "--ssf", ssf, *options(), *lights(), *names, "-o", out)
    assert done.code == 0, done.err
    fields = json.loads(out.read_text())
    assert colour_of(fields) == colour_of(expected(ssf))
    sensor = cg2raw.Sensor(out)
    assert (sensor.id, sensor.cfa, sensor.bits) == ("acme-one", "GRBG", 12)
    assert (sensor.width, sensor.height, sensor.white_level) == (600, 400, 4000)
    assert len(sensor.neutrals) == 3
    assert len(sensor.spectral_sensitivities["wavelengths"]) == 81
    assert [lamp["name"] for lamp in sensor.lamps] == ["FL2"]  # A and D65 are there
    assert "fitted to spectral_sensitivities" in fields["sources"]["lamps"]


def test_sensitivities_replace_the_colour_of_a_dng_and_no_more(ssf, tmp_path):
    photo = write_dng(tmp_path / "a.dng", iso=800, profile="samsung-s20fe")
    plain, out = tmp_path / "plain.json", tmp_path / "my.json"
    run("profile", photo, "-o", plain)
    done = run("profile", photo, "--ssf", ssf, *lights(), "-o", out)
    assert done.code == 0 and "are those of" in done.out
    was, now = json.loads(plain.read_text()), json.loads(out.read_text())
    assert colour_of(now) == colour_of(expected(ssf)) != colour_of(was)
    for name in set(was) - set(colour_of(was)) - {"sources"}:
        assert now[name] == was[name]
    assert "ssf.csv" in now["sources"]["color_matrix_2"]
    assert not any("one matrix" in text for text in now["sources"].values())


@pytest.mark.parametrize(
    ("note", "goes"),
    [
        ("2 of 3 files record no white balance that LibRaw can read", True),
        ("the colour matrices differ", True),
        ("Neutrals lie on a line", True),
        ("a.dng: CalibrationIlluminant1 is 255", True),
        ("black levels differ from file to file", False),
        ("2 files given more than once count once", False),
    ],
)
def test_notes_on_the_colour_that_sensitivities_replace_go(note, goes):
    assert on_colour(note) == goes


def test_a_lamp_of_a_file_is_called_like_it(ssf, tmp_path):
    lamp, out = tmp_path / "my lamp.csv", tmp_path / "my.json"
    lines = [f"{w},{1.0 if w == 545 else 0.1}" for w in range(380, 781, 5)]
    lamp.write_text("\n".join(lines))
    names = ("--make", "Acme", "--model", "One", "--illuminant-spd", lamp)
    done = run("profile", "--ssf", ssf, *options(), *names, "-o", out)
    assert done.code == 0, done.err
    sensor = cg2raw.Sensor(out)
    assert sensor.illuminant("lamp:my-lamp").neutral[0] == sensor.neutrals[0][0]
    shown = run("sensors", out)
    assert "lamps my-lamp" in shown.out and shown.code == 0
    (tmp_path / "other").mkdir()
    twin = tmp_path / "other" / "My-Lamp.csv"
    twin.write_text(lamp.read_text())
    line = fails("profile", "--ssf", ssf, *options(), *names, "--illuminant-spd", twin)
    assert "would both be called My-Lamp" in line


@pytest.mark.parametrize(
    ("kelvin", "words"),
    [
        ((5700, 7100), "daylight fluorescent"),
        ((4600, 5500), "day white fluorescent"),
        ((3800, 4500), "cool white fluorescent"),
        ((3250, 3800), "white fluorescent"),
    ],
)
def test_a_lamp_is_the_light_source_that_exif_has_for_its_temperature(kelvin, words):
    """Exif 2.32, LightSource 12 to 15; CIE 015:2018, table 10.1."""
    lamps = {
        "FL1": 6430, "FL2": 4230, "FL3": 3450, "FL4": 2940, "FL5": 6350, "FL6": 4150,
        "FL7": 6500, "FL8": 5000, "FL9": 4150, "FL10": 5000, "FL11": 4000, "FL12": 3000,
    }  # fmt: skip
    ours = {name for name in lamps if calibration_illuminant(name) == words}
    assert ours == {name for name, t in lamps.items() if kelvin[0] <= t <= kelvin[1]}
    assert calibration_illuminant("D50") == "D50"
    assert {calibration_illuminant(name) for name in ("FL12", "HP1", "x.csv")} == {
        "other"
    }


@pytest.mark.parametrize(
    ("light", "name"),
    [
        ("FL2", "FL2"),
        ("LED-B3", "LED-B3"),
        ("lamps/my lamp.csv", "my-lamp"),
        ("a_b.v2 (new).json", "a_b.v2-new"),
        ("./FL2", "FL2"),
    ],
)
def test_a_lamp_is_called_by_its_word_or_its_file(light, name):
    assert lamp_name(light) == name


BAD = [
    (options(cfa=None, bits=None), "do not tell --cfa, --bits;"),
    (options(size="600"), "--size 600: must be WxH"),
    (options(bits="twelve"), "--bits twelve: must be a whole number"),
    (options(white_level="-4"), "--white-level -4: must be a whole number"),
    (options(cfa="RGGX"), "cfa"),
    ([*options(), "--illuminant-spd", "moonlight"], "'moonlight' is unknown"),
]


@pytest.mark.parametrize(("words", "reason"), BAD, ids=[case[1] for case in BAD])
def test_what_is_wrong_is_said_in_a_line(ssf, words, reason):
    names = ("--make", "Acme", "--model", "One")
    words = [f"{a}={b}" for a, b in zip(words[::2], words[1::2], strict=True)]
    assert reason in fails("profile", "--ssf", ssf, *words, *names)


def test_options_that_do_not_go_together(ssf, tmp_path):
    photo = write_dng(tmp_path / "a.dng")
    line = fails("profile", photo, "--ssf", ssf, "--bits", "12")
    assert "--bits: the files say it" in line
    assert "--bits: " in fails("profile", photo, "--bits", "12")
    assert "needs --ssf" in fails("profile", photo, "--illuminant-spd", "A")
    assert "needs --ssf" in fails("profile", photo, "--ssf-unit", "energy")
    assert "or --ssf" in fails("profile")
    assert "absent.csv" in fails("profile", photo, "--ssf", tmp_path / "absent.csv")
