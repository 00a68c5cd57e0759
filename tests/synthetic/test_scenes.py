# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Procedural scenes have the statistics that are stated."""

import numpy as np
import pytest

from cg2raw.synthetic.scenes import texture


@pytest.mark.parametrize("power", [1.1, 1.6])
def test_the_spectrum_of_a_texture_falls_by_a_power_of_frequency(power):
    field = texture(np.random.default_rng(1), (256, 256), power)
    assert (field.mean(), field.std()) == pytest.approx((0, 1))
    radius = np.hypot(*np.meshgrid(np.fft.fftfreq(256), np.fft.fftfreq(256)))
    inside = (radius > 0) & (radius < 0.5)
    size = np.log(np.abs(np.fft.fft2(field)))[inside]
    slope = np.polyfit(np.log(radius[inside]), size, 1)[0]
    assert slope == pytest.approx(-power, abs=0.05)
