# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Packed planes are the mosaic of the DNG."""

import numpy as np
import OpenImageIO as oiio
import pytest
import rawpy

from cg2raw.dataset.packed import packed
from dataset.data_sets import rows, scene, write_image
from python.commands import run

SENSORS = "nikon-d40,samsung-s20fe,nikon-d850,blackmagic-pocket"  # all four phases


def made(tmp_path, *options):
    """Return the rows of a data set of one 64x96 image; its folder is out."""
    write_image(tmp_path / "in.exr", scene((64, 96)))
    out = tmp_path / "-".join(["out", *options])
    words = ["--sensors", SENSORS, "--illuminants", "D65", *options]
    done = run("dataset", tmp_path / "in.exr", out, *words)
    assert done.code == 0, done
    return out, rows(out)


def planes_of(raw, row):
    """Return R, G1, G2, B of a mosaic, by the letters of the manifest's CFA."""
    white, black = row["white_level"], row["black_level"]
    first_red = row["cfa"].index("R") < 2  # red stands in the first row
    greens = [site for site in range(4) if row["cfa"][site] == "G"]
    greens = greens if first_red else greens[::-1]
    order = [row["cfa"].index("R"), *greens, row["cfa"].index("B")]
    dn = raw.astype(np.float64)
    return np.stack(
        [
            (dn[site // 2 :: 2, site % 2 :: 2] - black[site]) / (white - black[site])
            for site in order
        ]
    )


@pytest.mark.parametrize("format", ["npy", "exr"])
def test_packed_files_are_the_mosaic_of_the_dng(tmp_path, format):
    dngs, listed = made(tmp_path, "--compression", "none")
    out, found = made(tmp_path, "--format", format)
    assert {row["cfa"] for row in listed} == {"RGGB", "GRBG", "GBRG", "BGGR"}
    for dng, row in zip(listed, found, strict=True):
        with rawpy.imread(str(dngs / dng["path"])) as raw:
            wanted = planes_of(raw.raw_image.copy(), dng)
        planes = read(out / row["path"])
        assert planes.shape == (4, 32, 48) == (4, row["height"], row["width"])
        assert planes.dtype == np.float32
        assert np.abs(planes - wanted).max() <= 2**-23  # float32 of 0..1


def read(path):
    """Return the planes of a packed file."""
    if path.suffix == ".npy":
        return np.load(path)
    image = oiio.ImageInput.open(str(path))
    names = list(image.spec().channelnames)
    pixels = image.read_image(oiio.FLOAT)
    order = [names.index(name) for name in ("R", "G1", "G2", "B")]
    return np.moveaxis(pixels[..., order], -1, 0)


def test_integers_are_the_floats_rounded(tmp_path):
    floats, listed = made(tmp_path, "--format", "npy")
    integers, found = made(tmp_path, "--format", "npy", "--type", "uint16")
    for one, two in zip(listed, found, strict=True):
        wanted = np.clip(np.load(floats / one["path"]), 0, 1) * np.float64(65535)
        codes = np.load(integers / two["path"])
        assert codes.dtype == np.uint16
        assert np.abs(codes - wanted).max() <= 0.504  # half, and float32's rounding


def test_noise_below_black_stays_in_floats():
    raw = np.array([[90, 100], [100, 300]], np.uint16)
    levels = ("RGGB", [100.0] * 4, 300)
    assert packed(raw, *levels, "float32").ravel().tolist() == pytest.approx(
        [-0.05, 0, 0, 1]
    )
    assert packed(raw, *levels, "uint16").ravel().tolist() == [0, 0, 0, 65535]


def test_odd_sizes_lose_their_last_row_and_column():
    raw = np.arange(15, dtype=np.uint16).reshape(3, 5)
    planes = packed(raw, "GRBG", [0.0] * 4, 1, "float32")
    assert planes.tolist() == [[[1, 3]], [[0, 2]], [[6, 8]], [[5, 7]]]
