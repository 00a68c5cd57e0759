# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Moments that values far off do not move."""

import numpy as np
import pytest

from cg2raw.calibration.measured import CUT, Measured, clipped_moments, linear_fit


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


@pytest.mark.parametrize(
    ("value", "stands_out", "as_root"),
    [(2.9, False, False), (3.1, True, False), (5.9, True, False), (6.1, True, True)],
)
def test_a_number_stands_out_at_three_standard_errors(value, stands_out, as_root):
    """And one that is the root of a variance where that does: at six of its own."""
    one = Measured(value, 1.0, "DN")
    assert (one.stands_out, one.variance_stands_out) == (stands_out, as_root)
    scaled = one.scaled(-0.5, "e-")
    assert scaled == Measured(-value / 2, 0.5, "e-")
    assert (scaled.stands_out, scaled.variance_stands_out) == (stands_out, False)


def test_a_line_is_that_of_most_values_within_its_errors():
    """Of 400 with noise of 0.5, of which a tenth is far off."""
    x, away = np.linspace(0, 1, 400), []
    design = np.column_stack([np.ones(400), x])
    for seed in range(40):
        rng = np.random.default_rng(seed)
        y = 3 + 2 * x + 0.5 * rng.standard_normal(400)
        y[rng.choice(400, 40, replace=False)] += 30
        fit = linear_fit(design, y)
        away.append((fit.values - (3, 2)) / np.sqrt(np.diag(fit.covariance)))
        assert fit.variance == pytest.approx(0.25, rel=0.3)
        assert fit.rest == pytest.approx(y - design @ fit.values)
    assert np.std(away, axis=0) == pytest.approx([1, 1], rel=0.35)
    assert np.abs(np.mean(away, axis=0)).max() < 0.6
    y[:2] = 1000.0  # which count however far off they are
    assert (
        linear_fit(design, y, first=2).values[0] > 5 > linear_fit(design, y).values[0]
    )
