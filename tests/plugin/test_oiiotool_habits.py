# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What people do to images before -o: resize, crop, tiles, parts, data formats."""

import json
import subprocess

import numpy as np
import pytest

import cg2raw
from images import attributes, read_dn, write_image
from tiers import first_fast

S20 = attributes(sensor="samsung-s20fe", illuminant="D65")


def simulated(scene):
    return cg2raw.Sensor("samsung-s20fe").simulate(scene, illuminant="D65")


def test_resize_and_cut(oiiotool, exr, scene, tmp_path):
    out = tmp_path / "shot.dng"
    oiiotool(exr, "--resize", "63x41", *S20, "-o", out)
    assert read_dn(out).shape == (41, 63)
    oiiotool(exr, "--cut", "50x40+10+6", *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene[6:46, 10:60]))


def test_crop_keeps_the_display_window(oiiotool, exr, scene, tmp_path):
    out = tmp_path / "shot.dng"
    oiiotool(exr, "--crop", "50x40+10+6", *S20, "-o", out)
    expected = np.zeros_like(scene)
    expected[6:46, 10:60] = scene[6:46, 10:60]
    np.testing.assert_array_equal(read_dn(out), simulated(expected))


@pytest.mark.parametrize("data_format", ["uint8", "uint10", "uint16", "half", "float"])
def test_data_format_of_the_output_does_not_matter(
    oiiotool, exr, scene, tmp_path, data_format
):
    out = tmp_path / "shot.dng"
    oiiotool(exr, "-d", data_format, *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene))


def test_bits_that_the_sensor_has_not_are_an_error(oiiotool, exr, tmp_path):
    out = tmp_path / "shot.dng"
    done = oiiotool(exr, "-d", "uint12", *S20, "-o", out, check=False)
    assert done.returncode != 0
    assert "10 bits" in done.stdout + done.stderr
    assert not out.exists()


@pytest.mark.parametrize("tile", [16, 64])
def test_tiled_input(oiiotool, scene, tmp_path, tile):
    exr = write_image(tmp_path / "tiled.exr", scene, tile=tile)
    out = tmp_path / "shot.dng"
    oiiotool(exr, *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene))
    oiiotool(exr, "--tile", tile, tile, *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene))


def test_subimages(oiiotool, scene, tmp_path):
    parts = tmp_path / "parts.tif"
    first = write_image(tmp_path / "a.exr", scene)
    second = write_image(tmp_path / "b.exr", scene[::-1].copy())
    oiiotool(first, second, "--siappend", "-o", parts)
    out = tmp_path / "shot.dng"
    oiiotool(parts, "--subimage", 1, *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene[::-1]))


def test_alpha_is_ignored(oiiotool, scene, tmp_path):
    alpha = np.full((96, 128, 1), 0.25, np.float32)
    exr = write_image(tmp_path / "rgba.exr", np.concatenate([scene, alpha], axis=-1))
    out = tmp_path / "shot.dng"
    oiiotool(exr, *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene))


def test_pixels_that_are_no_numbers(oiiotool, scene, tmp_path):
    pixels = scene.copy()
    pixels[5, 5] = np.nan
    pixels[6, 6] = np.inf
    pixels[7, 7] = -np.inf
    pixels[8, 8] = -3.0
    exr = write_image(tmp_path / "ugly.exr", pixels)
    out = tmp_path / "shot.dng"
    debug = {"OPENIMAGEIO_DEBUG": "1"}
    done = oiiotool(exr, *S20, *attributes(compression="none"), "-o", out, env=debug)
    dn = read_dn(out)
    assert (dn[5, 5], dn[6, 6], dn[7, 7], dn[8, 8]) == (64, 1023, 64, 64)
    assert "3 NaN" in done.stdout + done.stderr
    assert "6 infinite" in done.stdout + done.stderr


def exif_of(program, path):
    """Return what exiftool reads of a file's Exif."""
    command = [program("exiftool"), "-j", "-n", path]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)[
        0
    ]


def test_exif_of_the_input_goes_into_the_file(oiiotool, exr, program, tmp_path):
    out = tmp_path / "shot.dng"
    given = {
        "ExposureTime": "0.008",
        "FNumber": "2.8",
        "Exif:FocalLength": "35",
        "DateTime": "2026:03:04 05:06:07",
        "Artist": "A. Tester",
        "Orientation": "6",
    }
    arguments = [word for pair in given.items() for word in ("--attrib", *pair)]
    oiiotool(exr, *arguments, *S20, *attributes(iso=400), "-o", out)
    seen = exif_of(program, out)
    assert seen["ExposureTime"] == pytest.approx(1 / 125)
    assert seen["FNumber"] == pytest.approx(2.8)
    assert seen["FocalLength"] == pytest.approx(35)
    assert seen["ISO"] == 400
    assert seen["DateTimeOriginal"] == given["DateTime"]
    assert seen["Artist"] == given["Artist"]
    assert seen["Orientation"] == 6


def test_primaries_that_the_file_states(oiiotool, scene, tmp_path):
    ap1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    rec709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
    out = tmp_path / "shot.dng"
    for primaries in (ap1, rec709):
        value = ("chromaticities", "float[8]", primaries)
        exr = write_image(tmp_path / "in.exr", scene, typed=[value])
        done = oiiotool(exr, *S20, "-o", out, check=False)
        assert (done.returncode == 0) == (primaries is rec709), done.stderr
        said = done.stdout + done.stderr
        assert ("--iscolorspace ACEScg --tocolorspace" in said) == (primaries is ap1)


@pytest.mark.parametrize(
    "space", first_fast(["Linear Rec.709 (sRGB)", "lin_rec709"], 1)
)
def test_a_conversion_outweighs_the_primaries_it_left(
    oiiotool, repository, scene, tmp_path, space
):
    """An ACEScg render at the first try; its EXR says AP1 to the end."""
    ap1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    value = ("chromaticities", "float[8]", ap1)
    exr = write_image(tmp_path / "in.exr", scene, typed=[value])
    out, same = tmp_path / "shot.dng", tmp_path / "same.dng"
    config = {"OCIO": str(repository / "ocio/sensors.ocio")}
    convert = ["--iscolorspace", "ACEScg", "--tocolorspace", space]
    oiiotool(exr, *convert, *S20, "-o", out, env=config)
    erase = ["--eraseattrib", "chromaticities"]
    oiiotool(exr, *convert, *erase, *S20, "-o", same, env=config)
    assert out.read_bytes() == same.read_bytes()
    assert (read_dn(out) != simulated(scene)).mean() > 0.5  # it was converted
