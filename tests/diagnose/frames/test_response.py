# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Response: maps act on charge, before it is bent."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.frames.response import Response
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import BY_NAME, capture_of, frames_of, sensor_of

QUADRATIC, CUBIC = 0.1, 0.05
BENT = {"nonlinearity": [QUADRATIC, CUBIC]}
LISTED = {"name": "nonlinearity", "parameters": {"quadratic": 0.1, "cubic": 0.05}}


def bent(x):
    return x - QUADRATIC * x**2 - CUBIC * x**3


def test_charge_and_slope_are_those_of_the_curve():
    x = np.linspace(0, 1, 21)
    response = Response.of(BENT, bent(x))
    assert response.charge == pytest.approx(x, abs=1e-5)
    slope = (bent(x + 1e-6) - bent(x - 1e-6)) / 2e-6
    assert response.slope == pytest.approx(slope, abs=1e-4)


@pytest.mark.parametrize("values", [{}, {"nonlinearity": [0.0, 0.0]}])
def test_a_straight_response_is_none(values):
    assert Response.of(values, np.ones(3)) is None


@pytest.mark.parametrize(
    ("name", "value"), [("dust", -0.02), ("prnu", 0.02), ("hot_pixels", 0.02)]
)
def test_a_map_moves_the_signal_as_its_charge_does(name, value):
    """Light that is lost, and charge that is added, beside what the registry says of a
    flat of as much light."""
    sensor = sensor_of(effects=[LISTED])
    [frame] = frames_of(sensor, [capture_of("flat", level=0.6)])
    effect = BY_NAME[name]
    known = np.full(frame.signal.shape, value)
    term = Term(effect, np.array([0.01]), SensorMap(known, 0 * known))
    before, after = (predict(m, frame) for m in (Model(sensor), Model(sensor, (term,))))
    light = before.response.charge
    charge = light * (1 + value) if effect.acts_on_light else light + value
    expected = bent(charge) - bent(light)
    moved = (after.mean - before.mean)[frame.keep]
    assert moved == pytest.approx(expected[frame.keep], rel=0.01)
