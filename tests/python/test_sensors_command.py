# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw sensors: a table that fits, everything of one sensor, and what is broken."""

import io
import json
import re

import numpy as np
import pytest
from rich.console import Console

import cg2raw
from cg2raw.cli import main
from cg2raw.profile import sensor_table, sensor_text
from cg2raw.profile.neutral_mixture import without_neutrals
from cg2raw.profile.summary import illuminants_of, iso_words, kelvin_words, noise_of
from dng import dng_files
from python.commands import fails, run


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """Return an empty folder that is searched for profiles first."""
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(tmp_path))
    return tmp_path


NOISE = "noise none: cg2raw calibrate measures it from darks and flats"


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
    for line in ("white_level 3880 DN", NOISE, "from: no one", "remark hey"):
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
    assert "did you mean nikon-d40, nikon-d5200 or nikon-d850?" in fails(
        "sensors", "nikno"
    )
    assert 'unknown sensor ""' in fails("sensors", "")
    assert 'unknown sensor "?!"' in fails(
        "sensors", "?!"
    )  # not: all that are installed


@pytest.mark.parametrize("word", ["..", ".", "a" * 300])
def test_a_word_that_is_no_id_is_refused(word):
    line = fails("sensors", word)
    assert "must be of lower-case letters" in line and len(line) < 400


def ids(done):
    """Return the first words of a table's rows."""
    assert done.code == 0 and done.err == ""
    return [line.split()[0] for line in done.out.splitlines()[1:]]


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("sony", ["sony-a57", "sony-a7s-ii"]),
        ("SONY", ["sony-a57", "sony-a7s-ii"]),
        ("canon 5d", ["canon-5d", "canon-5d-mark-iv"]),  # of an id
        ("sm-g780", ["samsung-s20fe"]),  # of a model
        ("nikon corp", ["nikon-d40", "nikon-d5200", "nikon-d850"]),  # of a make
        ("NIKON-D40", ["nikon-d40"]),
    ],
)
def test_a_word_finds_sensors_by_id_make_and_model(word, found):
    assert ids(run("sensors", word)) == found
    shown = json.loads(run("sensors", word, "--json").out)
    assert [sensor["id"] for sensor in shown["sensors"]] == found


def test_the_whole_id_of_a_sensor_shows_it_and_no_others():
    assert run("sensors", "canon-5d").out.startswith("id                        canon")


def test_a_search_is_not_about_profiles_that_are_broken(shelf):
    put(shelf, "broken", white_level=None)
    assert ids(run("sensors", "sony")) == ["sony-a57", "sony-a7s-ii"]


def test_a_picture_is_of_one_sensor(tmp_path):
    picture = tmp_path / "lights.png"
    line = fails("sensors", "sony", "--plot", picture)
    assert "the whole ID of a sensor, one of sony-a57, sony-a7s-ii" in line
    line = fails("sensors", "--plot", picture)
    assert line.endswith("the whole ID of a sensor") and not picture.exists()


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


def test_temperatures_are_those_of_the_hull_where_no_neutrals_are_listed():
    sensor = cg2raw.Sensor("samsung-s20fe")
    lights = without_neutrals(sensor.illuminants)
    found = illuminants_of(
        dng_files.sensor("samsung-s20fe", illuminants=lights).profile
    )
    ends = [sensor.illuminant(f"neutral:{r}:{b}").cct for r, b in lights["hull"]]
    assert (found["count"], found["cct"]) == (0, [min(ends), max(ends)])
    assert found["mean"] == list(lights["mean"]) and found["hull"] == lights["hull"]
    assert np.square(found["sd"]) == pytest.approx(np.diag(lights["covariance"]))


WORDS = {
    None: "-",
    (2854.9, 6502.2): "2855-6502 K",
    (5002.9, 5003.1): "5003 K",
    (1e6 / 600, 3000): "below 1667 to 3000 K",
    (5000, 1e5): "5000 to above 100000 K",
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


def rendered(sensors, columns, **options):
    """Return the lines of the terminal's table."""
    console = Console(file=io.StringIO(), width=columns, markup=False, **options)
    console.print(sensor_table.rich_table(sensors, columns))
    return console.file.getvalue().splitlines()


@pytest.fixture
def sensors():
    """Return the summaries of all sensors."""
    return json.loads(run("sensors", "--json").out)["sensors"]


@pytest.mark.parametrize("columns", [60, 80, 100, 132, 160, 250])
def test_a_terminal_breaks_no_word(sensors, columns):
    lines = rendered(sensors, columns)
    shown = {word for line in lines for word in line.split()}
    whole = [" ".join(sensor_table.row_of(sensor)) for sensor in sensors]
    words = {word for text in (*whole, *sensor_table.HEAD) for word in text.split()}
    assert max(map(len, lines)) <= columns
    assert {word for word in shown if set(word) != {"\u2500"}} <= words
    assert {sensor["id"] for sensor in sensors} <= shown


def test_what_has_no_room_is_left_out(sensors):
    heads = {
        columns: rendered(sensors, columns)[0].split() for columns in (30, 80, 200)
    }
    assert heads[30] == ["id"] or heads[30] == ["id", "camera"]
    assert heads[80] == ["id", "camera", "size", "CFA", "illuminants", "ISO"]
    assert heads[200] == list(sensor_table.HEAD)


def test_a_pipe_gets_a_line_for_each_sensor_and_no_escapes(sensors):
    out = run("sensors").out
    assert "\x1b" not in out and out.count("\n") == len(sensors) + 1
    assert max(map(len, out.splitlines())) > 150  # sources are not cut


def test_a_terminal_gets_the_table_in_its_width(monkeypatch, sensors):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    monkeypatch.setattr("sys.stdout", terminal)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("NO_COLOR", "1")
    assert main(["sensors"]) == 0
    assert (
        "sources" not in terminal.getvalue() and "samsung-s20fe" in terminal.getvalue()
    )


def test_names_in_brackets_are_names(shelf):
    put(shelf, "odd", model="Camera [bold] X")
    found = json.loads(run("sensors", "odd", "--json").out)
    [line] = [text for text in rendered([found], 200) if text.startswith("odd ")]
    assert "Camera [bold] X" in line


@pytest.mark.parametrize(
    ("encoding", "places"),
    [
        ("ascii", "_.:-=+*#"),
        ("utf-8", "".join(map(chr, range(0x2581, 0x2589)))),
    ],
)
def test_a_curve_is_a_character_for_every_10_nm(encoding, places):
    """Its eighth of the height; what is beyond 0 and 1 is drawn there."""
    wavelengths = np.arange(400, 471, 5.0)
    heights = np.array([0, 1, 2, 4, 7, 5, 3.6, 0]) / 7
    values = np.interp(wavelengths, wavelengths[::2], heights)
    values[0], values[8] = -0.2, 1.3
    line = sensor_text.curve_line(wavelengths, values, encoding)
    assert [places.index(one) for one in line] == [0, 1, 2, 4, 7, 5, 4, 0]


def test_colour_matrices_are_numbered_as_the_fields_of_a_profile():
    shown = run("sensors", "nikon-d40").out
    for number, light in ((1, "A"), (2, "D65")):
        assert re.search(rf"calibration_illuminant_{number} +{light}\b", shown)
        assert f"color_matrix_{number} " in shown
    assert "_3" not in shown
    one = {"light_source": "A", "camera_from_xyz": np.eye(3) / 3}
    forward = [[0.6, 0.2, 0.1642], [0.3, 0.7, 0.0], [0.0, 0.1, 0.7251]]
    identity = "0.3333 0.0000 0.0000 / 0.0000 0.3333 0.0000 / 0.0000 0.0000 0.3333"
    assert sensor_text.calibration_fields(
        [one | {"xyz_d50_from_camera": forward}, one | {"xyz_d50_from_camera": None}]
    ) == [
        ("calibration_illuminant_1", "A"),
        ("color_matrix_1", identity),
        (
            "forward_matrix_1",
            "0.6000 0.2000 0.1642 / 0.3000 0.7000 0.0000 / 0.0000 0.1000 0.7251",
        ),
        ("calibration_illuminant_2", "A"),
        ("color_matrix_2", identity),
    ]
