# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The law of rates has its moments; densities and posteriors are those of its parts."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import logsumexp
from scipy.stats import norm

from cg2raw import _core
from cg2raw.diagnose.inference.log_normal_law import LogNormal, Rates

LAW = LogNormal(0.3, 2.0, 0.7)
NUMBER = 1500  # more than a piece of the kernel


def some_rates():
    rng = np.random.default_rng(4)
    estimate = LAW.shift + 2 * np.expm1(0.7 * rng.standard_normal(NUMBER))
    error, per_rate = rng.uniform(0.01, 2, NUMBER), rng.uniform(0, 0.5, NUMBER)
    of_charge = error * rng.uniform(0, 0.9, NUMBER)
    columns = np.stack([estimate, error, per_rate, of_charge])
    return Rates(*columns.reshape(4, 3, 20, 25))


def parts_of(law, rates):
    """Return (log weight times density, mean, variance) by each normal, in NumPy."""
    weights, means, variances = (n.reshape(-1, 1, 1, 1) for n in law.normals())
    error = rates.error_at(means)
    away = rates.estimate - law.shift - means
    logs = np.log(weights) + norm.logpdf(away, scale=np.sqrt(variances + error))
    kept = variances / (variances + error)
    return logs, means + kept * away, kept * error


def test_parts_of_the_law_have_its_moments():
    law = LogNormal(0.0, 2.0, 0.7)
    weights, means, variances = law.normals()
    mean = 2 * np.expm1(0.7**2 / 2)
    assert weights.sum() == pytest.approx(1)
    assert weights @ means == pytest.approx(mean, rel=1e-4)
    variance = 4 * np.exp(0.7**2) * np.expm1(0.7**2)
    spread = weights @ (variances + (means - mean) ** 2)
    assert spread == pytest.approx(variance, 1e-3)


def test_density_is_that_of_the_law_and_the_noise():
    """By integration over the law itself, of which the normals are an approximation."""
    error = 0.8
    for estimate in (-1.5, 0.3, 4.0, 20.0):

        def density(n, value=estimate):
            rate = 2 * np.expm1(0.7 * n)
            return norm.pdf(n) * norm.pdf(
                value - LAW.shift - rate, scale=np.sqrt(error)
            )

        expected = np.log(quad(density, -8, 8, limit=400, epsabs=0)[0])
        one = Rates(*(np.array([number]) for number in (estimate, error, 0.0, 0.0)))
        assert LAW.log_density(one)[0] == pytest.approx(expected, abs=2e-3)


def test_density_and_posterior_are_those_of_all_parts():
    rates = some_rates()
    logs, means, variances = parts_of(LAW, rates)
    total = logsumexp(logs, axis=0)
    np.testing.assert_allclose(LAW.log_density(rates), total, rtol=1e-12)
    share = np.exp(logs - total)
    expected = (share * means).sum(0)
    mean, variance = LAW.posterior(rates)
    np.testing.assert_allclose(mean, expected, rtol=1e-11, atol=1e-12)
    square = (share * (variances + means**2)).sum(0)
    np.testing.assert_allclose(variance, square - expected**2, rtol=1e-9, atol=1e-12)


def test_far_from_all_parts_a_density_is_small_and_finite():
    far = Rates(*np.array([[-1e4, 1e7, 1e3], [0.1] * 3, [0.0] * 3, [0.0] * 3]))
    logs, *_ = (part.reshape(-1, 3) for part in parts_of(LAW, far_as_map(far)))
    np.testing.assert_allclose(
        LAW.log_density(far), logsumexp(logs, axis=0), rtol=1e-12
    )
    mean, variance = LAW.posterior(far)
    assert np.isfinite([mean, variance]).all() and (variance >= 0).all()


def far_as_map(rates):
    return Rates(*(column.reshape(1, 1, -1) for column in rates.columns))


def test_estimates_are_as_sure_whatever_comes_beside_them():
    rates = some_rates()
    flat = Rates(*(column.ravel() for column in rates.columns))
    for first, last in ((0, 1), (3, 700), (511, 514)):
        alone = LAW.log_density(flat.at(slice(first, last)))
        np.testing.assert_array_equal(alone, LAW.log_density(flat)[first:last])


@pytest.mark.parametrize("shapes", [((2, 5), (4, 4)), ((3, 5), (3, 4)), ((3,), (4, 4))])
def test_other_shapes_are_refused(shapes):
    law, estimates = (np.ones(shape) for shape in shapes)
    for function in (_core.log_density_of_mixture, _core.posterior_of_mixture):
        with pytest.raises(ValueError, match="array of (three|four) rows"):
            function(law, estimates)


def test_no_estimates_have_no_densities():
    none = np.zeros((4, 0))
    law = np.stack(LAW.normals())
    assert _core.log_density_of_mixture(law, none).shape == (0,)
