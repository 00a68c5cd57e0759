# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Compression and crop: the attribute, oiiotool's own option, and what an input was."""

import pytest
import tifffile

from dng import dng_files
from images import attributes, write_image
from python import commands

BASE = attributes(sensor="samsung-s20fe", illuminant="D65")
NONE, LOSSLESS_JPEG = 1, 7  # of TIFF's tag Compression


@pytest.fixture
def compression_of(oiiotool, tmp_path):
    """Return of(input, *arguments): the mosaic's Compression in oiiotool's DNG."""

    def of(path, *arguments):
        out = tmp_path / "shot.dng"
        oiiotool(path, *BASE, *arguments, "-o", out)
        with tifffile.TiffFile(out) as tiff:
            return int(dng_files.raw_page(tiff).tags["Compression"].value)

    return of


@pytest.fixture
def plain_exr(tmp_path, scene):
    """Return the path of the scene in an OpenEXR file without compression."""
    return write_image(tmp_path / "plain.exr", scene, {"compression": "none"})


def test_the_option_of_oiiotool_and_the_attribute(compression_of, exr):
    assert compression_of(exr, "--compression", "none") == NONE
    other = [*attributes(compression="ljpeg"), "--compression", "none"]
    assert compression_of(exr, *other) == LOSSLESS_JPEG


def test_an_input_that_is_not_compressed(compression_of, plain_exr):
    """OpenImageIO hands on what the input was, and our other formats' writers obey."""
    assert compression_of(plain_exr) == NONE
    assert compression_of(plain_exr, *attributes(compression="ljpeg")) == LOSSLESS_JPEG
    assert compression_of(plain_exr, "--compression", "ljpeg") == LOSSLESS_JPEG


def test_convert_does_the_same(oiiotool, plain_exr, tmp_path):
    ours, theirs = tmp_path / "ours.dng", tmp_path / "theirs.dng"
    words = ("--sensor", "samsung-s20fe", "--illuminant", "D65")
    assert commands.run("convert", plain_exr, "-o", ours, *words).code == 0
    oiiotool(plain_exr, *BASE, "-o", theirs)
    assert ours.read_bytes() == theirs.read_bytes()


@pytest.mark.parametrize(
    ("crop", "expected"),
    [(None, (2, 124, 92)), ("border", (2, 124, 92)), ("none", (0, 128, 96))],
)
def test_crop(oiiotool, exr, tmp_path, crop, expected):
    out = tmp_path / "shot.dng"
    oiiotool(exr, *BASE, *(attributes(crop=crop) if crop else []), "-o", out)
    _, mosaic, _ = dng_files.tags_of(out)
    origin, size = mosaic["DefaultCropOrigin"], mosaic["DefaultCropSize"]
    assert (origin[0], size[0], size[2]) == expected
    assert origin[1::2] == size[1::2] == (1, 1)
