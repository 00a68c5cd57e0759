# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Our lossless JPEG is as small as one can be, give or take 2 %: ljpeg among those of
predictor 1, which every reader knows, ljpeg-2d among all."""

import numpy as np
import OpenImageIO as oiio
import pytest
import rawpy
import tifffile

import cg2raw
from dng import dng_files, jpeg_sizes
from tiers import first_fast

SHAPE = (128, 1536)  # three tiles of 512 x 128
MARGIN = 1.02
RENDER = dng_files.PROFILES.parents[1] / "tests" / "data" / "interior.exr"
SIMULATED = [
    (sensor, iso)
    for iso in (None, 3200, 100)
    for sensor in ("samsung-s20fe", "canon-5d-mark-iv")  # 10 and 14 bits
]
REAL = (
    "Hero6_GOPR0024.dng",
    "Fusion_GPFR7066.dng",
    "canon550d_colorchart_tinydng.dng",
    "bmpcc_twelvemonkeys.dng",
    "nikon_d1_imagemeta.nef",
)
# compression: (predictors of those that it is compared with)
WAYS = {"ljpeg": (1,), "ljpeg-2d": jpeg_sizes.PREDICTORS}


def middle(image):
    """Return the middle of an image (H, W, ...), of SHAPE, from an even site on."""
    top, left = (
        (have - want) // 4 * 2
        for have, want in zip(image.shape[:2], SHAPE, strict=True)
    )
    return np.ascontiguousarray(image[top : top + SHAPE[0], left : left + SHAPE[1]])


@pytest.fixture(scope="module")
def render():
    """Return the interior render, (H, W, 3) float32, at the size of a photograph."""
    roi = oiio.ROI(0, 2016, 0, 1512, 0, 1, 0, 3)
    image = oiio.ImageBufAlgo.resize(oiio.ImageBuf(str(RENDER)), roi=roi)
    return middle(image.get_pixels(oiio.FLOAT))


def ratio_of(path, mosaic, compression):
    """Return the bytes of a mosaic's JPEGs over the least possible."""
    sensor = dng_files.sensor(bits=16, black_level=[0] * 4, white_level=65535)
    dng_files.write(path, sensor, mosaic, compression=compression)
    with tifffile.TiffFile(path) as tiff:
        page = dng_files.raw_page(tiff)
        ours = sum(page.databytecounts)
        height, width = page.tilelength, page.tilewidth
    assert len(page.databytecounts) * height * width == mosaic.size  # no padding
    least = sum(
        jpeg_sizes.least_bytes(
            mosaic[row : row + height, col : col + width], WAYS[compression]
        )
        for row in range(0, mosaic.shape[0], height)
        for col in range(0, mosaic.shape[1], width)
    )
    assert ours >= least  # that bound is one
    return ours / least


@pytest.mark.parametrize("compression", WAYS)
@pytest.mark.parametrize(("sensor", "iso"), first_fast(SIMULATED, 2))
def test_simulated(render, sensor, iso, compression, tmp_path):
    raw = cg2raw.Sensor(sensor).simulate(render, illuminant="D65", iso=iso)
    ratio = ratio_of(tmp_path / "shot.dng", np.asarray(raw), compression)
    print(f"{ratio:.4f} {compression} {sensor} {iso}")
    assert ratio < MARGIN


@pytest.mark.parametrize("compression", WAYS)
@pytest.mark.parametrize("name", REAL)
def test_real(name, compression, camera_data, tmp_path):
    with rawpy.imread(str(camera_data / "real" / name)) as raw:
        mosaic = middle(raw.raw_image)
    ratio = ratio_of(tmp_path / "shot.dng", mosaic, compression)
    print(f"{ratio:.4f} {compression} {name}")
    assert ratio < MARGIN


def test_every_tile_may_have_its_own(tmp_path):
    """Rows that repeat beside columns that do: no one predictor suits both."""
    random = np.random.default_rng(2)
    shape = (SHAPE[0], SHAPE[1] // 2)
    rows = np.repeat(random.integers(0, 4000, (1, shape[1])), shape[0], 0)
    cols = np.repeat(random.integers(0, 4000, (shape[0], 1)), shape[1], 1)
    mosaic = np.hstack([rows, cols]).astype(np.uint16)
    assert ratio_of(tmp_path / "shot.dng", mosaic, "ljpeg-2d") < MARGIN
