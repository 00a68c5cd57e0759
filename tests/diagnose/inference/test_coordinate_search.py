# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A search along coordinates ends at the top, and asks for few likelihoods."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.coordinate_search import best_values
from cg2raw.diagnose.likelihood.model import Term
from diagnose.planted import BY_NAME

TAILS = BY_NAME["heavy_tailed_noise"]
TOP = np.array([0.043, 13.0])


class Heights:
    """A log-likelihood that is highest at TOP, where it is known to a share."""

    def __init__(self, known_to):
        self.known_to, self.asked = known_to, []

    def __call__(self, values):
        self.asked.append(values)
        x, y = np.log(values / TOP) / self.known_to
        # Skewed, as a likelihood is far from its top.
        return -0.5 * (x * x + y * y + x * y) - 0.02 * self.known_to * x**3


@pytest.mark.parametrize(("known_to", "most"), [(0.3, 30), (0.01, 60), (1e-3, 60)])
def test_it_ends_at_the_top(known_to, most):
    heights = Heights(known_to)
    values, highest = best_values(Term(TAILS, np.zeros(2)), heights)
    np.testing.assert_allclose(values, TOP, rtol=0.2 * known_to)
    assert highest > -0.02
    assert len(heights.asked) <= most


def test_it_goes_on_from_what_was_found():
    heights = Heights(0.01)
    first, _ = best_values(Term(TAILS, np.zeros(2)), heights)
    whole = len(heights.asked)
    again = Heights(0.01)
    values, _ = best_values(Term(TAILS, first), again)
    np.testing.assert_allclose(values, first, rtol=2e-3)
    assert np.array_equal(again.asked[0], first)
    assert len(again.asked) < 0.8 * whole
    starts = [np.array(start) for start in TAILS.starts]
    asked = again.asked
    assert not any(np.array_equal(one, start) for one in asked for start in starts)


def test_a_start_that_was_not_searched_from_is_none_that_was_found():
    """A quick search, as of screening, ends at the best of its starts."""
    quick, _ = best_values(Term(TAILS, np.zeros(2)), Heights(0.01), quick=True)
    heights = Heights(0.01)
    best_values(Term(TAILS, quick), heights)
    for start in TAILS.starts:
        assert any(np.array_equal(one, start) for one in heights.asked)
