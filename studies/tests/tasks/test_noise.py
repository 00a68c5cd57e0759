# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise that is added: its variance, and whose it is."""

import numpy as np
import pytest

from cg2raw import Sensor
from studies.tasks.noise import Noise, noise_of
from studies.tasks.quality import psnr

NOISE = Noise(2e-3, 1e-4)


def test_noise_has_the_variance_that_is_stated():
    planes = np.full((4, 4, 200, 200), 0.3, np.float32)
    noisy = NOISE.added(planes, np.random.default_rng(1))
    assert noisy.mean() == pytest.approx(0.3, abs=2e-4)
    assert noisy.var() == pytest.approx(2e-3 * 0.3 + 1e-4, rel=0.01)
    assert NOISE.added(-planes, np.random.default_rng(1)).var() == pytest.approx(
        1e-4, rel=0.01
    )


def test_noisy_planes_have_the_psnr_of_their_variance():
    """To 0.05 dB: 160000 sites know their variance to 0.35 %, one in 250 by 3 sd."""
    planes = np.full((1, 4, 200, 200), 0.3, np.float32)
    found = psnr(NOISE.added(planes, np.random.default_rng(2)), planes)
    assert found == pytest.approx([-10.0 * np.log10(2e-3 * 0.3 + 1e-4)], abs=0.05)


def test_noise_is_the_sensors_mean_over_sites():
    noise = noise_of(Sensor("samsung-s20fe"), 3200)
    known = Sensor("samsung-s20fe").noise_at(3200)
    assert noise.of_signal == pytest.approx(np.mean(known["beta1"]))
    assert noise.constant == pytest.approx(np.mean(known["beta2"]))
