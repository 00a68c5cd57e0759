# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Other people's decoders give back every value of our lossless JPEG."""

import imagecodecs
import numpy as np
import pytest
import rawpy
import tifffile

from dng import dng_files

SHAPE = (150, 1100)
ROW, COL = np.mgrid[0 : SHAPE[0], 0 : SHAPE[1]]
RANDOM = np.random.default_rng(5)
# 16 bits, black 0: all of uint16 is legal.
MOSAICS = {
    "constant": np.full(SHAPE, 4660),
    "random": RANDOM.integers(0, 65536, SHAPE),
    "extremes": RANDOM.integers(0, 2, SHAPE) * 65535,
    "half range": (COL // 2 + ROW) % 2 * 32768,  # differences of size 16
    "all sizes": (COL // 2 % 2) << (ROW + COL) % 16,
    "mostly dark": np.minimum(RANDOM.geometric(0.3, SHAPE), 65535),
    "ramp": (ROW * 17 + COL * 31) % 65536,
}
DECODERS = (imagecodecs.ljpeg_decode, imagecodecs.jpegsof3_decode)


@pytest.fixture(scope="module")
def sensor():
    return dng_files.sensor(bits=16, black_level=[0] * 4, white_level=65535)


@pytest.fixture(params=MOSAICS)
def mosaic(request):
    """Return planted DN."""
    return MOSAICS[request.param].astype(np.uint16)


@pytest.fixture(params=["ljpeg", "ljpeg-2d"])
def file(request, mosaic, sensor, tmp_path):
    """Return (path, DN) of a planted mosaic."""
    path = tmp_path / "planted.dng"
    return path, dng_files.write(path, sensor, mosaic, compression=request.param)


def tiles_of(path):
    """Return [(row, col, height, width, bytes)] of the tiles of a DNG."""
    with tifffile.TiffFile(path) as tiff:
        page = dng_files.raw_page(tiff)
        across = -(-page.imagewidth // page.tilewidth)
        places = zip(page.dataoffsets, page.databytecounts, strict=True)
        tiles = []
        for i, (offset, count) in enumerate(places):
            tiff.filehandle.seek(offset)
            row, col = i // across * page.tilelength, i % across * page.tilewidth
            data = tiff.filehandle.read(count)
            tiles.append((row, col, page.tilelength, page.tilewidth, data))
    return tiles


@pytest.mark.parametrize("decode", DECODERS, ids=lambda d: d.__name__)
def test_imagecodecs(file, decode):
    path, mosaic = file
    for row, col, height, width, data in tiles_of(path):
        tile = decode(data).reshape(height, width)
        seen = mosaic[row : row + height, col : col + width]
        np.testing.assert_array_equal(tile[: seen.shape[0], : seen.shape[1]], seen)


def test_libraw(file):
    path, mosaic = file
    with rawpy.imread(str(path)) as raw:
        np.testing.assert_array_equal(raw.raw_image, mosaic)


def test_dcraw(file, program, tmp_path):
    program("dcraw")
    path, mosaic = file
    dn, complaint = dng_files.dcraw(path, tmp_path / "dn.tif", "-D", "-4")
    np.testing.assert_array_equal(dn, mosaic)
    assert complaint == ""


@pytest.mark.parametrize("width", [16, 17, 77, 511, 513, 769])
def test_widths_that_are_no_multiple_of_a_tile(sensor, width, tmp_path, program):
    # dcraw wraps the rows of a tile that is wider than the image.
    program("dcraw")
    path = tmp_path / "narrow.dng"
    mosaic = dng_files.random_mosaic(sensor, (141, width))
    dng_files.write(path, sensor, mosaic)
    with tifffile.TiffFile(path) as tiff:
        page = dng_files.raw_page(tiff)
        assert page.is_tiled and page.tilewidth <= width
        np.testing.assert_array_equal(page.asarray(), mosaic)
    if width >= 22:  # the least that dcraw takes for a RAW
        dn, _ = dng_files.dcraw(path, tmp_path / "dn.tif", "-D", "-4")
        np.testing.assert_array_equal(dn, mosaic)


@pytest.mark.parametrize(
    ("bits", "precision"), [(8, 9), (10, 10), (12, 12), (14, 14), (16, 16)]
)
def test_precision_is_the_sensors(tmp_path, bits, precision):
    white = 2**bits - 1
    sensor = dng_files.sensor(bits=bits, black_level=[1] * 4, white_level=white)
    mosaic = dng_files.random_mosaic(sensor, SHAPE)
    path = tmp_path / "planted.dng"
    dng_files.write(path, sensor, mosaic)
    for *_, data in tiles_of(path):
        frame = data.index(b"\xff\xc3")  # SOF3: marker, length, precision
        assert data[frame + 4] == precision
    with tifffile.TiffFile(path) as tiff:
        np.testing.assert_array_equal(dng_files.raw_page(tiff).asarray(), mosaic)
