# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A misfit is 1 where a fit is right, and says by how much and where it is not."""

import numpy as np
import pytest
from scipy.stats import chi2

from cg2raw.model.fit import fit
from cg2raw.model.likelihood import Misfit, misfits
from model.planted import planted

P_VALUE = 1e-5  # of some dozens of tests


@pytest.fixture(scope="module")
def found():
    return fit(planted(3).statistics)


def test_a_right_fit_has_none(found):
    every = list(misfits(found.likelihood, found.theta))
    assert {one.what for one in every} == {"noise", "pattern"}
    for one in every:
        chance = chi2.sf(one.squares, one.freedom), chi2.cdf(one.squares, one.freedom)
        assert min(chance) > P_VALUE, one


@pytest.mark.parametrize(
    ("parameter", "factor", "what", "part"),
    [
        ("read_noise", 0.8, "noise", "pixel"),
        ("row_noise", 0.2, "noise", "fast_rows"),
        ("column_fixed_pattern", 0.1, "pattern", "fast_columns"),
        ("prnu", 0.5, "pattern", "pixel"),
    ],
)
def test_a_wrong_one_has_it_where_it_is_wrong(found, parameter, factor, what, part):
    theta = found.theta.copy()
    theta[found.parameters.of(parameter)] *= factor
    worst = max(misfits(found.likelihood, theta), key=lambda one: one.nats)
    assert (worst.what, worst.part) == (what, part)
    assert worst.ratio > 1.03
    if parameter == "prnu":
        groups = found.likelihood.means.statistics.groups
        assert groups[worst.group].kind == "flat"


def test_nats_are_those_of_a_right_variance():
    one = Misfit("noise", "pixel", 0, 110.0, 100.0)
    assert one.ratio == pytest.approx(1.1)
    assert one.nats == pytest.approx(50 * (0.1 - np.log(1.1)))
