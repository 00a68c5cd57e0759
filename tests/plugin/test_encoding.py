# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What the plugin takes whole numbers for."""

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from dataset.data_sets import write_image
from images import attributes, read_dn
from python import commands

D40 = attributes(sensor="nikon-d40", illuminant="D65", preview=0)
CODES = np.linspace(0, 1023, 24 * 36 * 3).astype(np.uint16).reshape(24, 36, 3)
CODES = CODES << 6 | CODES >> 4  # ten bits in sixteen
LINEAR = ("--iscolorspace", "lin_rec709")
SRGB = tuple(attributes(linearize="srgb"))


def srgb_of_specification(numbers):
    """Return light of sRGB values 0..1. Source: IEC 61966-2-1."""
    curve = ((numbers + 0.055) / 1.055) ** 2.4
    return np.where(numbers <= 0.04045, numbers / 12.92, curve).astype(np.float32)


LIGHT = {
    SRGB: srgb_of_specification(CODES / 65535),
    LINEAR: (CODES / 65535).astype(np.float32),
}


@pytest.mark.parametrize("said", LIGHT)
def test_whole_numbers_of_ten_bits(oiiotool, tmp_path, said):
    """The sensor has 12 bits; those of the file are no request for its own."""
    path = write_image(tmp_path / "in.dpx", CODES, "uint16", oiio__BitsPerSample=10)
    out = tmp_path / "shot.dng"
    oiiotool(path, *said, *D40, "-o", out)
    expected = cg2raw.Sensor("nikon-d40").simulate(LIGHT[said], illuminant="D65")
    np.testing.assert_array_equal(read_dn(out), expected)


def test_whole_numbers_that_say_nothing_are_refused(oiiotool, tmp_path):
    path = write_image(tmp_path / "in.dpx", CODES, "uint16", oiio__BitsPerSample=10)
    done = oiiotool(path, *D40, "-o", tmp_path / "shot.dng", check=False)
    assert done.returncode and "--attrib dng:linearize srgb" in done.stderr
    assert "bits" not in done.stderr


def test_floats_and_linear_pixels_have_no_curve_to_undo(oiiotool, exr, tmp_path):
    for said in ((), LINEAR):
        out = tmp_path / "shot.dng"
        done = oiiotool(exr, *said, *SRGB, *D40, "-o", out, check=False)
        assert done.returncode and "--attrib dng:linearize srgb: its" in done.stderr


@pytest.mark.usefixtures("writing_openimageio")
def test_what_imagebuf_writes(tmp_path):
    path, out = tmp_path / "in.tif", str(tmp_path / "shot.dng")
    image = oiio.ImageBuf(str(write_image(path, CODES, "uint16")))
    image.specmod().attribute("dng:sensor", "nikon-d40")
    image.specmod().attribute("dng:illuminant", "D65")
    assert not image.write(out)
    assert "--attrib dng:linearize srgb" in image.geterror()
    image.specmod().attribute("dng:linearize", "srgb")
    assert image.write(out), image.geterror()
    expected = cg2raw.Sensor("nikon-d40").simulate(LIGHT[SRGB], illuminant="D65")
    np.testing.assert_array_equal(read_dn(out), expected)


def test_alpha_by_the_host_as_by_convert(oiiotool, tmp_path):
    """The host's own multiplication would round to 8 bits, before the curve."""
    pixels = np.dstack([CODES >> 8, np.linspace(0, 255, 24 * 36).reshape(24, 36)])
    attributes = {"oiio__UnassociatedAlpha": 1}
    path = write_image(tmp_path / "cut.png", np.uint8(pixels), "uint8", **attributes)
    out, same = tmp_path / "a.dng", tmp_path / "b.dng"
    keep = ("-iconfig", "oiio:UnassociatedAlpha", 1)
    oiiotool(*keep, path, *SRGB, *D40, "-o", out)
    options = "--sensor nikon-d40 --illuminant D65 --linearize srgb --no-preview"
    done = commands.run("convert", path, "-o", same, *options.split())
    assert (done.code, done.err) == (0, "")
    np.testing.assert_array_equal(read_dn(out), read_dn(same))
