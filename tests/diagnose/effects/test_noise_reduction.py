# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import numpy as np
import pytest

from cg2raw.diagnose.effects.catalogue import effect

FILTER = effect("noise_reduction")


@pytest.mark.parametrize(
    ("values", "bounded"),
    [([-0.5, -0.3], [0.0, -0.1]), ([0.95, 0.5], [0.9, 0.4]), ([0.2, 0.1], [0.2, 0.1])],
)
def test_a_filter_that_sharpens_is_none(values, bounded):
    found = FILTER.within_registry_bounds(np.array(values))
    assert found == pytest.approx(bounded)


def test_what_a_filter_leaves_of_white_noise_is_the_sum_of_squared_weights():
    """The middle has the rest; 4 neighbours of one colour a quarter of the blend each,
    and 4 on diagonals a quarter of theirs."""
    weights = [1 - 0.3 - 0.1, *4 * [0.3 / 4], *4 * [0.1 / 4]]
    left = FILTER.variance_left(np.array([0.3, 0.1]))
    assert left == pytest.approx(np.square(weights).sum())
