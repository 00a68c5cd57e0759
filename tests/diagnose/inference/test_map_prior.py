# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a profile states of a map holds until pixels contradict it."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.log_normal_law import Rates
from cg2raw.diagnose.inference.log_normal_map import fit_log_normal_map
from cg2raw.diagnose.inference.map_prior import (
    Stated,
    lost_by_variance,
    mixed_prior_of,
)
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    READ,
    SHAPE,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()


@pytest.mark.parametrize(
    ("stated", "found", "good"),
    [(0.04, 0.04, True), (0.04, 0.0, True), (0.0, 0.04, True), (0.0, 0.2, False)],
)
def test_a_variance_that_changes_estimates_little_holds(stated, found, good):
    lost = lost_by_variance(stated, found, np.ones(9))
    assert Stated({}).holds(lost, 9) == good and Stated({}, held=True).holds(lost, 9)


def test_what_pixels_lose_by_a_variance_is_its_divergence_from_theirs():
    """Of normal numbers, by the mean of what they lose."""
    x = 1.3 * np.random.default_rng(3).standard_normal(400_000)
    lost = 0.5 * (x**2 - x**2 / 1.69 - np.log(1.69)).mean()
    assert lost_by_variance(0, 0.69, np.ones(4)) == pytest.approx(4 * lost, rel=0.02)


@pytest.mark.parametrize(("truth", "holds"), [(0.2, True), (1.0, False)])
def test_the_profile_s_deviation_holds_unless_pixels_contradict_it(truth, holds):
    stated = 0.2 * READ
    profile = [{"name": "dsnu", "parameters": {"sigma": stated}}]
    sensor = sensor_of(effects=profile)
    offsets = truth * READ * np.random.default_rng(2).standard_normal((1, *SHAPE))
    captures = [capture_of("dark", n, name=f"d{n}") for n in range(2)]
    frames = drawn(frames_of(sensor, captures), Model(sensor_of()), 4, offsets)
    model = model_of(sensor, dsnu=[0.0])
    model = model.with_term(replace(model.term("dsnu"), calibration=True))
    found = fit_patterns(model, on(frames)).term("dsnu").values[0]
    assert (found == stated) == holds
    if not holds:
        assert found == pytest.approx(truth * READ, rel=0.05)


def test_pixels_far_out_are_so_beside_a_deviation_that_holds():
    """What a hot pixel leaves while a frame is read is in all frames."""
    profile = [{"name": "dsnu", "parameters": {"sigma": 0.2 * READ}}]
    sensor = sensor_of(effects=profile)
    rng = np.random.default_rng(2)
    far = np.where(rng.random((1, *SHAPE)) < 0.003, 20 * READ, 0)
    offsets = 0.2 * READ * rng.standard_normal(far.shape) + far
    captures = [capture_of("dark", n, name=f"d{n}") for n in range(2)]
    frames = drawn(frames_of(sensor, captures), Model(sensor_of()), 4, offsets)
    model = model_of(sensor, dsnu=[0.0])
    model = model.with_term(replace(model.term("dsnu"), calibration=True))
    found = fit_patterns(model, on(frames)).term("dsnu")
    assert found.values[0] == 0.2 * READ
    away = (found.sensor_map.mean - offsets)[(far > 0) & frames[0].keep]
    assert np.abs(away).max() < 4 * READ


@pytest.mark.parametrize(
    ("rate", "log_sigma", "holds"), [(1.0, 1.0, True), (1.1, 1.0, False)]
)
def test_a_stated_law_of_rates_holds_unless_pixels_contradict_it(
    rate, log_sigma, holds
):
    rng = np.random.default_rng(5)
    shape = (1, 150, 200)
    values = np.expm1(log_sigma * rng.standard_normal(shape)) * rate
    estimates = values + 0.3 * rng.standard_normal(shape)
    rates = Rates(estimates, np.full(shape, 0.09), *np.zeros((2, *shape)))
    known = np.ones(shape, bool)
    stated = {"rate": 1.0, "log_sigma": 1.0}
    law = fit_log_normal_map(rates, known, None, Stated(stated)).mixture.law
    assert ((law.rate, law.log_sigma) == (1.0, 1.0)) == holds
    assert law.rate == pytest.approx(rate, rel=0.05)


def test_beside_a_stated_law_pixels_are_hot_that_it_does_not_explain():
    rng = np.random.default_rng(7)
    shape = (1, 150, 200)
    values = np.expm1(rng.standard_normal(shape))
    values += np.where(rng.random(shape) < 0.004, rng.exponential(150.0, shape), 0)
    rates = Rates(
        values + 0.3 * rng.standard_normal(shape),
        np.full(shape, 0.09),
        *np.zeros((2, *shape)),
    )
    stated = {"rate": 1.0, "log_sigma": 1.0}
    found = fit_log_normal_map(
        rates, np.ones(shape, bool), None, Stated(stated)
    ).mixture
    assert (found.law.rate, found.law.log_sigma) == (1.0, 1.0)
    assert found.hot_share == pytest.approx(0.004, rel=0.25)
    assert found.hot_rate == pytest.approx(150, rel=0.25)


def test_hot_pixels_have_a_law_where_no_others_differ():
    rng = np.random.default_rng(8)
    shape = (1, 150, 200)
    noise = 0.3 * rng.standard_normal(shape)
    hot = np.where(rng.random(shape) < 1e-3, rng.exponential(60.0, shape), 0)
    known = np.ones(shape, bool)

    def law(values):
        rates = Rates(values, np.full(shape, 0.09), *np.zeros((2, *shape)))
        found = fit_log_normal_map(rates, known)
        return None if found is None else found.mixture

    assert law(noise) is None
    found = law(noise + hot)
    assert found.hot_share == pytest.approx(1e-3, rel=0.35)
    assert found.law.sigma < 0.05


def test_a_stated_variance_is_that_of_most_pixels_of_a_map_with_tails():
    """Frames that are noisier than a map tell hardly how wide most of it is: without
    that number it may be none, and what pixels are then is told as far too sure."""
    rng = np.random.default_rng(9)
    shape, variance, error = (120, 160), 0.04, 0.09
    wide = rng.random(shape) < 0.003
    values = np.sqrt(variance) * np.where(wide, 30, 1) * rng.standard_normal(shape)
    estimate = values + np.sqrt(error) * rng.standard_normal(shape)
    errors = np.full(shape, error)
    prior = mixed_prior_of(estimate.ravel() ** 2, errors.ravel(), variance)
    assert prior.narrow == variance
    assert prior.share == pytest.approx(0.003, rel=0.35)
    mean, doubt = prior.posterior(estimate, errors)
    off = (mean - values)[~wide]
    assert np.mean(off**2) == pytest.approx(doubt[~wide].mean(), rel=0.1)
