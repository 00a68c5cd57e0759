# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""End to end on the two path-traced renders: what comes out looks like what went in."""

import hashlib
import subprocess

import numpy as np
import OpenImageIO as oiio
import pytest
import rawpy

from images import attributes, write_image
from tiers import first_fast

RENDERS = ["interior", "night_street"]
# Of the file that the golden test writes. A change of it is a change of what users get:
# say so in CHANGES.md. The version stands in the file, so a release changes it too.
GOLDEN = "780530894412ea10f418bd5edbfbe4cc7616047fb1bf8af72a123083066956df"


@pytest.fixture(params=first_fast(RENDERS, 1))
def render(request, repository):
    """Return (path, pixels) of each render, highlights clipped as the sensor does."""
    path = repository / "tests" / "data" / f"{request.param}.exr"
    return path, np.clip(oiio.ImageBuf(str(path)).get_pixels("float"), 0, 1)


def developed(path):
    """Return LibRaw's linear sRGB of a DNG at half size, one pixel per Bayer cell."""
    with rawpy.imread(str(path)) as raw:
        rgb = raw.postprocess(
            use_camera_wb=True,
            half_size=True,
            no_auto_bright=True,
            adjust_maximum_thr=0,
            gamma=(1, 1),
            output_bps=16,
        )
    return rgb.astype(np.float32) / 65535


def cells(pixels):
    """Return the means of 2x2 blocks."""
    rows, cols = pixels.shape[0] // 2, pixels.shape[1] // 2
    return pixels[: 2 * rows, : 2 * cols].reshape(rows, 2, cols, 2, 3).mean(axis=(1, 3))


@pytest.mark.parametrize("light", first_fast(["A", "D65", "sample:4"], 1))
def test_a_reader_gives_the_render_back(oiiotool, render, tmp_path, light):
    path, pixels = render
    out = tmp_path / "shot.dng"
    given = attributes(sensor="nikon-d40", illuminant=light, matrices="exact")
    oiiotool(path, *given, "-o", out)
    expected, got = cells(pixels), developed(out)
    # A cell's sites see slightly different places; where the picture is smooth, and no
    # site is near the highlights that are to lose their colour, nothing else differs.
    smooth = np.ptp(pixels[: 2 * len(got)].reshape(len(got), 2, -1, 2, 3), axis=(1, 3))
    chosen = (smooth.max(axis=-1) < 0.01) & (expected.max(axis=-1) < 0.4)
    assert chosen.mean() > 0.2
    assert np.abs(got - expected)[chosen].mean() < 0.002


def test_highlights_are_white(oiiotool, render, tmp_path):
    path, pixels = render
    out = tmp_path / "shot.dng"
    oiiotool(path, *attributes(sensor="nikon-d40", illuminant="A"), "-o", out)
    with rawpy.imread(str(out)) as raw:
        dn, white = raw.raw_image_visible.copy(), raw.white_level
    blown = pixels.min(axis=-1) >= 1.0
    assert blown.mean() > 0.005
    assert (dn[blown] == white).mean() > 0.999


def test_noise_is_on_top_of_the_clean_picture(oiiotool, render, tmp_path):
    path, _ = render
    files = {}
    for name, more in {"clean": {}, "a": {"iso": 3200}, "b": {"iso": 3200}}.items():
        files[name] = tmp_path / f"{name}.dng"
        base = attributes(sensor="samsung-s20fe", illuminant="sample:3", seed=7)
        oiiotool(path, *base, *attributes(**more), "-o", files[name])
    assert files["a"].read_bytes() == files["b"].read_bytes()
    with rawpy.imread(str(files["clean"])) as clean, rawpy.imread(str(files["a"])) as a:
        clean_dn = clean.raw_image_visible.astype(float)
        noise = a.raw_image_visible - clean_dn
    inside = (clean_dn > 150) & (clean_dn < 700)
    assert abs(noise[inside].mean()) < 0.2
    assert 8 < noise[inside].std() < 60


def test_exiftool_finds_nothing_wrong(oiiotool, render, program, tmp_path):
    path, _ = render
    out = tmp_path / "shot.dng"
    base = attributes(sensor="samsung-s20fe", illuminant="2856K", iso=100)
    oiiotool(path, *base, "-o", out)
    command = [program("exiftool"), "-validate", "-warning", "-a", out]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "Validate                        : OK" in said, said


def test_the_golden_file(oiiotool, tmp_path):
    rows, cols, channels = np.mgrid[0:90, 0:130, 0:3]
    pixels = ((rows * 31 + cols * 17 + channels * 53) % 256 / 200).astype(np.float32)
    # The date that OpenEXR files carry goes into the DNG.
    date = {"DateTime": "2026:01:02 03:04:05"}
    exr = write_image(tmp_path / "in.exr", pixels, date)
    out = tmp_path / "golden.dng"
    base = attributes(sensor="samsung-s20fe", illuminant="sample:7", iso=400, seed=1)
    oiiotool(exr, *base, "-o", out)
    assert hashlib.sha256(out.read_bytes()).hexdigest() == GOLDEN
