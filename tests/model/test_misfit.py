# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A misfit is 1 where a fit is right, and says by how much and where it is not."""

import numpy as np
import pytest
from scipy.stats import chi2

from cg2raw.model.fit import fit
from cg2raw.model.likelihood import Likelihood, Misfit, misfits
from cg2raw.statistics.constant import PIXEL, GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics
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


@pytest.mark.parametrize(("noise", "seed"), [(0.2, 0), (0.23, 1)])
def test_squares_of_few_codes_vary_more(noise, seed):
    """About a whole code, 1 to 3 % of the samples have another one, by whose number the
    squares vary three times as much as those of normal noise."""
    rng, shape = np.random.default_rng(seed), (64, 80)
    groups = []
    for time in (0.0, 1.0):
        frames = np.rint(64 + noise * rng.standard_normal((2, *shape)))
        info = GroupInfo("dark", ("a", "b"), time, None, "")
        groups.append((info, [lambda f=f: f for f in frames.astype(np.uint16)]))
    likelihood = fit(frame_statistics(groups, 2, 1023)).likelihood
    theta = np.zeros(len(likelihood.parameters.names))
    theta[likelihood.parameters.each("read_noise")] = noise**2
    theta[likelihood.parameters.each("black_level")] = 64.0
    likelihood = Likelihood(likelihood.means.statistics, theta)
    every = {(one.what, one.part): one for one in misfits(likelihood, theta)}
    one = every["pattern", "pixel"]
    normal = sum(plane.plane.freedom[PIXEL] for plane in likelihood.planes)
    assert 0.02 < one.freedom / (2 * normal) < 0.3
    away = (one.squares / one.freedom - 1) / np.sqrt(2 / one.freedom)
    assert abs(away) < 3.5


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
