# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Curves of what was measured beside what was fitted."""

import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.scenes.curves import curves_of
from diagnose.planted import capture_of, drawn, frames_of, model_of, sensor_of

SENSOR = sensor_of()


@pytest.fixture(scope="module")
def curves():
    """Return the curves, by title, of four flats that lose a third in the corners, and
    a dark, which has none."""
    model = model_of(SENSOR, lens_shading=[-0.3, 0.0, 0.0])
    captures = [capture_of("flat", n, name=f"flat {n}") for n in range(4)]
    captures.append(capture_of("dark", 9))
    frames = drawn(frames_of(SENSOR, captures), model, 5)
    values = {"r2": -0.3, "r4": 0.0, "r6": 0.0}
    shading = {name: Estimate(x, "1", (x, x)) for name, x in values.items()}
    found = curves_of(model, {"lens_shading": shading}, frames)
    return {curve.title: curve for curve in found}


def test_measured_light_follows_the_shading(curves):
    """What was measured over what is predicted without it; thousands of pixels each."""
    [curve] = [one for title, one in curves.items() if title != "Photon transfer"]
    radius, measured = curve.measured_x, curve.measured_y
    assert len(radius) > 5
    np.testing.assert_allclose(measured, 1 - 0.3 * radius**2, atol=0.01)


def test_measured_variances_are_those_of_photon_transfer(curves):
    curve = curves["Photon transfer"]
    assert np.all(np.diff(curve.x) > 0) and np.all(curve.y > 0)
    inside = (curve.low < curve.measured_y) & (curve.measured_y < curve.high)
    assert inside.mean() > 0.7
    np.testing.assert_allclose(curve.measured_y, curve.y, rtol=0.15)
