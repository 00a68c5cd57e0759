# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spots of a mean flat: dust at edges, side by side, and on light that is not even."""

import numpy as np
import pytest
from numpy.polynomial.legendre import legval2d
from scipy.ndimage import gaussian_filter

from cg2raw.statistics.spots import _noise_of, spots_of

SHAPE = (112, 144)
ROWS, COLUMNS = np.indices(SHAPE)
# Row, column and radius, px: alone, two that touch, a row of three, at two edges.
DISCS = (
    *((72, 82, 9), (68, 66, 5), (22, 30, 9), (30, 46, 8), (96, 108, 8)),
    *((88, 122, 8), (76, 128, 8), (0, 84, 6), (50, 143, 7)),
)


def frame(light, seed=1):
    """Return (H, W) DN of a mean flat of 900 DN, less its level, with its noise."""
    rng = np.random.default_rng(seed)
    mean = 900 * light + 4 * rng.standard_normal(SHAPE)
    return (mean - mean.mean()).astype(np.float32)


def dust(depth):
    """Return (H, W) the share of light that is lost, in blurred discs."""
    lost = np.zeros(SHAPE)
    for row, column, radius in DISCS:
        lost[np.hypot(ROWS - row, COLUMNS - column) < radius] = depth
    return gaussian_filter(lost, 2.0)


@pytest.mark.parametrize("depth", [0.02, 0.05])
@pytest.mark.parametrize("falls", [0.0, 0.3])
def test_all_of_the_dust_is_in_spots(depth, falls):
    """Each disc is; light that falls off by cos^4 to the corners moves nothing."""
    lost = dust(depth)
    square = (ROWS / 56 - 1) ** 2 + (COLUMNS / 72 - 1) ** 2
    light = (1 - lost) / (1 + falls * square / 2) ** 2
    spots = spots_of(frame(light), 2, np.zeros(SHAPE, bool)).samples(SHAPE)
    assert all(spots[row, column] for row, column, _ in DISCS)
    assert lost[spots].sum() > 0.95 * lost.sum()
    assert spots.mean() < 3 * (lost > depth / 2).mean()


@pytest.mark.parametrize("seed", range(3))
def test_what_is_slow_is_no_spot(seed):
    """Polynomials of degree 9 to 11, beside which spots are not looked for first."""
    degrees = np.add.outer(np.arange(12), np.arange(12))
    size = np.where((degrees > 8) & (degrees < 12), 0.005, 0.0)
    size = size * np.random.default_rng(seed).standard_normal(size.shape)
    light = 1 + legval2d(ROWS / 56 - 1, COLUMNS / 72 - 1, size)
    found = spots_of(frame(light), 2, np.zeros(SHAPE, bool))
    assert len(found.places) == 0


def test_a_spot_of_a_large_frame_is_where_it_is():
    """Within a cell of 4 px, in which seven sizes are looked for."""
    rows, columns = np.indices((520, 640))
    away = np.hypot(rows - 130.5, columns - 250.5)
    lost = gaussian_filter(np.where(away < 14, 0.05, 0.0), 2.0)
    light = 900 * (1 - lost) + 4 * np.random.default_rng(3).standard_normal(lost.shape)
    found = spots_of((light - light.mean()).astype(np.float32), 2, lost > 1)
    [[row, column, radius]] = found.places
    assert (row, column) == pytest.approx((130.5, 250.5), abs=4)
    assert 14 <= radius <= 14 + 5 + 2 * 4  # a disc, its blur, two cells
    assert found.tried == 7 * 520 * 640 / 4**2


@pytest.mark.parametrize("scale", [1.0, 4.0])
def test_white_noise_in_a_spot_less_its_surroundings_is_that_of_both_gaussians(scale):
    """Their squares, summed; the smallest is sampled coarsely."""
    one = np.zeros((99, 99))
    one[49, 49] = 1
    weights = gaussian_filter(one, scale) - gaussian_filter(one, 2 * scale)
    assert _noise_of(scale) == pytest.approx(np.sqrt(np.sum(weights**2)), rel=2e-3)
