# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A monochrome sensor through the commands: each works, or says in one line why not."""

import json
import re
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from cg2raw import cfa
from cg2raw.upi import Upi
from oracles import cameras
from python.commands import fails, run

SHAPE = (48, 64)


@pytest.fixture
def profile(tmp_path):
    path = tmp_path / "mono.json"
    path.write_text(cameras.mono_text(id="mono"))
    return path


@pytest.fixture
def exr(tmp_path):
    """Return the path of a render of random colours."""
    path = tmp_path / "renders" / "shot.exr"
    path.parent.mkdir()
    pixels = np.random.default_rng(1).random((*SHAPE, 3), np.float32) * 0.8
    oiio.ImageBuf(pixels).write(str(path))
    return path


@pytest.fixture
def dng(tmp_path, profile, exr):
    path = tmp_path / "mono.dng"
    done = run("convert", exr, "-o", path, "--sensor", profile, "--iso", 100)
    assert (done.code, done.err) == (0, "")
    return path


def test_sensors_shows_it(profile):
    done = run("sensors", profile)
    assert done.code == 0
    assert re.search(r"^cfa +MONO$", done.out, re.M)
    assert re.search(r"^illuminants +none: monochrome, all are alike$", done.out, re.M)
    assert "color_matrix" not in done.out
    found = json.loads(run("sensors", profile, "--json").out)
    assert (found["calibrations"], found["black_level"]) == ([], [512.0])


def test_the_list_of_sensors_has_it(profile, monkeypatch):
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(profile.parent))
    (row,) = (line for line in run("sensors").out.splitlines() if "mono " in line[:6])
    assert " mono " in row and " any " in row


def test_there_are_no_illuminants_to_draw(profile, tmp_path):
    line = fails("sensors", profile, "--plot", tmp_path / "x.png")
    assert "mono is monochrome" in line and "leave --plot out" in line


def test_convert_says_no_light_that_nobody_named(profile, exr, tmp_path):
    done = run("convert", exr, "-o", tmp_path / "a.dng", "--sensor", profile)
    assert done.code == 0 and "64x48, mono\n" in done.out
    named = ("--illuminant", "A")
    done = run("convert", exr, "-o", tmp_path / "a.dng", "--sensor", profile, *named)
    assert "64x48, mono, A (" in done.out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--illuminant", "sample:3"), "monochrome and has no neutrals"),
        (("--convention", "paper"), "convention paper"),
        (("--matrices", "exact"), "matrices exact"),
        (("--method", "upi"), "UPI draws colour matrices"),
        (("--iscolorspace", "RAW - mono - D65"), "has no RAW colour space"),
    ],
)
def test_convert_refuses_what_is_of_colours(
    words, said, profile, exr, tmp_path, monkeypatch
):
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(profile.parent))
    line = fails("convert", exr, "-o", tmp_path / "a.dng", "--sensor", profile, *words)
    assert said in line and "mono" in line
    assert not (tmp_path / "a.dng").exists()


def test_a_reference_needs_no_light_either(dng, exr, tmp_path):
    again = tmp_path / "again.dng"
    done = run("convert", exr, "-o", again, "--reference", dng, "--iso", 100)
    assert done.code == 0, done.err
    assert cg2raw.Sensor.from_dng(again).cfa == "MONO"


def test_profile_reads_its_dng(dng, tmp_path):
    made = tmp_path / "made.json"
    done = run("profile", dng, "-o", made)
    assert done.code == 0
    assert "CFA       mono, 64 x 48" in done.out
    assert "matri" not in done.out and "neutral" not in done.out
    assert cg2raw.Sensor(made).cfa == "MONO"


def test_noise_by_hand_is_one_pair(dng, tmp_path):
    made = tmp_path / "made.json"
    run("profile", dng, "-o", made, "--iso-noise", "400:4e-4,9e-6")
    row = next(row for row in cg2raw.Sensor(made).noise if row["iso"] == 400)
    assert (row["beta1"], row["beta2"]) == ([4e-4], [9e-6])
    pairs = "400:4e-4,9e-6,4e-4,9e-6,4e-4,9e-6"
    line = fails("profile", dng, "-o", tmp_path / "b.json", "--iso-noise", pairs)
    assert "monochrome sensor has one pair" in line


def test_render_develops_a_grey_picture(dng, tmp_path):
    out = tmp_path / "look.png"
    assert run("render", dng, "-o", out).code == 0
    picture = oiio.ImageBuf(str(out)).get_pixels(oiio.UINT8)
    assert picture.shape == (*SHAPE, 3)
    assert (picture == picture[..., :1]).all() and np.ptp(picture) > 50


def test_ocio_has_no_space_of_it(profile, tmp_path, monkeypatch):
    pytest.importorskip("PyOpenColorIO")
    words = ("--illuminants", "D65", "-o", tmp_path / "x.ocio")
    line = fails("ocio", "--sensors", profile, *words)
    assert "--sensors mono: is monochrome" in line
    color = profile.parent / "colored.json"
    color.write_text(cameras.profile_text(id="colored"))
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(profile.parent))
    monkeypatch.setattr(cg2raw._core, "installed_profiles", lambda: ["mono", "colored"])
    done = run("ocio", "--sensors", "all", *words)
    assert done.code == 0
    assert "mono is monochrome and has no RAW colour space: skipped" in done.err
    text = (tmp_path / "x.ocio").read_text()
    assert "RAW - colored - D65" in text and "RAW - mono" not in text


def test_a_data_set_has_it_under_named_lights(profile, exr, tmp_path):
    pytest.importorskip("pyarrow")
    words = ("dataset", exr.parent, tmp_path / "out", "--sensors", profile)
    line = fails(*words, "--illuminants", 2)
    assert "--illuminants 2: draws neutrals, and mono is monochrome" in line
    assert "packs 2x2 Bayer" in fails(*words, "--illuminants", "D65", "--format", "npy")
    done = run(*words, "--illuminants", "D65", "--iso", "clean,100")
    assert done.code == 0, done.err
    rows = (tmp_path / "out" / "manifest.jsonl").read_text().splitlines()
    row = json.loads(rows[0])
    assert (row["cfa"], row["neutral"], row["camera_from_xyz"]) == (
        "MONO",
        [1.0, 1.0, 1.0],
        None,
    )


def test_upi_is_for_colours(profile):
    with pytest.raises(ValueError, match="mono is monochrome: take the sensor itself"):
        Upi(profile)


def test_a_cfa_s_word_is_not_counted():
    """ "MONO" has four letters and one site: what counts goes by cfa.sites_of."""
    counted = re.compile(r"len\((?!sites_of)[\w.\[\]\"']*cfa\b")
    folder = Path(cfa.__file__).resolve().parent
    wrong = [
        f"{path.relative_to(folder)}: {line.strip()}"
        for path in sorted(folder.rglob("*.py"))
        for line in path.read_text().splitlines()
        if counted.search(line)
    ]
    assert wrong == []
    assert counted.search("sites = len(sensor.cfa)")


@pytest.mark.parametrize(
    ("word", "letters", "side"),
    [("mono", "G", 1), ("MONO", "G", 1), ("grbg", "GRBG", 2), ("R" * 36, "R" * 36, 6)],
)
def test_sites_of_a_cfa(word, letters, side):
    assert (cfa.sites_of(word), cfa.repeat_of(word)) == (letters, side)
    assert cfa.is_mono(word) == (side == 1)
