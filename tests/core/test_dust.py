# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Dust: spots of the sensor's own, as many, as dark and as wide as it says."""

import numpy as np
import pytest
from scipy import ndimage

from core import predicted as of

SHAPE = (600, 800)
MEGAPIXELS = SHAPE[0] * SHAPE[1] / 1e6
WIDE = {"density": 200.0, "depth": 0.2, "radius": 5.0}


def loss_of(cut=None, **given):
    """Return the share of light that a grey frame lacks."""
    image = of.flat(0.5, *SHAPE)
    seen = of.predicted(image, ("dust", {**WIDE, **given}), of=of.sensor(id="dusty"))[0]
    return 1 - seen / 0.5


def test_spots_are_as_many_as_the_density():
    """A Poisson number; spots are told apart by their middles, which are maxima."""
    loss = loss_of(radius=2.0)
    highest = (loss == ndimage.maximum_filter(loss, 5)) & (loss > 0.05)
    expected = 200 * MEGAPIXELS
    assert highest.sum() == pytest.approx(expected, abs=4 * np.sqrt(expected))


@pytest.mark.parametrize("radius", [3.0, 8.0])
def test_spots_are_gaussians_whose_radius_has_half_the_loss(radius):
    """The volume of one is pi / ln 2 times depth and squared radius. 0.5 % of the light
    is lost twice where spots overlap."""
    loss = loss_of(radius=radius, density=60.0, depth=0.1)
    count = 60 * MEGAPIXELS
    volume = np.pi / np.log(2) * 0.1 * radius**2
    # Depths are even from half to one and a half: their standard deviation is 0.29.
    error = 4 * np.sqrt(1 + 0.29**2) / np.sqrt(count)
    assert loss.sum() == pytest.approx(count * volume, rel=error)
    row, col = np.unravel_index(
        np.argmax(loss * _inside(loss.shape, 4 * radius)), loss.shape
    )
    along = loss[row, col + np.arange(0, round(radius) + 1)]
    assert along[-1] / along[0] == pytest.approx(0.5, abs=0.2)


def _inside(shape, margin):
    inner = np.zeros(shape)
    cut = round(margin)
    inner[cut:-cut, cut:-cut] = 1
    return inner


def test_depths_are_even_about_their_mean():
    loss = loss_of(radius=2.0, density=100.0)
    highest = (loss == ndimage.maximum_filter(loss, 9)) & (loss > 0.02)
    depths = loss[highest]
    # A middle lies up to 0.7 px beside a pixel's: 8 % less.
    assert 0.09 * 0.9 < depths.min() and np.quantile(depths, 0.9) < 0.3
    assert depths.mean() == pytest.approx(0.2, rel=0.15)


def test_a_deeper_map_is_the_same_map():
    """Of faint spots: where two overlap, their shares of light multiply."""
    faint, deeper = (loss_of(depth=depth) for depth in (0.001, 0.003))
    np.testing.assert_allclose(3 * faint, deeper, atol=3e-5)


def test_spots_reach_over_all_edges_of_a_frame():
    """Their middles lie as often above and left of it as below and right."""
    loss = loss_of(density=10000.0, radius=20.0, depth=0.01)
    edges = [loss[0], loss[-1], loss[:, 0], loss[:, -1]]
    inner = loss[100:-100, 100:-100].mean()
    for edge in edges:
        assert edge.mean() == pytest.approx(inner, rel=0.15)


def test_it_scales_light_alone():
    image = of.noise_image(*SHAPE)
    dark = of.predicted(0 * image, ("dust", WIDE))[0]
    assert not dark.any()
    plain = of.predicted(image)[0]
    seen = of.predicted(image, ("dust", WIDE), of=of.sensor(id="dusty"))[0]
    np.testing.assert_allclose(seen, plain * (1 - loss_of()), atol=1e-6)
