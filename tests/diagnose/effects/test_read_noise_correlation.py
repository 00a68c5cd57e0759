# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Read noise correlation: its whitening, and that it is found and told from others."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.effects.base import registered
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import capture_of, frames_of, sensor_of, shot_by_registry
from tiers import slow

SENSOR = sensor_of()
NAME = "read_noise_correlation"
EFFECT = every()[NAME]


def whitened(frame, coefficient):
    """Return residuals of noise that correlates so, before and after whitening."""
    p = predict(Model(SENSOR), frame)
    rng = np.random.default_rng(4)
    noise = rng.standard_normal(p.mean.shape)
    for col in range(1, noise.shape[2]):
        noise[..., col] *= np.sqrt(1 - coefficient**2)
        noise[..., col] += coefficient * noise[..., col - 1]
    read = np.sqrt(frame.beta2 / p.variance)
    z = read * noise + np.sqrt(1 - read**2) * rng.standard_normal(p.mean.shape)
    values = np.array([coefficient])
    inner = np.s_[:, 8:-8, 8:-8]  # frames leave out less along their edges
    white = EFFECT.whiten(z, p, values, frame, frame.beta2)[0]
    return z[inner], white[inner]


def of_neighbours(z, lag):
    return float(np.mean(z[..., lag:] * z[..., :-lag]))


@pytest.mark.parametrize(("kind", "left"), [("dark", 0.0), ("flat", 0.25)])
@pytest.mark.parametrize("coefficient", [-0.4, -0.07, 0.3])
def test_it_whitens_what_correlates(kind, left, coefficient):
    """To three standard errors of a mean of 52,000 products; where half of the noise is
    shot noise, but for a quarter of the coefficient's square."""
    (frame,) = frames_of(SENSOR, [capture_of(kind, shape=(200, 300), level=0.002)])
    z, white = whitened(frame, coefficient)
    error = 3 / np.sqrt(z.size)
    assert abs(of_neighbours(z, 1)) > 2 * error
    assert white.var() == pytest.approx(1.0, abs=5 * error)
    for lag in (1, 2, 3):
        assert abs(of_neighbours(white, lag)) < error + left * coefficient**2


def test_pixels_that_do_not_count_tell_nothing():
    (frame,) = frames_of(SENSOR, [capture_of("dark", shape=(64, 96))])
    p = predict(Model(SENSOR), frame)
    z = np.random.default_rng(5).standard_normal(p.mean.shape)
    white, cost = EFFECT.whiten(z, p, np.array([0.3]), frame, frame.beta2)
    outside = ~frame.keep
    assert outside.any() and (white[outside] == z[outside]).all()
    assert not np.any(cost[outside])


@pytest.mark.parametrize(("coefficient", "seed"), [(-0.07, 1), slow(0.25, 2)])
def test_it_is_found_in_what_the_registry_simulates(coefficient, seed):
    hidden = {NAME: {"coefficient": coefficient}}
    captures = shot_by_registry(SENSOR, hidden, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    (one,) = found.effects
    assert one.name == NAME
    low, high = one.parameters["coefficient"].ci95
    assert low < coefficient < high and high - low < 0.04
    (entry,) = Sensor.from_json(found.profile_json, "found").effects
    assert low < entry["parameters"]["coefficient"] < high


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values"),
    [("noise_reduction", {"blend": 0.05}), ("blur", {"ring_1": 0.05})],
)
def test_what_softens_is_not_taken_for_it(name, values):
    null = dict.fromkeys([p["name"] for p in registered()[name]["parameters"]], 0.0)
    captures = shot_by_registry(SENSOR, {name: {**null, **values}})
    found = diagnose(captures, threads=1, details=False)
    assert [one.name for one in found.effects] == [name]


@pytest.mark.slow
def test_a_profile_that_lists_it_has_no_gap():
    values = {"coefficient": 0.2}
    captures = shot_by_registry(SENSOR, {NAME: values}, 3)
    known = sensor_of(effects=[{"name": NAME, "parameters": values}])
    found = diagnose(replace(captures, sensor=known), threads=1, details=False)
    assert found.verdict == "consistent"
