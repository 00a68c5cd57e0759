# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Well: charge is cut after maps have filled it."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.frames.well import Well
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import BY_NAME, capture_of, frames_of, model_of, sensor_of

LEVEL, DEVIATION = 0.7, 0.02


@pytest.mark.parametrize("above", [-20.0, -2.0, 0.0, 0.5, 3.0, 20.0])
def test_what_is_cut_is_that_of_the_smaller_of_charge_and_level(above):
    charge = LEVEL + above * DEVIATION
    drawn = np.random.default_rng(4).normal(charge, DEVIATION, 400_000)
    cut = np.minimum(drawn, LEVEL)
    well = Well(LEVEL, np.array([charge]), np.array([DEVIATION**2]))
    assert charge - well.cut[0] == pytest.approx(cut.mean(), abs=2e-4)
    left = DEVIATION**2 - well.cut[1]
    assert left == pytest.approx(cut.var(), abs=0.01 * DEVIATION**2)
    assert well.below == pytest.approx((drawn < LEVEL).mean(), abs=3e-3)


@pytest.mark.parametrize("values", [{}, {"full_well": [0.0]}])
def test_a_profile_without_one_cuts_nothing(values):
    assert Well.of(values, np.ones(3), np.ones(3)) is None


def test_dust_moves_pixels_from_above_the_level_to_below_it():
    """A flat a tenth above the full well, behind a spot that takes a fifth."""
    sensor = sensor_of()
    [frame] = frames_of(sensor, [capture_of("flat", 1, level=0.6)])
    light = predict(Model(sensor), frame).exposed
    level = float(np.median(light[:, frame.color == 1])) / 1.1
    model = model_of(sensor, full_well=[1 - level])
    loss = np.zeros_like(light)
    loss[:, 40:60, 40:60] = -0.2
    spot = SensorMap(loss, np.zeros_like(loss))
    shaded = model.with_term(Term(BY_NAME["dust"], np.array([0.1]), spot))
    p = predict(shaded, frame)
    expected = np.minimum(light * (1 + loss), level)
    assert p.mean == pytest.approx(expected, abs=5e-3)
    bare = predict(Model(sensor), frame).variance
    of_green = frame.keep & (frame.color == 1) & (loss < 0)
    assert (p.variance[of_green] > 0.7 * bare[of_green]).all()
    assert (p.below[of_green] > 0.99).all()
