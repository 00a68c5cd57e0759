# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""mosaic.h and the levels: which value stands where, and as which DN."""

import math

import numpy as np
import pytest

import cg2raw
from oracles import cameras

CFAS = ("RGGB", "GRBG", "GBRG", "BGGR", cameras.QUAD, cameras.X_TRANS)


def sensor_of(**fields):
    return cg2raw.Sensor.from_json(cameras.profile_text(**fields))


def expected_mosaic(rgb, cfa):
    """One of three values per site, written out."""
    height, width, _ = rgb.shape
    side = math.isqrt(len(cfa))
    out = np.empty((height, width))
    for row in range(height):
        for col in range(width):
            out[row, col] = rgb[
                row, col, "RGB".index(cfa[row % side * side + col % side])
            ]
    return out


@pytest.mark.parametrize(
    "size", [(48, 64), (7, 9), (1, 1), (1, 300), (301, 2), (3, 515)]
)
@pytest.mark.parametrize("cfa", CFAS)
def test_each_site_keeps_its_colour(cfa, size):
    rgb = np.random.default_rng(3).uniform(0, 1, (*size, 3)).astype(np.float32)
    sensor = sensor_of(cfa=cfa)
    seen = sensor.signal(rgb, illuminant="A", camera_input=True)
    assert seen.shape == size
    assert (seen == expected_mosaic(rgb, cfa)).all()


@pytest.mark.parametrize("cfa", CFAS)
def test_levels_per_site(cfa):
    black, white = [100.0 + 20.25 * site for site in range(len(cfa))], 4000
    side = math.isqrt(len(cfa))
    sensor = sensor_of(cfa=cfa, bits=12, black_level=black, white_level=white)
    rgb = np.random.default_rng(4).uniform(0, 1, (33, 45, 3)).astype(np.float32)
    x = expected_mosaic(rgb, cfa)
    rows, cols = np.indices(x.shape)
    b = np.array(black)[rows % side * side + cols % side]
    dn = x * (white - b) + b
    raw = sensor.simulate(rgb, illuminant="A", camera_input=True)
    assert raw.dtype == np.uint16
    certain = np.abs(dn - np.floor(dn) - 0.5) > 1e-3  # float32 may tip a half
    assert certain.mean() > 0.99
    assert (np.asarray(raw) == np.floor(dn + 0.5))[certain].all()


def flat(sensor, value):
    rgb = np.full((2, 2, 3), value, np.float32)
    return np.asarray(sensor.simulate(rgb, illuminant="A", camera_input=True))


@pytest.mark.parametrize(
    ("value", "dn"),
    [
        (0.0, 64),
        (1.0, 1023),
        (2.0, 1023),
        (np.inf, 1023),
        (np.nan, 64),
        (-10.0, 0),
        (-np.inf, 0),
        (0.49 / 959, 64),
        (0.51 / 959, 65),
        (-0.49 / 959, 64),
        (-0.51 / 959, 63),
        (500.6 / 959, 565),
    ],
)
def test_levels_are_rounded_and_clamped(value, dn):
    sensor = sensor_of(bits=10, black_level=[64] * 4, white_level=1023)
    assert (flat(sensor, value) == dn).all()


@pytest.mark.parametrize("bits", [8, 10, 12, 14, 16])
def test_every_code_is_reached(bits):
    white = 2**bits - 1
    sensor = sensor_of(bits=bits, black_level=[0] * 4, white_level=white)
    codes = np.arange(white + 1)
    rgb = np.repeat(codes / white, 3).reshape(1, -1, 3).astype(np.float32)
    raw = sensor.simulate(rgb, illuminant="A", camera_input=True)
    assert (np.asarray(raw)[0] == codes).all()


def test_alpha_is_ignored():
    sensor = sensor_of()
    rgba = np.random.default_rng(5).uniform(0, 1, (6, 6, 4)).astype(np.float32)
    seen = sensor.simulate(rgba, illuminant="A")
    assert (seen == sensor.simulate(rgba[..., :3], illuminant="A")).all()


def test_camera_input_is_not_transformed():
    sensor = sensor_of()
    rgb = np.random.default_rng(6).uniform(0, 0.8, (6, 8, 3)).astype(np.float32)
    camera = sensor.to_camera(rgb, illuminant="A")
    direct = sensor.simulate(rgb, illuminant="A")
    assert (direct == sensor.simulate(camera, illuminant="A", camera_input=True)).all()
