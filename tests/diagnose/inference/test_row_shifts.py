# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shifts of rows are found beside rates that differ by far more than they."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.log_normal_law import LogNormal, Rates
from cg2raw.diagnose.inference.log_normal_map import Mixture
from cg2raw.diagnose.inference.row_shifts import row_shifts

SHAPE = (1, 80, 120)
LAW = Mixture(LogNormal(0.0, 4.0, 1.3))
ERROR, SHOT, ROWS = 1.0, 0.2, 1.0  # variances, of pixels without charge and of rows
KNOWN = np.ones(SHAPE, bool)


def planted(rows=ROWS, seed=2):
    """Return (rates as they are estimated, shifts of rows, rates)."""
    rng = np.random.default_rng(seed)
    true = LAW.law.rate * np.expm1(LAW.law.log_sigma * rng.standard_normal(SHAPE))
    shifts = np.sqrt(rows) * rng.standard_normal((1, SHAPE[1], 1))
    zero = ERROR + SHOT * LAW.law.rate  # variance where a rate is the median
    noise = np.sqrt(zero + SHOT * true) * rng.standard_normal(SHAPE)
    columns = (np.full(SHAPE, each) for each in (zero, SHOT, zero - ERROR))
    return Rates(true + shifts + noise, *columns), shifts, true


def test_slow_pixels_tell_them_better_than_means_of_all():
    rates, shifts, _ = planted()
    found = row_shifts(LAW, rates, KNOWN, ROWS * np.ones(SHAPE))
    error = (found - (shifts - shifts.mean())).std()
    means = rates.estimate.mean(2, keepdims=True)
    assert error < 0.35 * np.sqrt(ROWS)
    assert error < 0.4 * (means - shifts).std()


def test_rows_that_differ_by_chance_alone_stay():
    rates, _, _ = planted(rows=0.0)
    found = row_shifts(LAW, rates, KNOWN, ROWS * np.ones(SHAPE))
    assert found.std() < 0.1 * np.sqrt(ROWS)


@pytest.mark.parametrize("most", [0.0, 1e-4])
def test_rows_move_no_more_than_their_offsets_do(most):
    """What rows of a sensor have of their own is its map's."""
    rates, _, _ = planted()
    found = row_shifts(LAW, rates, KNOWN, most * np.ones(SHAPE))
    assert found.std() <= 0.01 * np.sqrt(ROWS)


def test_rows_that_nothing_is_known_of_do_not_move():
    rates, shifts, _ = planted()
    known = KNOWN.copy()
    known[:, :6] = known[:, :, :9] = False
    rates.estimate[~known] = np.nan
    found = row_shifts(LAW, rates, known, ROWS * np.ones(SHAPE))
    assert (found[:, :6] == 0).all()
    told = shifts[:, 6:] - shifts[:, 6:].mean()
    assert (found[:, 6:] - told).std() < 0.35 * np.sqrt(ROWS)
