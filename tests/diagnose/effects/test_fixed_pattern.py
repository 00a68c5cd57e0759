# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import numpy as np
import pytest

from cg2raw.diagnose.effects.catalogue import effect


def test_the_variance_of_pixels_that_jump_is_that_of_their_steps():
    """Of a step s, up half of the time, s^2 / 4; steps are exponential."""
    jumps = effect("random_telegraph_noise")
    stated = {"fraction": 0.02, "amplitude": 0.003}
    steps = np.random.default_rng(2).exponential(stated["amplitude"], 1_000_000)
    expected = stated["fraction"] * (steps**2).mean() / 4
    found = jumps.pattern_variance(stated, np.zeros(1), 1.0)
    assert found == pytest.approx(expected, rel=0.01)


def test_a_pattern_of_pixels_is_of_offsets_or_of_their_share_of_light():
    light = np.array([[[0.0, 0.1, 0.5]]])
    prnu, dsnu = (
        effect(name).pattern_variance({"sigma": 0.02}, light, 3.0)
        for name in ("prnu", "dsnu")
    )
    assert prnu == pytest.approx((0.02 * light) ** 2) and dsnu == 0.02**2


def test_moments_of_dark_current_that_differs_are_those_of_its_law():
    uneven = effect("dark_current_nonuniformity")
    stated, seconds = {"rate": 0.02, "log_sigma": 0.5}, 3.0
    normal = np.random.default_rng(1).standard_normal(4_000_000)
    charge = seconds * stated["rate"] * np.expm1(stated["log_sigma"] * normal)
    away = charge - charge.mean()
    moments = (
        uneven.pattern_mean(stated, seconds),
        uneven.pattern_variance(stated, np.zeros(1), seconds),
        uneven.pattern_third_cumulant(stated, seconds),
    )
    measured = charge.mean(), (away**2).mean(), (away**3).mean()
    assert moments == pytest.approx(measured, rel=0.02)
