# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw ocio: a config from a command line, the same with every OpenColorIO."""

import json
import sys

import PyOpenColorIO as ocio
import pytest

import cg2raw
from dng import dng_files
from ocio.conversion import SCENE, camera, converted, difference, pixels, system_python
from python.commands import fails, run

PAIRS = ("--sensors", "samsung-s20fe,nikon-d40", "--illuminants", "A,3200K,sample:0-1")
ONE = ("--sensors", "nikon-d40", "--illuminants", "A")


def read(path):
    """Return the config of a file that must be valid."""
    config = ocio.Config.CreateFromFile(str(path))
    config.validate()
    return config


def raw_names(config):
    """Return the names of the RAW spaces that a menu shows."""
    names = [space.getName() for space in config.getColorSpaces()]
    return [name for name in names if name.startswith("RAW - ")]


def test_a_space_for_each_pair_in_their_order(tmp_path):
    done = run("ocio", *PAIRS, "-o", tmp_path / "sensors.ocio")
    assert done.code == 0 and "8 RAW spaces, config version 2.1" in done.out
    assert raw_names(read(tmp_path / "sensors.ocio")) == [
        f"RAW - {sensor} - {light}"
        for sensor in ("samsung-s20fe", "nikon-d40")
        for light in ("A", "3200K", "sample:0", "sample:1")
    ]


@pytest.mark.parametrize(
    ("options", "keywords"),
    [
        ((), {}),
        (("--convention", "paper"), {"convention": "paper"}),
        (("--digital-gain", 0.7), {"gain": 0.7}),
        (("--no-highlights",), {"highlights": False}),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, tuple) else "",
)
def test_options_reach_the_pixels(tmp_path, options, keywords):
    run("ocio", *ONE, *options, "-o", tmp_path / "one.ocio")
    found = converted(read(tmp_path / "one.ocio"), SCENE, "raw_nikon_d40_a", pixels())
    expected = camera("nikon-d40", "A", pixels(), **keywords)
    assert difference(found, expected) <= 0.3
    if keywords:  # and they do something
        assert difference(found, camera("nikon-d40", "A", pixels())) > 100


def test_all_sensors(tmp_path):
    run("ocio", "--sensors", "all", "--illuminants", "D65", "-o", tmp_path / "a.ocio")
    expected = [f"RAW - {id} - D65" for id in cg2raw.installed_profiles()]
    assert raw_names(read(tmp_path / "a.ocio")) == expected


def test_a_profile_of_ones_own(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({**dng_files.fields_of(), "id": "mine"}))
    sensors = f"{path},nikon-d40"
    run("ocio", "--sensors", sensors, "--illuminants", "A", "-o", tmp_path / "a.ocio")
    names = raw_names(read(tmp_path / "a.ocio"))
    assert names == ["RAW - mine - A", "RAW - nikon-d40 - A"]


@pytest.mark.parametrize("output", [(), ("-o", "-")])
def test_stdout_is_the_config_alone(tmp_path, output):
    run("ocio", *PAIRS, "-o", tmp_path / "sensors.ocio")
    done = run("ocio", *PAIRS, *output)
    assert done.out == (tmp_path / "sensors.ocio").read_text() and done.err == ""


@pytest.mark.parametrize(("version", "minor"), [("2.0", 0), ("2.1", 1)])
def test_the_version_asked_for(tmp_path, version, minor):
    run("ocio", *ONE, "--profile-version", version, "-o", tmp_path / "a.ocio")
    config = read(tmp_path / "a.ocio")
    assert (config.getMajorVersion(), config.getMinorVersion()) == (2, minor)


def test_the_same_bytes_with_the_systems_opencolorio(tmp_path, build_folder):
    system_python(
        build_folder, "-m", "cg2raw", "ocio", *PAIRS, "-o", tmp_path / "old.ocio"
    )
    run("ocio", *PAIRS, "-o", tmp_path / "new.ocio")
    old, new = (tmp_path / f"{name}.ocio" for name in ("old", "new"))
    assert old.read_bytes() == new.read_bytes()


WRONG = {
    ("nikon-d41", "A"): "did you mean nikon-d40? installed: ",
    ("nikon-d40,", "A"): 'unknown sensor ""; installed: ',
    ("nikon-d40,nikon-d40", "A"): "--sensors: nikon-d40 and nikon-d40 are the same",
    ("nikon-d40", "D65,d65"): "--illuminants: D65 and d65 are the same",
    ("nikon-d40", "sample:2,sample:0-3"): "sample:2 and sample:2 are the same",
    ("nikon-d40", "candle"): "unknown illuminant candle; it may be: A, D50",
    ("nikon-d40", "900K"): "1667",
    ("nikon-d40", "A,As-Shot"): "needs a DNG, whose AsShotNeutral it is",
    ("/nowhere/x.json", "A"): "/nowhere/x.json: No such file",
}


@pytest.mark.parametrize("words", WRONG, ids=",".join)
def test_a_list_that_is_wrong(tmp_path, words):
    sensors, illuminants = words
    line = fails(
        "ocio", "--sensors", sensors, "--illuminants", illuminants,
        "-o", tmp_path / "a.ocio",
    )  # fmt: skip
    assert WRONG[words] in line and not list(tmp_path.iterdir())


def test_a_sensor_that_cannot_be_sampled_is_named(tmp_path):
    fields = {**dng_files.fields_of(), "id": "poor", "illuminants": {"neutrals": []}}
    for name in ("color_matrix", "forward_matrix", "calibration_illuminant"):
        fields.pop(f"{name}_2", None)
    path = tmp_path / "poor.json"
    path.write_text(json.dumps(fields))
    line = fails("ocio", "--sensors", f"nikon-d40,{path}", "--illuminants", "sample:3")
    assert "--illuminants sample:3: not with poor: " in line


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("-o", "a.txt"), "must end in .ocio"),
        (("-o", "/nowhere/a.ocio"), "there is no folder /nowhere"),
        (("--context",), "needs -o"),
        (("--context", "--merge", "ocio://default"), "does not go with --merge"),
        (("--merge", "ocio://default", "--profile-version", "2.0"), "does not go with"),
        (("--cube-size", "33"), "needs --cube"),
        (("--cube-input", "srgb"), "needs --cube"),
        (("--ctf", "-"), "must name a file"),
        (("--digital-gain", "-1"), "digital gain -1 must be above 0"),
    ],
)
def test_options_that_cannot_be(options, words):
    assert words in fails("ocio", *ONE, *options)


@pytest.mark.parametrize(
    "option", [("--profile-version", "1"), ("--digital-gain", "much")]
)
def test_a_wrong_command_line_is_usage(option):
    fails("ocio", *ONE, *option, code=2)


def test_without_opencolorio_the_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "PyOpenColorIO", None)
    line = fails("ocio", *ONE)
    assert "pip install opencolorio" in line and "python3-pyopencolorio" in line


def test_many_spaces_are_told_of_context(tmp_path):
    done = run(
        "ocio", "--sensors", "nikon-d40", "--illuminants", "sample:0-200",
        "-o", tmp_path / "a.ocio",
    )  # fmt: skip
    assert done.code == 0 and "201 RAW spaces load slowly; see --context" in done.err
