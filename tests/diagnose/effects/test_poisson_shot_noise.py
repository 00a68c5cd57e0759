# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm, poisson

from cg2raw.diagnose.effects.catalogue import effect

WHITENED = effect("poisson_shot_noise").whitened


def light(photons):
    """Return the prediction of a pixel that gets so many of 400 photons at white."""
    x = photons / 400
    return SimpleNamespace(exposed=x, photon_variance=x / 400, variance=x / 400)


@pytest.mark.parametrize("photons", [100, 400])
def test_whitened_counts_are_standard_normal(photons):
    """Between two counts as many are below as of a normal number, but for terms of the
    third order: photons^-1.5, and 5 times that three deviations off."""
    counts = np.arange(photons - 3 * photons**0.5, photons + 3 * photons**0.5)
    z = (counts + 0.5 - photons) / np.sqrt(photons)
    white, cost = WHITENED(z, light(photons), True, 0.0)
    expected = norm.ppf(poisson.cdf(counts, photons))
    np.testing.assert_allclose(white, expected, atol=6 * photons**-1.5)
    slope = np.gradient(white, z)[1:-1]
    np.testing.assert_allclose(np.exp(cost[1:-1]), slope, atol=1e-5)


@pytest.mark.parametrize(
    ("z", "is_counted"), [([-7.5, 8.0], True), ([-2.0, 0.0, 3.0], False)]
)
def test_what_is_far_off_or_not_counted_stays(z, is_counted):
    white, cost = WHITENED(np.array(z), light(100), is_counted, 0.0)
    assert np.array_equal(white, z) and not cost.any()


@pytest.mark.parametrize("photons", [20, 200])
def test_counts_are_told_from_normal_noise_by_their_negentropy(photons):
    """Of Poisson's law less that of a normal one of its moments, but for terms of the
    next order in 1 / photons; a half of it moves all cumulants by half."""
    counts = np.arange(poisson.ppf(1e-12, photons), poisson.ppf(1 - 1e-12, photons))
    law = poisson.pmf(counts, photons)
    nats = law @ np.log(law / norm.pdf(counts, photons, photons**0.5))
    x = np.full((1, 4, 5), photons / 400)
    p = SimpleNamespace(exposed=x, photon_variance=x / 400, variance=x / 400)
    keep = np.ones(x.shape, bool)
    keep[0, 0] = False
    gain = effect("poisson_shot_noise").expected_gain([(SimpleNamespace(keep=keep), p)])
    assert gain(1.0) == pytest.approx(15 * nats, rel=4 / photons)
    assert gain(0.5) == pytest.approx(gain(1.0) / 4)
