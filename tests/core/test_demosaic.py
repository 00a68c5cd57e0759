# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""demosaic.h: what sites lack is interpolated, to the edges, for any CFA."""

import numpy as np
import pytest
from scipy.ndimage import convolve

import cg2raw
from oracles import cameras

BAYER = ("RGGB", "GRBG", "GBRG", "BGGR")
CFAS = (*BAYER, cameras.QUAD, cameras.X_TRANS)
TENT = np.array([[1, 2, 1], [2, 4, 2], [1, 2, 1]]) / 4.0


def side_of(cfa):
    return {4: 2, 16: 4, 36: 6}[len(cfa)]


def colours(cfa, shape):
    """(H, W): 0, 1, 2 of each site."""
    repeat = np.array(["RGB".index(c) for c in cfa]).reshape(side_of(cfa), -1)
    repeats = [-(-n // side_of(cfa)) for n in shape]
    return np.tile(repeat, repeats)[: shape[0], : shape[1]]


def sizes(cfa):
    side = side_of(cfa)
    return [(side, side), (side, 41), (41, side + 1), (23, 30), (128, 129)]


@pytest.mark.parametrize("value", [0.0, 0.1, 1 / 3, 0.7, 123.456])
@pytest.mark.parametrize("cfa", CFAS)
def test_a_constant_stays_constant_to_the_last_bit(cfa, value):
    for size in sizes(cfa):
        rgb = cg2raw.demosaic(np.full(size, value, np.float32), cfa)
        assert (rgb == np.float32(value)).all(), size


@pytest.mark.parametrize("cfa", CFAS)
def test_three_constants_stay_what_they_are(cfa):
    """Each colour is made of its own sites only."""
    for size in sizes(cfa):
        image = np.broadcast_to(np.float32([0.9, 0.5, 0.2]), (*size, 3))
        seen = cg2raw.demosaic(cg2raw.mosaic(image, cfa), cfa)
        np.testing.assert_array_equal(seen, image)


@pytest.mark.parametrize("cfa", CFAS)
def test_what_was_measured_stays(cfa):
    raw = np.random.default_rng(2).uniform(0, 1, (37, 50)).astype(np.float32)
    rgb = cg2raw.demosaic(raw, cfa)
    assert rgb.shape == (37, 50, 3) and rgb.dtype == np.float32
    np.testing.assert_array_equal(cg2raw.mosaic(rgb, cfa), raw)


@pytest.mark.parametrize("cfa", BAYER)
def test_bayer_is_bilinear(cfa):
    """Inside: the mean of two or four neighbours, as convolutions of zeroed planes."""
    raw = np.random.default_rng(3).uniform(0, 1, (20, 27)).astype(np.float32)
    site = colours(cfa, raw.shape)
    rgb = cg2raw.demosaic(raw, cfa)
    for colour in range(3):
        mask = site == colour
        kernel = TENT if colour != 1 else TENT * [[0, 1, 0], [1, 1, 1], [0, 1, 0]] / 2
        kernel[1, 1] = 1.0
        expected = convolve(np.where(mask, raw, 0).astype(float), kernel)
        seen = rgb[1:-1, 1:-1, colour]
        assert np.abs(seen - expected[1:-1, 1:-1]).max() < 1e-6


@pytest.mark.parametrize("cfa", CFAS)
def test_it_is_normalised_convolution(cfa):
    """sum(w c x) / sum(w c), written out with the smallest tent that finds all."""
    raw = np.random.default_rng(4).uniform(0, 1, (40, 44)).astype(np.float32)
    site = colours(cfa, raw.shape)
    radius = smallest_radius(cfa)
    tent = radius + 1.0 - np.abs(np.arange(-radius, radius + 1))
    kernel = np.outer(tent, tent)
    rgb = cg2raw.demosaic(raw, cfa)
    inside = np.s_[radius:-radius, radius:-radius]
    for colour in range(3):
        mask = (site == colour).astype(float)
        mean = convolve(raw * mask, kernel, mode="constant") / np.maximum(
            convolve(mask, kernel, mode="constant"), 1e-9
        )
        expected = np.where(mask > 0, raw, mean)
        assert np.abs(rgb[..., colour] - expected)[inside].max() < 1e-6


def smallest_radius(cfa):
    """Of windows that hold each colour, wherever they lie."""
    site = colours(cfa, (24, 24))
    for radius in range(1, 7):
        window = np.ones((2 * radius + 1,) * 2)
        found = [
            convolve((site == c).astype(int), window, mode="wrap") for c in (0, 1, 2)
        ]
        if np.min(found) > 0:
            return radius
    raise AssertionError(cfa)


def test_the_number_of_threads_does_not_matter():
    raw = np.random.default_rng(5).uniform(0, 1, (300, 211)).astype(np.float32)
    one, many = (cg2raw.demosaic(raw, cameras.X_TRANS, threads=n) for n in (1, 5))
    np.testing.assert_array_equal(one, many)


def test_a_sensor_knows_its_cfa():
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(cfa="GBRG"))
    raw = np.random.default_rng(6).uniform(0, 1, (9, 8)).astype(np.float32)
    rgb = sensor.demosaic(raw)
    np.testing.assert_array_equal(rgb, cg2raw.demosaic(raw, "GBRG"))
    np.testing.assert_array_equal(sensor.mosaic(rgb), raw)


BAD = [
    (np.ones((1, 8)), "RGGB", "1 x 8 pixels must hold a whole repeat .* 2 x 2"),
    (np.ones((8, 5)), cameras.X_TRANS, "whole repeat of the CFA, 6 x 6"),
    (np.ones((0, 8)), "RGGB", "not empty"),
    (np.ones((8, 8, 3)), "RGGB", "shape"),
    (np.ones((8, 8)), "X-Trans", "spell it out"),
]


@pytest.mark.parametrize(("raw", "cfa", "reason"), BAD)
def test_bad_mosaics(raw, cfa, reason):
    with pytest.raises(ValueError, match=reason):
        cg2raw.demosaic(raw, cfa)
