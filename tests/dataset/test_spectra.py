# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Data sets of spectral images: the files of convert, the manifest, errors."""

import numpy as np
import pytest

from dataset.data_sets import (
    check_agreement,
    contents,
    rows,
    scene,
    write_image,
    write_spectra,
)
from images import read_dn
from python.commands import fails, run

ASKED = [
    *("--sensors", "canon-600d,nikon-d850", "--illuminants", "FL2,estimate:mean"),
    *("--convention", "spectral", "--white-luminance", "40000"),
]


@pytest.fixture
def folder(tmp_path):
    """A folder of one spectral image and one picture."""
    write_image(tmp_path / "in" / "picture.exr", scene())
    write_spectra(tmp_path / "in" / "spectra.exr")
    return tmp_path / "in"


def test_files_are_those_of_convert(folder, tmp_path):
    path, out = folder / "spectra.exr", tmp_path / "out"
    assert run("dataset", path, out, *ASKED).code == 0
    check_agreement(out)
    found = rows(out)
    assert len(found) == 4
    for row in found:
        words = ["--sensor", row["sensor"], "--illuminant", row["illuminant"]]
        words += ["--white-luminance", 40000]
        done = run("convert", path, "-o", tmp_path / "one.dng", *words)
        assert done.code == 0, done.err
        pixels = read_dn(out / row["path"])
        assert np.array_equal(pixels, read_dn(tmp_path / "one.dng"))
        assert len(np.unique(pixels)) > 100
        assert row["white_luminance"] == 40000.0
        assert row["transform_first"] is None and len(row["camera_from_xyz"]) == 9
    # Each sensor has its own neutral of the light, and of the image's mean.
    assert len({tuple(row["neutral"]) for row in found}) == 4


def test_pictures_and_spectra_lie_in_one_folder(folder, tmp_path):
    words = [w if w != "FL2,estimate:mean" else "FL2" for w in ASKED]
    assert run("dataset", folder, tmp_path / "out", *words).code == 0
    found = rows(tmp_path / "out")
    assert len({row["path"] for row in found}) == 4
    for name, white, spectrum in (
        ("picture.exr", None, "FL2"),
        ("spectra.exr", 40000.0, None),
    ):
        of_input = [row for row in found if row["input"] == name]
        assert {row["white_luminance"] for row in of_input} == {white}
        assert {row["spectrum"] for row in of_input} == {spectrum}


def test_workers_crops_and_a_second_run_change_nothing(folder, tmp_path):
    path = folder / "spectra.exr"
    crops = ["--patch-size", "16", "--patches", "3"]
    crops += ["--format", "npy"]
    for name, workers in (("one", 1), ("two", 2)):
        words = [path, tmp_path / name, *ASKED, *crops, "--workers", workers]
        assert run("dataset", *words).code == 0
    assert contents(tmp_path / "one") == contents(tmp_path / "two")
    done = run("dataset", path, tmp_path / "one", *ASKED, *crops)
    assert done.code == 0 and "12 of them kept" in done.out


def test_white_is_what_the_file_says(tmp_path):
    write_spectra(tmp_path / "s.exr", whiteLuminance=500.0)
    words = [w for w in ASKED if w not in ("--white-luminance", "40000")]
    assert run("dataset", tmp_path / "s.exr", tmp_path / "out", *words).code == 0
    assert {row["white_luminance"] for row in rows(tmp_path / "out")} == {500.0}


WRONG = {
    "no white": (["--illuminants", "A", "--convention", "sensor"], "which luminance"),
    "rgb": (["--illuminants", "A", "--white-luminance", "9"], "--convention spectral"),
    "drawn": ([*ASKED[4:], "--illuminants", "3"], "--illuminants 3 draws others"),
    "gain": ([*ASKED[2:], "--digital-gain", "1,2"], "--digital-gain is of RGB"),
    "luminance": (
        [*ASKED[2:], "--scene-luminance", "100", "--exposure-time", "1/60"],
        "their luminance is known; leave --scene-luminance out",
    ),
    "nothing stated": ([*ASKED[4:], "--illuminants", "estimate"], "states no light"),
    "upi": (["--illuminants", "2", "--method", "upi"], "--method upi is of RGB"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_does_not_go_together_is_listed(folder, tmp_path, case):
    words, message = WRONG[case]
    path, out = folder / "spectra.exr", tmp_path / "out"
    done = run("dataset", path, out, "--sensors", "canon-600d", *words)
    first, last = done.err.splitlines()
    assert done.code == 1 and "1 of 1 images could not be used" in last
    assert first.startswith("cg2raw dataset: spectra.exr: ") and message in first
    assert not list(out.rglob("*.dng"))


def test_sensors_need_sensitivities(folder, tmp_path):
    words = ["--sensors", "nikon-d40", "--illuminants", "A", "--convention", "sensor"]
    words += ["--white-luminance", "9"]
    done = run("dataset", folder / "spectra.exr", tmp_path / "out", *words)
    assert done.code == 1
    assert "sensor nikon-d40 has no spectral_sensitivities: leave it out" in done.err


def test_pictures_have_no_light_to_estimate(folder, tmp_path):
    done = run("dataset", folder / "picture.exr", tmp_path / "out", *ASKED)
    assert done.code == 1
    assert "has no spectrum for --illuminants estimate:mean" in done.err


def test_lights_are_named_once(folder, tmp_path):
    words = ["--illuminants", "estimate,ESTIMATE", "--sensors", "canon-600d"]
    line = fails("dataset", folder, tmp_path / "out", *words)
    assert "estimate and ESTIMATE are the same" in line
