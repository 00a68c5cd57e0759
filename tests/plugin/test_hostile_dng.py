# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""DNGs that cannot be read say so in one line, and never show their preview instead."""

import struct

import numpy as np
import pytest

import cg2raw
from fuzz import make_seeds, mosaic_seeds

NAN_MATRIX = (make_seeds.SRATIONAL, 0, [1, 0, 0, 0, 1, 0, 0, 0, 1])
WIDE = {256: (make_seeds.LONG, [65535]), 257: (make_seeds.LONG, [65535])}
WORDS = [struct.pack("<144H", *mosaic_seeds.VALUES)]


def made(tags, chunks=WORDS):
    """Return a DNG of tags of a mosaic and its pixels."""
    return mosaic_seeds.with_pixels(tags, chunks, "<")


def with_preview(tags):
    """Return a DNG with a picture in IFD0, which other readers would show."""
    preview = {254: (make_seeds.LONG, [1]), 256: (make_seeds.LONG, [2])}
    preview |= {257: (make_seeds.LONG, [2]), 258: (make_seeds.SHORT, [8, 8, 8])}
    preview |= {259: (make_seeds.SHORT, [1]), 262: (make_seeds.SHORT, [2])}
    preview |= {273: (make_seeds.LONG, [8]), 277: (make_seeds.SHORT, [3])}
    preview |= {278: (make_seeds.LONG, [2]), 279: (make_seeds.LONG, [12])}
    return make_seeds.dng(make_seeds.camera() | preview, [tags])


RAW = make_seeds.raw()
JPEG = make_seeds.raw(t259=(make_seeds.SHORT, [7]))
FILES = {
    "no CFAPattern": (
        made(make_seeds.without(RAW, 33422)),
        "CFAPattern (33422) is missing",
    ),
    "NaN matrix": (made(RAW | {50721: NAN_MATRIX}), "ColorMatrix1 (50721) holds a"),
    "absurd size": (made(RAW | WIDE), "StripByteCounts (279) of chunk 0 is 288 bytes"),
    "absurd JPEG": (made(JPEG | WIDE), "for 65535 x 65535 pixels, which need more"),
    "no strips": (with_preview(RAW), "StripOffsets (273) is missing"),
    "truncated": (made(RAW)[:-100], "StripOffsets (273) of chunk 0 is 288 bytes"),
    "no JPEG": (made(JPEG), "JPEG of chunk 0 at byte"),
    "lossy JPEG": (
        mosaic_seeds.mosaics()["lossy_jpeg_little"],
        "is of process SOF0; only lossless JPEG",
    ),
    "deflate": (
        made(make_seeds.raw(t259=(make_seeds.SHORT, [8]))),
        "Compression (259) is 8; readable are 1 (none) and 7",
    ),
    "LinearRaw": (
        with_preview(make_seeds.raw(t262=(make_seeds.SHORT, [34892]))
                     | {277: (make_seeds.SHORT, [3])}),
        "is LinearRaw (34892), demosaicked",
    ),
    "white below black": (
        made(make_seeds.raw(t50717=(make_seeds.SHORT, [10]))),
        "BlackLevel (50714) is 64 DN",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_it_names_file_and_field_and_leaves_nothing(oiiotool, tmp_path, name):
    data, words = FILES[name]
    ending = "dng" if oiiotool.name == "oiio-wheel" else "cg2raw"
    path, out = tmp_path / f"bad.{ending}", tmp_path / "out.tif"
    path.write_bytes(data)
    done = oiiotool(path, "-o", out, check=False)
    message = (done.stdout + done.stderr).split("\nFull command")[0]
    assert done.returncode == 1 and not out.exists()
    assert f"bad.{ending}: " in message and words in message
    assert len(message.strip().splitlines()) == 1
    said = oiiotool("--info", "-v", path, check=False).stdout
    assert "uint16 dng" in said  # and no "tiff"


@pytest.mark.parametrize("kept", [0, 4, 8, 100, 2000])
def test_what_is_cut_off_is_an_error(oiiotool, tmp_path, kept):
    """Our files have their directories at the end: nothing is left of them."""
    whole = tmp_path / "whole.dng"
    sensor = cg2raw.Sensor("nikon-d40")
    scene = np.full((48, 64, 3), 0.3, np.float32)
    cg2raw.write_dng(whole, sensor.simulate(scene, illuminant="A"))
    ending = "dng" if oiiotool.name == "oiio-wheel" else "cg2raw"
    path, out = tmp_path / f"cut.{ending}", tmp_path / "out.tif"
    path.write_bytes(whole.read_bytes()[:kept])
    done = oiiotool(path, "-o", out, check=False)
    assert done.returncode == 1 and not out.exists()
    assert f"cut.{ending}" in done.stdout + done.stderr


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        (
            "dng:developd",
            1,
            "dng:developd is unknown to the reader; known: dng:develop",
        ),
        ("dng:developed", 2, 'dng:developed "2" must be 0 (the mosaic) or 1'),
    ],
)
def test_hints_that_it_does_not_know(oiiotool, tmp_path, name, value, words):
    ending = "dng" if oiiotool.name == "oiio-wheel" else "cg2raw"
    path = tmp_path / f"shot.{ending}"
    path.write_bytes(made(RAW))
    oiiotool(path, "-o", tmp_path / "good.tif")
    done = oiiotool("-iconfig", name, value, path, "-o", "bad.tif", check=False)
    assert done.returncode == 1 and words in done.stdout + done.stderr


def test_a_mosaic_without_a_matrix_is_read_but_not_developed(oiiotool, tmp_path):
    ending = "dng" if oiiotool.name == "oiio-wheel" else "cg2raw"
    path = tmp_path / f"shot.{ending}"
    camera = make_seeds.without(make_seeds.camera() | RAW, 50721)
    start = len(make_seeds.dng(camera | {273: (4, [0]), 279: (4, [288])}))
    pixels = {273: (make_seeds.LONG, [start]), 279: (make_seeds.LONG, [288])}
    path.write_bytes(make_seeds.dng(camera | pixels) + WORDS[0])
    said = oiiotool("--info", "-v", path).stdout
    assert "12 x   12, 1 channel" in said and "ColorMatrix1 (50721) is missing" in said
    done = oiiotool("-iconfig", "dng:developed", 1, path, "-o", "x.tif", check=False)
    assert done.returncode == 1
    assert "ColorMatrix1 (50721) is missing" in done.stdout + done.stderr
