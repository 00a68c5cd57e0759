# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The slow part of a map of rates is one, and not what many pixels have by chance."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.slow_part import slow_part

SHAPE = (1, 112, 144)
KNOWN = np.ones(SHAPE, bool)


def rates(seed):
    return np.exp(1.2 * np.random.default_rng(seed).standard_normal(SHAPE))


@pytest.mark.parametrize("repeat", [1, 2])
def test_pixels_that_differ_much_have_no_slow_part(repeat):
    """Any smoothing of them leaves a tenth of what they differ by, by chance."""
    left = [slow_part(rates(seed), KNOWN, repeat).std() for seed in range(8)]
    assert np.median(left) < 0.05


def test_a_slope_beside_them_is_found():
    slope = np.broadcast_to(np.linspace(-1, 1, SHAPE[2]), SHAPE)
    found = slow_part(rates(9) + slope, KNOWN, 2)
    across = found[0].mean(0)[12:-12]
    assert np.polyfit(slope[0, 0, 12:-12], across, 1)[0] == pytest.approx(1, abs=0.1)


def test_levels_of_sites_are_none():
    """A site's sample of skewed rates has a mean of its own, and a real one is no slope
    of the scene."""
    for more in (0.0, 0.5):
        image = rates(3)
        image[:, ::2, ::2] += more
        found = slow_part(image, KNOWN, 2)
        sites = [found[:, r::2, c::2].mean() for r in (0, 1) for c in (0, 1)]
        assert np.abs(sites).max() < 1e-12
