# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Well: what a full one cuts of charge."""

import numpy as np
import pytest

from cg2raw.diagnose.frames.well import Well

LEVEL, DEVIATION = 0.7, 0.02


@pytest.mark.parametrize("above", [-20.0, -2.0, 0.0, 0.5, 3.0, 20.0])
def test_what_is_cut_is_that_of_the_smaller_of_charge_and_level(above):
    charge = LEVEL + above * DEVIATION
    drawn = np.random.default_rng(4).normal(charge, DEVIATION, 400_000)
    cut = np.minimum(drawn, LEVEL)
    well = Well(LEVEL, np.array([charge]), np.array([DEVIATION**2]))
    assert charge - well.cut[0] == pytest.approx(cut.mean(), abs=2e-4)
    left = DEVIATION**2 - well.cut[1]
    assert left == pytest.approx(cut.var(), abs=0.01 * DEVIATION**2)


@pytest.mark.parametrize("values", [{}, {"full_well": [0.0]}])
def test_a_profile_without_one_cuts_nothing(values):
    assert Well.of(values, np.ones(3), np.ones(3)) is None
