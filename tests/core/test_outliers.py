# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Read noise with outliers: the moments of a mixture, and draws that can be told
apart one by one."""

import numpy as np
import pytest
from scipy import stats

import cg2raw
from oracles import cameras
from tiers import first_fast

SIDE = 2048
BETA2 = 1e-6
NORMAL = 0.14  # the lambda whose core is drawn as a normal where there are outliers
FRACTION, RATIO = 0.02, 16.0


def darks(tukey_lambda=NORMAL, fraction=FRACTION, ratio=RATIO, side=SIDE, **run):
    """(side, side) of a signal of 0, over the standard deviation asked for."""
    values = {f"beta2_{site}": BETA2 for site in ("00", "01", "10", "11")}
    values |= {"tukey_lambda": tukey_lambda}
    values |= {"outlier_fraction": fraction, "outlier_variance_ratio": ratio}
    effects = [{"name": "heavy_tailed_noise", "parameters": values}]
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(effects=effects))
    rgb = np.zeros((side, side, 3), np.float32)
    seen = sensor.signal(rgb, illuminant="A", camera_input=True, **run)
    return np.asarray(seen, float) / np.sqrt(BETA2)


def mixture_moment(of_core, order, fraction, ratio):
    """A central moment of the mixture, in standard deviations to the same power."""
    core = 1.0 / (1.0 + fraction * (ratio - 1.0))
    weights = 1.0 - fraction + fraction * ratio ** (order / 2)
    return of_core * weights * core ** (order / 2)


MIXTURES = [(0.02, 16.0), (0.002, 100.0), (0.3, 4.0), (0.5, 1.0)]


@pytest.mark.parametrize(("fraction", "ratio"), first_fast(MIXTURES, 2))
def test_moments_are_those_of_two_normals(fraction, ratio):
    z = darks(fraction=fraction, ratio=ratio, seed=3).ravel()
    for order, of_normal in ((2, 1.0), (4, 3.0), (6, 15.0)):
        square = {2: 3.0, 4: 105.0, 6: 10395.0}[order]  # moment of twice the order
        expected = mixture_moment(of_normal, order, fraction, ratio)
        spread = mixture_moment(square, 2 * order, fraction, ratio) - expected**2
        error = np.sqrt(spread / z.size)
        assert np.mean(z**order) == pytest.approx(expected, abs=4.0 * error), order
    assert z.mean() == pytest.approx(0.0, abs=4.0 / np.sqrt(z.size))


def test_draws_are_distributed_as_two_normals():
    z = darks(seed=4, side=1000).ravel()
    narrow = np.sqrt(1.0 / (1.0 + FRACTION * (RATIO - 1.0)))
    wide = narrow * np.sqrt(RATIO)

    def cdf(x):
        outliers = FRACTION * stats.norm.cdf(x / wide)
        return outliers + (1.0 - FRACTION) * stats.norm.cdf(x / narrow)

    assert stats.kstest(z, cdf).pvalue > 1e-3
    assert stats.kstest(z, "norm").pvalue < 1e-6, "one normal would do"


@pytest.mark.parametrize("tukey_lambda", first_fast([-0.1, 0.05, 0.3], 1))
def test_other_cores_keep_their_tails(tukey_lambda):
    z = darks(tukey_lambda, 0.1, 9.0, seed=5).ravel()
    variance, excess = stats.tukeylambda.stats(tukey_lambda, moments="vk")
    expected = mixture_moment(3.0 + float(excess), 4, 0.1, 9.0)
    assert np.isfinite(variance)
    assert z.var() == pytest.approx(1.0, rel=0.01)
    parts = np.mean(z.reshape(64, -1) ** 4, axis=1)
    error = parts.std() / np.sqrt(64)
    assert np.mean(z**4) == pytest.approx(expected, abs=5.0 * error)
    assert error < 0.05 * expected


@pytest.mark.parametrize("tukey_lambda", [NORMAL, -0.1])
def test_every_draw_is_the_core_or_the_core_widened(tukey_lambda):
    """With a ratio of 1 all draws are of the core; the same key draws the same core."""
    core = darks(tukey_lambda, FRACTION, 1.0, side=1024, seed=6)
    mixed = darks(tukey_lambda, FRACTION, RATIO, side=1024, seed=6)
    narrow = np.sqrt(1.0 / (1.0 + FRACTION * (RATIO - 1.0)))
    far = np.abs(core) > 0.01
    quotient = np.where(far, mixed, 0.0) / np.where(far, core, 1.0) / narrow
    wide = quotient > 2.0
    np.testing.assert_allclose(quotient[far & wide], np.sqrt(RATIO), rtol=1e-5)
    np.testing.assert_allclose(quotient[far & ~wide], 1.0, rtol=1e-5)
    count = far.sum()
    error = np.sqrt(FRACTION * (1.0 - FRACTION) / count)
    assert wide[far].mean() == pytest.approx(FRACTION, abs=4.0 * error)
    # Which sites they are tells nothing of the core, of neighbours, or of frames.
    assert core[wide].var() == pytest.approx(1.0, rel=5.0 * np.sqrt(2.0 / wide.sum()))
    pairs = FRACTION**2 * wide.size
    for one, other in ((wide[1:], wide[:-1]), (wide[:, 1:], wide[:, :-1])):
        assert (one & other).sum() == pytest.approx(pairs, abs=5.0 * np.sqrt(pairs))
    later = darks(tukey_lambda, FRACTION, RATIO, side=1024, seed=6, frame=1)
    both = (np.abs(later) > 4.0) & (np.abs(mixed) > 4.0)
    chance = (np.abs(mixed) > 4.0).mean() ** 2 * mixed.size
    assert both.sum() == pytest.approx(chance, abs=5.0 * np.sqrt(chance) + 1.0)


@pytest.mark.parametrize("tukey_lambda", [NORMAL, -0.1, 0.0])
def test_without_outliers_the_draws_are_tukeys(tukey_lambda):
    """One key, one uniform per site: logistic draws tell it."""
    seen = darks(tukey_lambda, 0.0, RATIO, side=64)
    logistic = darks(0.0, 0.0, 1.0, side=64) * np.pi / np.sqrt(3.0)
    tail = 1.0 / (1.0 + np.exp(np.abs(logistic)))
    scale = np.sqrt(stats.tukeylambda.var(tukey_lambda))
    expected = -np.sign(logistic) * stats.tukeylambda.ppf(tail, tukey_lambda) / scale
    assert (abs(seen - expected) <= np.maximum(1e-5 * abs(expected), 1e-5)).all()
    assert (seen == darks(tukey_lambda, 0.0, 1.0, side=64)).all()


def test_threads_and_pieces_do_not_matter():
    whole = darks(side=600, threads=1)
    assert (whole == darks(side=600, threads=3)).all()
    assert (whole[:311, :311] == darks(side=311)).all()
