# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import numpy as np
import pytest

from cg2raw.model.figures import figures_of
from cg2raw.model.fit import fit
from cg2raw.model.values import effect_values
from cg2raw.normal import CI95
from model.planted import planted

WHITE = 4000.0  # DN above black


def test_values_are_what_a_profile_lacks():
    """Of a profile that is a level off by 2 DN, a gain by a factor and a variance by
    another; deviations are shares of white, and errors those of the fit."""
    statistics = planted(4, shape=(64, 80)).statistics
    found = fit(statistics)
    each, profile = found.parameters.each, found.theta.copy()
    profile[each("black_level")] -= 2.0
    profile[each("gain")] *= np.exp(-0.1)
    profile[each("read_noise")] *= np.exp(0.2)
    values = {
        (one.effect, one.parameter): one
        for one in effect_values(statistics, found, profile, WHITE, whole=(1.5, 0.3))
    }
    error = {
        name: float(np.sqrt(found.covariance[each(name), each(name)].item()))
        for name in ("black_level", "gain", "read_noise")
    }
    gain, read = (found.theta[each(n)].item() for n in ("gain", "read_noise"))
    of_read = np.hypot(error["read_noise"] / read, 0.3 / 1.5)
    expected = {
        ("black_level", "offset_00"): (2 / WHITE, error["black_level"] / WHITE),
        ("shot_noise", "log_gain"): (0.1, error["gain"] / gain),
        ("read_noise", "log_variance"): (np.log(1.5) - 0.2, of_read),
    }
    for name, (value, own) in expected.items():
        one = values.pop(name)
        ends = value, value - CI95 * own, value + CI95 * own
        assert one[2:] == pytest.approx(ends), name
    figures = {one.name: one for one in figures_of(statistics, found)}
    for name, effect in (("DSNU", "dsnu"), ("PRNU", "prnu")):
        scale, one = {"1": 1, "DN": WHITE}[figures[name].unit], figures[name]
        ends = np.array([one.value, one.low, one.high]) / scale
        assert values[effect, "sigma"][2:] == pytest.approx(tuple(ends))
