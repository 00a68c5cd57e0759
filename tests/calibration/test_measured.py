# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Moments that values far off do not move."""

import numpy as np
import pytest

from cg2raw.calibration.measured import CUT, clipped_moments


@pytest.mark.parametrize("outliers", [0, 50])
def test_moments_are_those_of_most_values(outliers):
    """Of 200,000 normal deviates: the deviation is that before the cut, by a variance
    of which a cut at 4 sigma leaves all but 1.07e-3."""
    values = np.random.default_rng(2).normal(5.0, 2.0, 200_000)
    inside = values[np.abs(values - 5) <= 2 * CUT]
    values[:outliers] = 1e4
    mean, sigma = clipped_moments(values)
    assert mean == pytest.approx(inside.mean(), abs=1e-3)
    assert sigma == pytest.approx(inside.std() / np.sqrt(1 - 1.07e-3), rel=2e-4)
