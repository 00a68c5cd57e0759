# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Grey pictures as RAW frames: the words that were written come back."""

import os
import struct
import zlib

import numpy as np
import pytest

from cg2raw.io.raw_file import frames_in, open_raw
from python.commands import write_dng

tifffile = pytest.importorskip("tifffile", reason="tifffile is not installed")

DN = np.random.default_rng(2).integers(0, 65536, (12, 16)).astype(np.uint16)
DN[0, :2] = 0, 65535
TEXTS = [b"Exif:PhotographicSensitivity\x00400", b"ExposureTime\x000.25"]


def tiff(path, pixels, **fields):
    tifffile.imwrite(path, pixels, **{"photometric": "minisblack", **fields})
    return str(path)


def png(path, pixels, kind=0, texts=(), chunks=()):
    """Write a PNG of 8 or 16 bits; kind: 0 grey, 2 colour, 3 palette, 4 with alpha."""

    def chunk(name, data):
        crc = struct.pack(">I", zlib.crc32(name + data))
        return struct.pack(">I", len(data)) + name + data + crc

    height, width = pixels.shape[:2]
    rows = b"".join(
        b"\0" + row.tobytes() for row in pixels.astype(f">u{pixels.itemsize}")
    )
    head = struct.pack(">IIBBBBB", width, height, 8 * pixels.itemsize, kind, 0, 0, 0)
    data = b"".join(chunk(b"tEXt", text) for text in texts)
    data += b"".join(chunk(*more) for more in chunks)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + data
        + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    )  # fmt: skip
    return str(path)


def pgm(path, pixels, most, head="P5\n# made\n{} {}\n{}\n"):
    height, width = pixels.shape
    words = pixels.astype(">u2" if most > 255 else "u1").tobytes()
    path.write_bytes(head.format(width, height, most).encode() + words)
    return str(path)


@pytest.mark.parametrize("name", ["a.tif", "A.TIFF"])
@pytest.mark.parametrize(
    "fields",
    [{}, {"byteorder": ">"}, {"compression": "zlib"}, {"photometric": "miniswhite"}],
)
def test_words_of_a_tiff(tmp_path, name, fields):
    file = open_raw(tiff(tmp_path / name, DN, **fields))
    np.testing.assert_array_equal(file.mosaic(), DN)
    assert file.header.shape == DN.shape and file.mosaic().dtype == np.uint16
    assert bool(file.header.notes) == ("photometric" in fields)


@pytest.mark.parametrize("bits", [10, 12, 14])
def test_words_of_fewer_bits_are_not_widened(tmp_path, bits):
    words = DN >> (16 - bits)
    file = open_raw(tiff(tmp_path / "a.tif", words, bitspersample=bits))
    np.testing.assert_array_equal(file.mosaic(), words)
    assert (file.header.depth, file.header.bits) == (bits, None)


@pytest.mark.parametrize("kind", ["uint32", "int16", "float32"])
def test_whole_numbers_of_other_types_are_dn(tmp_path, kind):
    words = (DN // 2).astype(kind)
    np.testing.assert_array_equal(
        open_raw(tiff(tmp_path / "a.tif", words)).mosaic(), words
    )


@pytest.mark.parametrize("chunks", [[], [(b"gAMA", struct.pack(">I", 45455))]])
def test_words_of_a_png_have_no_curve(tmp_path, chunks):
    path = png(tmp_path / "a.png", DN, texts=TEXTS, chunks=chunks)
    file = open_raw(path)
    np.testing.assert_array_equal(file.mosaic(), DN)
    assert (file.header.iso, file.header.exposure_time) == (400, 0.25)


@pytest.mark.parametrize("most", [255, 256, 4095, 65535])
@pytest.mark.parametrize("head", ["P5\n# made\n{} {}\n{}\n", "P5 {} {} {} "])
def test_words_of_a_pgm_are_not_scaled(tmp_path, most, head):
    words = (DN.astype(int) * most // 65535).astype(np.uint16)
    file = open_raw(pgm(tmp_path / "a.pgm", words, most, head))
    np.testing.assert_array_equal(file.mosaic(), words)
    assert file.header.depth == most.bit_length()
    assert file.header.bits == (8 if most == 255 else None)


def test_the_pages_of_a_tiff_are_frames(tmp_path):
    path = tiff(tmp_path / "a.tif", np.stack([DN, DN // 2, DN // 3]))
    found = frames_in(path)
    for part, file in enumerate(found, 1):
        np.testing.assert_array_equal(file.mosaic(), DN // part)
    names = [file.header.name for file in found]
    assert names == ["a.tif[0]", "a.tif[1]", "a.tif[2]"]
    np.testing.assert_array_equal(open_raw(path, "1").mosaic(), DN // 2)
    with pytest.raises(ValueError, match=r"a.tif: has no page 3; it has 3, from 0 on"):
        open_raw(path, "3")
    with pytest.raises(ValueError, match="a.tif: holds 3 frames, .* must be one frame"):
        open_raw(path)


def test_a_thumbnail_is_no_frame(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for pixels in (DN[:4, :4], DN):
            file.write(pixels, photometric="minisblack")
    with pytest.raises(ValueError, match="its pages are 4x4, 16x12; .* choose one"):
        frames_in(str(tmp_path / "a.tif"))
    found = open_raw(str(tmp_path / "a.tif"), "1")
    np.testing.assert_array_equal(found.mosaic(), DN)


def test_a_tiff_that_is_a_dng_is_read_as_one(tmp_path):
    path = write_dng(tmp_path / "a.dng", "A", shape=(40, 64))
    assert open_raw(str(path.rename(tmp_path / "a.tif"))).header.cfa == "BGGR"


EIGHT = (DN >> 8).astype(np.uint8)
COLOUR = np.stack([EIGHT] * 3, axis=2)
PALETTE = [(b"PLTE", bytes(3 * 256))]
REFUSED = {
    "colour": (
        lambda p: tiff(p / "a.tif", COLOUR, photometric="rgb"),
        r"has 3 channels \(R, G, B\)",
    ),
    "a PNG in colour": (lambda p: png(p / "a.png", COLOUR, 2), "has 3 channels"),
    "a palette": (lambda p: png(p / "a.png", EIGHT, 3, (), PALETTE), "or a palette"),
    "alpha": (lambda p: png(p / "a.png", COLOUR[..., :2], 4), r"2 channels \(Y, A\)"),
    "fractions": (lambda p: tiff(p / "a.tif", DN / np.float32(7)), "pixels are no DN"),
    "negative": (lambda p: tiff(p / "a.tif", EIGHT - np.int16(9)), "pixels are no DN"),
    "no picture": (lambda p: write(p / "a.png", b"no PNG"), "a.png"),
    "no PGM": (lambda p: write(p / "a.pgm", b"P2\n1 1\n255\n7\n"), "no binary PGM"),
    "half a PNG": (lambda p: half(png(p / "a.png", DN)), "a.png: "),
    "half a TIFF": (lambda p: half(tiff(p / "a.tif", DN)), "a.tif: "),
    "half a PGM": (lambda p: write(p / "a.pgm", b"P5 9 9 255\n7"), "is cut off"),
    "a PGM of 0": (lambda p: write(p / "a.pgm", b"P5 9 9 0\n7"), "its largest word 0"),
}


def half(path):
    with open(path, "r+b") as file:
        file.truncate(os.path.getsize(path) - DN.nbytes // 2)
    return path


def write(path, data):
    path.write_bytes(data)
    return str(path)


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_no_frame_is_an_error(tmp_path, what):
    make, words = REFUSED[what]
    path = make(tmp_path)
    with pytest.raises(ValueError, match=words) as error:
        open_raw(path).mosaic()
    assert path in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("name", ["a.pgm", "a.npy", "a.dng"])
def test_a_file_of_one_frame_has_no_image_to_choose(tmp_path, name):
    path = str(tmp_path / name)
    make = {"a.pgm": lambda p: pgm(tmp_path / name, DN, 65535), "a.dng": write_dng}
    make.get(name, lambda p: np.save(p, DN))(path)
    with pytest.raises(ValueError, match=f"{name}: holds one frame, and no image 1"):
        frames_in(path, "1")


@pytest.mark.parametrize("name", ["a.tif", "a.png", "a.pgm"])
def test_a_missing_file_is_one_error(tmp_path, name):
    with pytest.raises(FileNotFoundError, match=name):
        open_raw(str(tmp_path / name))
