# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The noise model of Wei et al. (IEEE Trans. PAMI 44(11), 2022): its laws, planted
values that come back, and its distributions against SciPy's."""

import numpy as np
import pytest
from scipy import stats

import cg2raw
from oracles import cameras
from tiers import slow

SIDE = 1024  # a million pixels
N = SIDE * SIDE


def sensor_of(effects=(), **fields):
    effects = [{"name": name, "parameters": values} for name, values in effects]
    return cg2raw.Sensor.from_json(cameras.profile_text(effects=effects, **fields))


def per_site(name, value):
    return {f"{name}_{site}": value for site in ("00", "01", "10", "11")}


def flat_signal(sensor, level, height=SIDE, width=SIDE, **run):
    rgb = np.full((height, width, 3), level, np.float32)
    seen = sensor.signal(rgb, illuminant="A", camera_input=True, **run)
    return np.asarray(seen, float)


def electrons(mean):
    """Counts of a flat of so many electrons, and the mean exactly as it was asked."""
    level = float(np.float32(min(0.5, 0.5 * mean)))
    beta1 = level / mean
    sensor = sensor_of([("poisson_shot_noise", per_site("beta1", beta1))])
    counts = flat_signal(sensor, level, seed=int(mean * 100), convention="paper")
    counts = (counts / beta1).ravel()
    whole = np.rint(counts)
    assert np.abs(counts - whole).max() < 0.02, "whole electrons"
    return whole


# 16 is where one method gives way to the other.
MEANS = (0.01, 0.1, 0.7, 2.0, 5.0, 10.0, 15.99, 16.0, 20.0, 50.0, 300.0, 1e4, 1e5)


def pooled(counts, mean, least=50):
    """Observed and expected numbers per bin; bins expect at least so many."""
    reach = 7.0 * np.sqrt(mean) + 10.0
    top = np.arange(max(0, int(mean - reach)), int(mean + reach))
    edges, cdf, last = [], stats.poisson.cdf(top, mean), 0.0
    for k, p in zip(top, cdf, strict=True):
        if N * (p - last) >= least and N * (1.0 - p) >= least:
            edges.append(k)
            last = p
    bounds = np.concatenate([[-1], edges, [np.inf]])
    observed = np.histogram(counts, bounds + 0.5)[0]
    expected = N * np.diff(np.concatenate([[0.0], stats.poisson.cdf(edges, mean), [1]]))
    return observed, expected


@pytest.mark.parametrize("mean", MEANS)
def test_electrons_are_poisson_distributed(mean):
    counts = electrons(mean)
    assert counts.mean() == pytest.approx(mean, abs=4.0 * np.sqrt(mean / N))
    # Fourth central moment of a Poisson: mean (1 + 3 mean).
    error = np.sqrt((mean + 3.0 * mean**2 - mean**2) / N)
    assert counts.var() == pytest.approx(mean, abs=4.0 * error)
    observed, expected = pooled(counts, mean)
    assert stats.chisquare(observed, expected).pvalue > 1e-3
    distance = np.abs(np.cumsum(observed) - np.cumsum(expected)).max() / N
    assert distance < 1.95 / np.sqrt(N), "Kolmogorov and Smirnov at 1e-3"


@pytest.mark.parametrize("mean", [0.5, 2.0, 10.0, 40.0])
def test_skewness_of_photons_in_dim_light(mean):
    """1 / sqrt(electrons): what a Gaussian lacks."""
    seen = stats.skew(electrons(mean))
    error = np.sqrt((6.0 + 40.0 / mean) / N)  # of a sample's, roughly
    assert seen == pytest.approx(mean**-0.5, abs=5.0 * error)


@pytest.mark.parametrize("beta1", [1e-30, 1e-16, 1e-12])
def test_light_of_more_electrons_than_a_float_resolves_has_no_noise(beta1):
    sensor = sensor_of([("poisson_shot_noise", per_site("beta1", beta1))])
    assert flat_signal(sensor, 0.5, 64, 64) == pytest.approx(0.5, rel=1e-5)


def tukey(tukey_lambda, beta2):
    values = {**per_site("beta2", beta2), "tukey_lambda": tukey_lambda}
    return values | {"outlier_fraction": 0.0, "outlier_variance_ratio": 1.0}


def heavy_tails(tukey_lambda, beta2=1e-6, **run):
    values = tukey(tukey_lambda, beta2)
    sensor = sensor_of([("heavy_tailed_noise", values)])
    return flat_signal(sensor, 0.0, **run).ravel()


LAMBDAS = (-0.4, -0.3, -0.1, -0.01, -1e-4, -1e-6, 1e-9, 1e-6, 0.01, 0.14, 0.3, 0.5)


@pytest.mark.parametrize("tukey_lambda", LAMBDAS)
def test_tukey_lambda_quantiles_and_variance_are_scipys(tukey_lambda):
    """One key, one uniform per site, whatever lambda: logistic draws tell it."""
    logistic = heavy_tails(0.0, height=64) / 1e-3 * np.pi / np.sqrt(3.0)
    tail = 1.0 / (1.0 + np.exp(np.abs(logistic)))  # the smaller of u and 1 - u
    scale = 1e-3 / np.sqrt(stats.tukeylambda.var(tukey_lambda))
    expected = -np.sign(logistic) * scale * stats.tukeylambda.ppf(tail, tukey_lambda)
    seen = heavy_tails(tukey_lambda, height=64)
    # float32, and SciPy's own cancellation near lambda = 0.
    assert (abs(seen - expected) <= np.maximum(1e-5 * abs(expected), 1e-8)).all()


def test_uniforms_of_the_sites_are_uniform():
    logistic = heavy_tails(0.0, seed=11) / 1e-3 * np.pi / np.sqrt(3.0)
    assert stats.kstest(stats.logistic.cdf(logistic), "uniform").pvalue > 1e-3


@pytest.mark.parametrize(
    # Errors of the estimate, from 1e6 samples in subsets of 1e5: 4 standard errors.
    ("tukey_lambda", "tolerance"),
    [(-0.1, 0.01), slow(0.14, 0.01)],
)
def test_a_planted_tukey_lambda_is_recovered(tukey_lambda, tolerance):
    dark = heavy_tails(tukey_lambda, seed=5)[:1000000].reshape(10, -1)
    brack = (tukey_lambda - 0.05, tukey_lambda + 0.05)
    seen = np.mean([stats.ppcc_max(part, brack) for part in dark])
    assert seen == pytest.approx(tukey_lambda, abs=tolerance)


def test_row_means_of_darks():
    """Variance of a row's mean: that of its offset, and of its pixels over width."""
    rows, width, sigma, beta2 = 20000, 64, 3e-4, 1e-6
    sensor = sensor_of(
        [("heavy_tailed_noise", tukey(-0.1, beta2)), ("row_noise", {"sigma": sigma})]
    )
    dark = flat_signal(sensor, 0.0, rows, width)
    means = dark.mean(axis=1)
    error = np.sqrt(2.0 / rows)
    assert means.var() == pytest.approx(sigma**2 + beta2 / width, rel=4.0 * error)
    within = (dark - means[:, None]).var() * width / (width - 1)
    assert within == pytest.approx(beta2, rel=0.01)
    lag = np.mean(means[1:] * means[:-1]) / means.var()
    assert abs(lag) < 4.0 / np.sqrt(rows), "rows are independent"


def test_rounding_to_dn_is_the_quantisation_noise_of_the_model():
    """Uniform over 1 DN: variance 1/12 DN^2 over a ramp of signals."""
    sensor = sensor_of()
    ramp = np.linspace(0.1, 0.9, N, dtype=np.float32).reshape(SIDE, SIDE)
    rgb = np.repeat(ramp[..., None], 3, axis=2)
    raw = sensor.simulate(rgb, illuminant="A", camera_input=True)
    exact = 512.0 + ramp.astype(float) * (16383 - 512)
    left = np.asarray(raw, float) - exact
    assert left.var() == pytest.approx(1.0 / 12.0, rel=0.01)
    assert np.abs(left).max() == pytest.approx(0.5, abs=0.01)


def test_a_coarse_adc_rounds_after_all_noise():
    step = 16.0 / 15871.0
    effects = [("row_noise", {"sigma": 1e-2}), ("quantisation", {"step": step})]
    codes = flat_signal(sensor_of(effects), 0.3, 256, 64) / step
    assert np.abs(codes - np.rint(codes)).max() < 1e-3
    assert len(np.unique(np.rint(codes))) > 20


BETA1 = [2.0e-3, 1.0e-3, 1.5e-3, 3.0e-3]
BETA2 = [4.0e-6, 1.0e-5, 6.0e-6, 2.0e-5]
SHAPE = {"tukey_lambda": -0.05, "row_sigma": 1e-3}
NOISE = [{"iso": 100, "beta1": BETA1, "beta2": BETA2, **SHAPE}]
PHYSICAL = {"iso": 100, "noise": "physical"}


def test_photon_transfer_of_the_physical_model():
    """Variance against mean is a line per site: slope beta1, at 0 all of beta2."""
    sensor = sensor_of(noise=NOISE)
    levels = np.array([0.01, 0.05, 0.1, 0.2, 0.4])
    seen = np.empty((len(levels), 4))
    for i, level in enumerate(levels):
        x = flat_signal(sensor, level, 4096, 256, seed=i, **PHYSICAL)
        sites = [x[r::2, c::2] for r in (0, 1) for c in (0, 1)]
        seen[i] = [site.var() for site in sites]
    for site in range(4):
        variance = BETA1[site] * levels + BETA2[site]
        slope, offset = np.polyfit(levels, seen[:, site], 1, w=1.0 / variance)
        assert slope == pytest.approx(BETA1[site], rel=0.01)
        assert offset == pytest.approx(BETA2[site], rel=0.2)


def test_both_models_predict_the_same_mean_and_variance():
    sensor = sensor_of(noise=NOISE)
    rgb = np.random.default_rng(1).uniform(0, 1.2, (40, 60, 3)).astype(np.float32)
    gaussian, physical = (
        sensor.predict(rgb, illuminant="D50", iso=100, noise=noise)
        for noise in ("gaussian", "physical")
    )
    assert (gaussian[0] == physical[0]).all()
    assert gaussian[1] == pytest.approx(physical[1], rel=1e-5, abs=1e-12)


def test_darks_of_the_physical_model_have_all_of_beta2():
    dark = flat_signal(sensor_of(noise=NOISE), 0.0, 8192, 128, seed=2, **PHYSICAL)
    for site in range(4):
        seen = dark[site // 2 :: 2, site % 2 :: 2]
        assert seen.var() == pytest.approx(BETA2[site], rel=0.02)
        rows = seen.mean(axis=1).var()
        of_pixels = (BETA2[site] - 1e-6) / 64
        assert rows == pytest.approx(1e-6 + of_pixels, rel=4 * np.sqrt(2 / 4096))


# White is no multiple of the step.
@pytest.mark.parametrize("effects", [(), [("quantisation", {"step": 0.07})]])
@pytest.mark.parametrize("level", [1.0, 50.0])
def test_saturated_pixels_are_white_in_the_physical_model(level, effects):
    sensor = sensor_of(effects, noise=NOISE)
    rgb = np.full((64, 64, 3), level, np.float32)
    raw = sensor.simulate(rgb, illuminant="A", **PHYSICAL)
    assert (raw == sensor.white_level).all()


def test_the_physical_model_says_what_it_lacks():
    rgb = np.zeros((2, 2, 3), np.float32)
    with pytest.raises(ValueError, match="test-sensor.*tukey_lambda and row_sigma"):
        sensor_of().simulate(rgb, illuminant="A", **PHYSICAL)
    with pytest.raises(ValueError, match="physical needs an iso"):
        sensor_of(noise=NOISE).simulate(rgb, illuminant="A", noise="physical")
    twice = sensor_of([("row_noise", {"sigma": 1e-3})], noise=NOISE)
    with pytest.raises(ValueError, match="row_noise.*twice"):
        twice.simulate(rgb, illuminant="A", **PHYSICAL)


def test_effects_can_be_left_out_of_the_physical_model():
    rgb = np.full((8, 8, 3), 0.5, np.float32)
    run = {"illuminant": "A", "camera_input": True, "effects": False}
    assert (sensor_of().signal(rgb, **run, **PHYSICAL) == np.float32(0.5)).all()
