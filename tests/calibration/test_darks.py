# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What darks show besides the figures of the fit, by published and planted numbers."""

import math
from dataclasses import replace

import pytest
from scipy.stats import tukeylambda

from calibration.planted import RANGE, frames_of, sensor_of
from cg2raw.calibration import calibrate
from cg2raw.calibration.darks import doubling_of, lambda_of
from cg2raw.calibration.measured import Measured


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
    within = 4 * found.doubling.standard_error
    assert found.doubling.value == pytest.approx(6.0, abs=within)
