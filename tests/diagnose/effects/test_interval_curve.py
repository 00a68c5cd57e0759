# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.catalogue import effect

LIGHT = np.arange(0.0005, 1.2, 0.001)


def by_level(labels, count):
    """Return (level, a mean of light) of pixels from black to beyond white."""
    found = labels(None, SimpleNamespace(mean=LIGHT))
    levels = np.unique(found)
    return levels, np.array([LIGHT[found == level].mean() for level in levels])


def without_pixels(labels, count):
    return np.zeros(0), np.zeros(0)


@pytest.mark.parametrize(
    ("name", "values", "measured", "end", "half"),
    [
        # 1 - q x - c x^2; 1 + r2 + r4 + r6; 1 + a (cos(n pi) - 1), of 5 odd n.
        ("nonlinearity", {"quadratic": 0.06, "cubic": 0.02}, by_level, 0.92, 2**0.5),
        ("lens_shading", {"r2": -0.3, "r4": 0.1}, without_pixels, 0.8, 3**0.5),
        ("blur", {"ring_1": 0.1, "ring_2": 0.3}, without_pixels, 0.8, 20**0.5),
    ],
)
def test_a_curve_ends_where_its_values_say(name, values, measured, end, half):
    """At white, in the corner, at the Nyquist frequency; errors of all parameters are
    0.01, and add in squares."""
    one = effect(name)
    x = np.array([values.get(parameter, 0.0) for parameter in one.parameters])
    known = zip(one.parameters, x, strict=True)
    estimates = {n: Estimate(v, "1", (v - 0.01, v + 0.01)) for n, v in known}
    curve = one.curve(x, estimates, measured)
    assert (curve.x[-1], curve.y[-1]) == pytest.approx((1, end))
    assert curve.high[-1] - end == pytest.approx(0.01 * half)
    assert curve.y - curve.low == pytest.approx(curve.high - curve.y)
    inside = curve.measured_x < 0.97  # what is beyond white is of the last level
    assert np.all(curve.measured_x < 1)
    assert curve.measured_x[inside] == pytest.approx(curve.measured_y[inside])
