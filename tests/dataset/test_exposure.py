# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""An image is exposed once, whatever its files; the manifest makes them again."""

import math

import numpy as np
import pytest
import rawpy

import cg2raw
from cg2raw.dataset import sensor_of
from cg2raw.io.image_file import read_image
from dataset.data_sets import rows, write_image, write_spectra
from match.match_sets import match_file
from python.commands import fails, run

OPTIONS = "--sensors samsung-s20fe,nikon-d40 --illuminants A,D65".split()
RAMP = np.linspace(0.01, 0.4, 64 * 48, dtype=np.float32).reshape(48, 64)
EV = "--digital-gain 1 --bracket=-1,1 --exposure-time 1/60 --exposure=0.5"


@pytest.fixture
def images(tmp_path):
    for n in range(2):
        ramp = np.repeat(RAMP[:, :, None] * 2.0**-n, 3, axis=2)
        write_image(tmp_path / f"in/{n}.exr", ramp)
    return tmp_path / "in"


def made(images, out, words):
    words = words.replace("MATCH", match_file(images.parent))
    done = run("dataset", images, out, *OPTIONS, *words.split())
    assert done.code == 0, done
    return list(rows(out))


@pytest.mark.parametrize(
    "words",
    [
        "--exposure random:-1:1 --iso clean,800 --sensors samsung-s20fe",
        "--exposure normal:0:1 --crop 16x16 --patches 2",
        "--exposure auto --crop 16x16 --patches 2 --method upi --illuminants 2",
    ],
)
def test_all_files_of_an_image_have_its_exposure(images, tmp_path, words):
    found = {}
    for row in made(images, tmp_path / "out", words):
        found.setdefault(row["input"], set()).add(row["exposure"])
    assert [len(stops) for stops in found.values()] == [1, 1]
    first, second = (stops.pop() for stops in found.values())
    assert first != second
    if "auto" in words:  # of the whole image, not of its crops
        assert second - first == pytest.approx(1, abs=0.01)
        assert first == pytest.approx(math.log2(0.8 / (0.98 * 0.4)), abs=0.02)


@pytest.mark.parametrize(
    "words",
    [
        "--exposure random:-1:1 --iso clean,800 --sensors samsung-s20fe",
        "--exposure auto --crop 32x32",
        "--exposure MATCH --crop 32x32 --sensors samsung-s20fe",
        "--scene-luminance 900 --f-number 2 --exposure auto --iso 800 --sensors "
        "samsung-s20fe",
        "--bracket=-2,0,2 --exposure-time 1/60 --exposure=0.3 --iso 800 --sensors "
        "samsung-s20fe",
    ],
)
def test_a_row_makes_its_file_again(images, tmp_path, words):
    for row in made(images, tmp_path / "out", words):
        x, y, width, height = row["crop"]
        pixels = read_image(images / row["input"], row["layer"], undo="stated").pixels
        names = ("illuminant", "iso", "noise", "seed", "frame", "digital_gain")
        names += ("convention", "exposure", "exposure_time", "bracket")
        raw = sensor_of(tmp_path / "out", row).simulate(
            pixels[y : y + height, x : x + width], **{name: row[name] for name in names}
        )
        with rawpy.imread(str(tmp_path / "out" / row["path"])) as read:
            np.testing.assert_array_equal(read.raw_image_visible, raw)


def test_a_bracket_is_files_of_their_own(images, tmp_path):
    found = made(images, tmp_path / "out", EV)
    assert len(found) == 2 * 2 * 2 * 2
    for row in found:
        assert f"_ev{row['bracket']:+g}." in row["path"] and row["exposure"] == 0.5
        shot = cg2raw.read_dng_metadata(tmp_path / "out" / row["path"]).shot
        assert shot["exposure_bias"] == row["bracket"] + 0.5
        assert shot["exposure_time"] == pytest.approx(
            2 ** row["bracket"] / 60, rel=1e-4
        )


def test_spectra_are_metered_by_each_sensor(tmp_path):
    (tmp_path / "in").mkdir()
    write_spectra(tmp_path / "in/a.exr", whiteLuminance=100.0)
    words = "--sensors canon-600d --illuminants A,D65 --convention spectral"
    out = tmp_path / "out"
    done = run("dataset", tmp_path / "in", out, *words.split(), "--exposure", "auto")
    assert done.code == 0, done
    stops = [row["exposure"] for row in rows(out)]
    assert len(set(stops)) == 2 and all(abs(one) < 40 for one in stops)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--bracket=1", "is not known: add --exposure-time 1/60"),
        ("--scene-luminance 9 --f-number 2", "without --exposure-time: add"),
    ],
)
def test_settings_that_images_lack_are_named(images, tmp_path, words, message):
    done = run("dataset", images, tmp_path / "out", *OPTIONS, *words.split())
    assert done.code == 1 and message in done.err.splitlines()[0]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--exposure bright", "--exposure: exposure"),
        ("--exposure random:1:0", "LOW not above HIGH"),
        ("--bracket=1,x --exposure-time 1", "--bracket x: must be a number"),
        ("--scene-luminance 0", "--scene-luminance"),
    ],
)
def test_bad_exposures_are_one_line(images, tmp_path, words, message):
    line = fails("dataset", images, tmp_path / "out", *OPTIONS, *words.split())
    assert message in line
