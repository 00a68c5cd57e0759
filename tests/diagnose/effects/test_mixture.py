# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Normal scores of residuals that are a sum of normals, against SciPy's functions."""

import numpy as np
import pytest
from scipy.special import ndtr, ndtri
from scipy.stats import kstest

from cg2raw import _core
from cg2raw.diagnose.effects.mixture import normal_score

FAR = np.array([0.0, -0.0, 1e-9, 0.4, -1.0, 5.0, -30.0, 36.0, -40.0, 1e3, -1e5])


def residuals(count=4001, seed=1):
    """Return (1, 1, n): of noise, and others as far out as there are any."""
    z = np.random.default_rng(seed).standard_normal(count)
    return np.concatenate([FAR, z])[None, None]


def expected(z, chance, narrow, wide):
    tail = chance * ndtr(-np.abs(z) / np.sqrt(wide))
    tail = tail + (1 - chance) * ndtr(-np.abs(z) / np.sqrt(narrow))
    white = -np.sign(z) * ndtri(np.maximum(tail, 1e-300))
    with np.errstate(divide="ignore"):
        log_wide = np.log(chance) - 0.5 * z * z / wide - 0.5 * np.log(wide)
        log_narrow = np.log1p(-chance) - 0.5 * z * z / narrow - 0.5 * np.log(narrow)
    return white, np.logaddexp(log_wide, log_narrow) + 0.5 * white**2


@pytest.mark.parametrize("chance", [1e-300, 1e-4, 0.3, 0.999, 1.0])
@pytest.mark.parametrize("wide", [1.0, 1.5, 80.0])
def test_scores_of_two_normals(chance, wide):
    z = residuals()
    white, cost = normal_score(z, chance, 0.8, np.full(z.shape, wide))
    right = expected(z, chance, 0.8, wide)
    np.testing.assert_allclose(white, right[0], atol=1e-10)
    np.testing.assert_allclose(cost, right[1], atol=1e-8, rtol=1e-12)


def test_every_pixel_has_a_law_of_its_own():
    z = residuals()
    rng = np.random.default_rng(2)
    chance, narrow = rng.random(z.shape), 0.5 + rng.random(z.shape)
    wide = narrow + 10 * rng.random(z.shape)
    right = expected(z, chance, narrow, wide)
    found = normal_score(z, chance, narrow, wide)
    np.testing.assert_allclose(found[0], right[0], atol=1e-10)
    np.testing.assert_allclose(found[1], right[1], atol=1e-8, rtol=1e-12)


def test_scores_of_tails_are_normal():
    rng = np.random.default_rng(3)
    wide = rng.random((1, 100, 200)) < 0.1
    z = rng.standard_normal(wide.shape) * np.where(wide, 3.0, 0.7)
    white, _ = normal_score(z, 0.1, 0.49, np.full(z.shape, 9.0))
    assert kstest(white.ravel(), "norm").pvalue > 1e-3


@pytest.mark.parametrize("count", [0, 1, 511, 512, 513])
def test_pieces_make_no_difference(count):
    z = residuals()[0, 0]
    law = [np.full(z.size, value) for value in (0.1, 0.8, 4.0)]
    whole = _core.normal_scores_of_two(z, *law)
    part = _core.normal_scores_of_two(z[:count], *(one[:count] for one in law))
    for some, all_of_them in zip(part, whole, strict=True):
        np.testing.assert_array_equal(some, all_of_them[:count])


def test_other_shapes_are_refused():
    z = np.zeros(5)
    with pytest.raises(ValueError, match="as many"):
        _core.normal_scores_of_two(z, z, z, z[:4])
