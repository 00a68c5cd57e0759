# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw sensors: a table that fits, everything of one sensor, and what is broken."""

import json

import pytest

import cg2raw
from cg2raw.profile import sensor_text
from cg2raw.profile.summary import iso_words, kelvin_words, noise_of
from dng import dng_files
from python.commands import fails, run


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """Return an empty folder that is searched for profiles first."""
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(tmp_path))
    return tmp_path


def put(shelf, id, **changes):
    """Put a profile on the shelf: that of the D40 with fields changed."""
    fields = {**dng_files.fields_of(), "id": id, **changes}
    (shelf / f"{id}.json").write_text(json.dumps(fields))


def test_the_table_has_every_sensor_once_and_fits(shelf):
    put(shelf, "a-very-long-camera-name", model="Camera of a very long name " * 4)
    done = run("sensors")
    lines = done.out.splitlines()
    ids = [line.split()[0] for line in lines[1:]]
    assert done.code == 0 and ids == cg2raw.installed_profiles()
    assert "..." not in done.out
    [samsung] = [line for line in lines if line.startswith("samsung-s20fe ")]
    for words in ("4032x3024", "GRBG", "10", "D65", "100-3200 (50-6400)"):
        assert f"  {words}  " in samsung


def test_json_has_what_the_table_has(shelf):
    sensors = json.loads(run("sensors", "--json").out)["sensors"]
    assert [sensor["id"] for sensor in sensors] == cg2raw.installed_profiles()
    [one] = [sensor for sensor in sensors if sensor["id"] == "samsung-s20fe"]
    assert one == json.loads(run("sensors", "samsung-s20fe", "--json").out)
    assert one["noise"]["iso_usable"] == [50, 6400] and one["cfa"] == "GRBG"


def test_all_of_one_sensor_with_its_sources(shelf):
    put(shelf, "mine", sources={"cfa": "from me", "noise": "no one", "remark": "hey"})
    out = run("sensors", "mine").out
    assert "BGGR\n" in out and "from: from me" in out
    assert "0.6992 -0.1668 -0.0806 / -0.8138" in out
    for line in ("white_level 3880 DN", "noise none", "from: no one", "remark hey"):
        assert line in [" ".join(found.split()) for found in out.splitlines()]
    assert max(map(len, out.splitlines())) <= 120


def test_each_source_of_the_bundled_sensors_is_shown():
    for id in cg2raw.installed_profiles():
        shown = " ".join(run("sensors", id).out.split())
        for text in dict(cg2raw.Sensor(id).sources).values():
            assert " ".join(text.split()) in shown


def test_a_path_is_a_sensor_too(shelf, tmp_path):
    put(shelf, "mine")
    assert run("sensors", tmp_path / "mine.json").out == run("sensors", "mine").out
    assert "No such file" in fails("sensors", tmp_path / "yours.json")


def test_an_unknown_id_is_told_the_closest():
    line = fails("sensors", "nikon-d41")
    assert "did you mean nikon-d40?" in line and "installed: " in line
    assert "did you mean" not in fails("sensors", "zzz")
    assert "did you mean nikon-d40?" in fails("sensors", "NIKON-D40")
    assert 'unknown sensor ""' in fails("sensors", "")


def test_broken_profiles_are_named_after_the_rest(shelf):
    put(shelf, "broken", white_level=None)
    (shelf / "worse.json").write_text("{")
    put(shelf, "mine")
    done = run("sensors")
    assert done.code == 1 and "\nmine " in done.out
    first, second = done.err.splitlines()
    assert "broken.json: white_level" in first and "worse.json: is no JSON" in second
    found = run("sensors", "--json")
    errors = json.loads(found.out)["errors"]
    assert [error["id"] for error in errors] == ["broken", "worse"]
    assert found.code == 1


WORDS = {
    None: "-",
    (2854.9, 6502.2): "2855-6502 K",
    (5002.9, 5003.1): "5003 K",
    (1e6 / 600, 3000): "<1667-3000 K",
    (5000, 1e5): "5000->100000 K",
}


@pytest.mark.parametrize("cct", WORDS, ids=WORDS.get)
def test_temperatures_in_words(cct):
    assert kelvin_words(cct) == WORDS[cct]


@pytest.mark.parametrize(
    ("isos", "words"),
    [([], "no noise"), ([100], "100 only"), ([100, 800], "100-800 (50-1600)")],
)
def test_isos_are_those_that_can_be_simulated(isos, words):
    rows = [{"iso": iso, "beta1": [1e-3] * 4, "beta2": [0] * 4} for iso in isos]
    noise, sensor = noise_of(rows), dng_files.sensor(noise=rows)
    assert iso_words(noise) == words
    for iso in noise["iso_usable"] or []:
        sensor.noise_at(iso)
    low, high = noise["iso_usable"] or (100, 100)
    for iso in (low * 0.99, high * 1.01):
        with pytest.raises(ValueError):
            sensor.noise_at(iso)


def test_values_of_large_repeats_are_shown_per_colour():
    cfa = "GBGGRGRGRBGBGBGGRGGRGGBGBGBRGRGRGGBG"
    levels = [float("RGB".index(letter)) for letter in cfa]
    assert sensor_text.per_site(levels, cfa) == "R 0 G 1 B 2"
    assert sensor_text.per_site([7.0] * 36, cfa) == "7"
    assert sensor_text.per_site([1.0, 2.0, 3.0, 4.0], "RGGB") == "1 2 3 4"


def test_a_narrow_terminal_drops_the_sources():
    sensors = json.loads(run("sensors", "--json").out)["sensors"]
    wide, narrow = sensor_text.table(sensors, 200), sensor_text.table(sensors, 110)
    assert max(map(len, wide)) <= 200 and max(map(len, narrow)) <= 110
    assert "sources" in wide[0] and "sources" not in narrow[0]
