# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Normal equations against dense linear algebra."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from cg2raw.diagnose.scenes.gram import Gram, Normal, Space

SPACE = Space.of({"a": 2, "b": 1, "c": 3})
DEVIATIONS = np.array([0.3, 0.1])


@pytest.fixture(scope="module")
def rows():
    """Return (effects (6, 400), nuisances (2, 400), residual (400,)), whitened."""
    rng = np.random.default_rng(1)
    return rng.normal(size=(6, 400)), rng.normal(size=(2, 400)), rng.normal(size=400)


def gram_of(rows):
    effects, nuisances, residual = rows
    every = np.vstack([effects, nuisances, residual[None]])
    normal = Normal(400, every @ every.T).without(np.array([6, 7]), DEVIATIONS)
    return normal.gram(6)


def test_a_space_knows_where_parameters_are():
    assert SPACE.size == 6
    assert SPACE.index({"c", "a"}).tolist() == [0, 1, 3, 4, 5]
    assert SPACE.index([]).tolist() == []


def test_what_is_integrated_out_is_a_normal_marginal(rows):
    """A theta's gain is that of the density in which nuisances are covariance."""
    effects, nuisances, residual = rows
    covariance = np.eye(400) + (nuisances.T * DEVIATIONS**2) @ nuisances
    law = multivariate_normal(np.zeros(400), covariance)
    theta = np.array([0.1, -0.2, 0.05, 0.0, 0.3, -0.1])
    gain = law.logpdf(residual - theta @ effects) - law.logpdf(residual)
    assert gram_of(rows).gain(theta) == pytest.approx(gain, abs=1e-8)


def test_the_fit_is_the_top_and_others_stay_zero(rows):
    gram = gram_of(rows)
    index = SPACE.index({"a", "c"})
    best = gram.fit(index)
    assert best[2] == 0
    for k in index:
        for step in (-1e-3, 1e-3):
            moved = best.copy()
            moved[k] += step
            assert gram.gain(moved) < gram.gain(best)
    inverse = np.linalg.inv(gram.information[np.ix_(index, index)])
    assert gram.covariance(index) == pytest.approx(inverse, rel=1e-6)


def test_information_given_others_is_a_schur_complement(rows):
    gram = gram_of(rows)
    own, others = SPACE.index({"b"}), SPACE.index({"a", "c"})
    inverse = np.linalg.inv(gram.information)
    assert 1 / gram.given(own, others)[0, 0] == pytest.approx(inverse[2, 2], rel=1e-6)


def test_what_no_sample_shows_stays_zero():
    information = np.diag([4.0, 0.0])
    gram = Gram(10, 5.0, np.array([2.0, 0.0]), information)
    assert gram.fit(np.array([0, 1])).tolist() == pytest.approx([0.5, 0.0])


def test_nuisances_of_most_likelihood(rows):
    effects, nuisances, residual = rows
    every = np.vstack([effects, nuisances, residual[None]])
    normal = Normal(400, every @ every.T)
    theta = np.full(6, 0.1)
    found = normal.found(np.array([6, 7]), DEVIATIONS, theta)
    design = np.hstack([nuisances, np.diag(1 / DEVIATIONS)])
    target = np.concatenate([residual - theta @ effects, [0, 0]])
    expected = np.linalg.lstsq(design.T, target, rcond=None)[0]
    assert found == pytest.approx(expected, rel=1e-8)


def test_patterns_in_a_score_are_those_of_what_nuisances_leave(rows):
    """The covariance of the score of drawn patterns, in all samples alike."""
    effects, nuisances, residual = rows
    every = np.vstack([effects, nuisances, residual[None]])
    share = np.linspace(0.1, 2, every.shape[1])
    normal = Normal(400, every @ every.T, (every * share) @ every.T)
    found = normal.without(np.array([6, 7]), DEVIATIONS).gram(6).shared
    inner = nuisances @ nuisances.T + np.diag(DEVIATIONS**-2.0)
    left = effects - effects @ nuisances.T @ np.linalg.solve(inner, nuisances)
    assert found == pytest.approx((left * share) @ left.T, rel=1e-8)
    assert (normal + normal).without(np.array([6, 7]), DEVIATIONS).views == 2


def test_nuisances_may_be_integrated_out_one_by_one(rows):
    """Their rows stay, as zeros."""
    every = np.vstack([*rows[:2], rows[2][None]])
    shared = (every * np.linspace(0.1, 2, every.shape[1])) @ every.T
    normal = Normal(400, every @ every.T, shared)
    at_once, left = normal.without(np.array([6, 7]), DEVIATIONS), normal
    for k in range(2):
        left = left.without(np.array([6 + k]), DEVIATIONS[k : k + 1])
    assert left.products == pytest.approx(at_once.products, rel=1e-8, abs=1e-8)
    assert left.shared == pytest.approx(at_once.shared, rel=1e-8, abs=1e-8)
    assert not left.products[6:8].any() and not left.shared[6:8].any()


def test_a_prior_pulls_to_the_profile(rows):
    gram = gram_of(rows)
    index = SPACE.index({"b"})
    pulled = gram.with_prior(index, np.array([1e-6])).fit(index)
    assert abs(pulled[2]) < 1e-6 < abs(gram.fit(index)[2])
