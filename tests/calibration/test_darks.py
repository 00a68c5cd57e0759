# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What darks show besides the figures of the fit, by published and planted numbers."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm, tukeylambda

from calibration.planted import RANGE, frames_of, sensor_of
from cg2raw.calibration import calibrate
from cg2raw.calibration.darks import HISTOGRAM, doubling_of, lambda_of, tails_of
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import sites_of
from model.shapes.planted import NOISE, SHAPE, darks, normal, statistics_of


@pytest.mark.parametrize("shape", [-0.15, -0.05, 0.02, 0.14, 0.4])
def test_the_shape_of_tails_is_that_of_their_kurtosis(shape):
    """By SciPy's moments of Tukey's law, and the lambda of a logistic law's 1.2."""
    kurtosis = float(tukeylambda.stats(shape, moments="k"))
    assert lambda_of(kurtosis) == pytest.approx(shape, abs=1e-3)
    assert lambda_of(1.2) == pytest.approx(0.0, abs=1e-3)


def rates(*each):
    """Return rates by temperature, known to 0.1 DN/s."""
    return [(celsius, Measured(rate, 0.1, "DN/s")) for celsius, rate in each]


def test_dark_current_doubles_in_so_many_kelvin():
    """Fourfold in 12 K: the farthest of three set points, whichever comes first."""
    found = doubling_of(rates((12.0, 4.0), (None, 9.0), (0.0, 1.0), (5.0, 3.0)))
    assert found.value == pytest.approx(6.0)
    error = math.hypot(0.1 / 1, 0.1 / 4) / math.log(4)  # of the logarithm, relative
    assert found.standard_error == pytest.approx(6.0 * error)


@pytest.mark.parametrize(
    "each", [[(0.0, 2.0)], [(0.0, 2.0), (9.0, 1.0)], [(0.0, 0.2), (9.0, 4.0)], []]
)
def test_rates_that_do_not_rise_or_stand_out_say_no_doubling(each):
    assert doubling_of(rates(*each)) is None


def test_each_set_point_has_its_rate():
    """1 and 4 DN/s, of darks of 30 s at -10 and 2 C: charge doubles in 6 K."""
    frames = []
    for rate, celsius, biases in ((1.0, -10.0, 3), (4.0, 2.0, 0)):
        effect = {"dark_current": {"per_second": rate / RANGE}}
        sensor = sensor_of(effect, shape=(48, 64))
        drawn = frames_of(sensor, biases=biases, darks=4 - biases // 3, flats=0)
        frames += [
            replace(one, name=f"{one.name} {celsius}", temperature=celsius)
            for one in drawn
        ]
    found = calibrate(sensor, frames).dark
    assert [celsius for celsius, _ in found.rates] == [2.0, -10.0]
    for (_, rate), truth in zip(found.rates, (4.0, 1.0), strict=True):
        assert rate.value == pytest.approx(truth, abs=4 * rate.standard_error)
    assert found.rate.standard_error < 0.02
    levels = {(time, place): above for time, above, place in found.points}
    expected = {(0.0, 0): 0, (30.0, 0): 120, (30.0, 1): 30}  # DN above black
    assert levels == pytest.approx(expected, abs=0.3)
    within = 4 * found.doubling.standard_error
    assert found.doubling.value == pytest.approx(6.0, abs=within)


def mixed(rng, shape):
    """Return noise of which one draw in 20 has twice the deviation."""
    return normal(rng, shape) * np.where(rng.random(shape) < 0.05, 2.0, 1.0)


@pytest.mark.parametrize(
    ("noise", "kurtosis", "is_heavy"),
    # Of a twentieth with four times the variance: 3 (0.95 + 0.05 4^2) / 1.15^2 - 3.
    [(normal, 0.0, False), (mixed, 0.970, True)],
)
def test_tails_are_those_of_what_is_drawn(noise, kurtosis, is_heavy):
    """By six pairs of 96 x 120 samples; the histogram is in units of their deviation,
    and a normal law is known to 4 roots of the counts."""
    groups = darks(2, "", np.zeros(SHAPE), times=(0.0,), frames=12, noise=noise)
    sensor = sensor_of()
    seen = Seen(sensor, sites_of(sensor), (), statistics_of(groups))
    found = tails_of(seen, 0)
    count = 6 * SHAPE[0] * SHAPE[1]
    assert found.histogram.sum() == pytest.approx(count, rel=0.01)
    assert found.frames == 12 and found.are_heavy == is_heavy
    known = found.excess_kurtosis
    assert known.value == pytest.approx(kurtosis, abs=0.15)
    assert known.standard_error == pytest.approx(2 * (24 / count) ** 0.5, rel=0.05)
    assert found.tukey_lambda == lambda_of(known.value)
    if not is_heavy:
        expected = count * np.diff(norm.cdf(HISTOGRAM))
        away = found.histogram - expected
        assert (np.abs(away) < 4 * np.sqrt(expected + 1)).all()
        assert found.variance.mean() == pytest.approx(NOISE**2 + 1 / 12, rel=0.02)
