# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What darks show besides the figures of the fit, by published and planted numbers."""

import math

import pytest
from scipy.stats import tukeylambda

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
