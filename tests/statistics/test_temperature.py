# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Temperatures: what is one set point, and what readings say of charge."""

import numpy as np
import pytest

from cg2raw.statistics.temperature import DOUBLING, set_points, warmth_of_readings


@pytest.mark.parametrize(
    ("temperatures", "points"),
    [
        ([20.0, 23.4, 20.9, 21.9, 23.0], [0, 1, 0, 0, 1]),  # each within 1 K of another
        ([None, 3.0, 1.0], [0, 1, 0]),
        ([None, None], [0, 0]),
    ],
)
def test_temperatures_of_one_set_point(temperatures, points):
    assert set_points(temperatures) == points


@pytest.mark.parametrize(
    ("readings", "warmer", "step"),
    [
        ([], [], 0),
        ([None, None], [0, 0], 0),
        ([3.0, 3.0], [0, 0], 0),
        # Two codes of a thermometer: one temperature at the edge between them.
        ([-4.82, -5.23, -4.82, None], [0, 0, 0, 0], 0.41),
        ([20.0, 20.1, 20.3, 20.3, 20.5], [-0.3, -0.2, 0, 0, 0.2], 0.1),
        ([20.0, None, 21.0, 22.0], [-1, 0, 0, 1], 1),
    ],
)
def test_warmth_of_readings(readings, warmer, step):
    """Charge doubles every DOUBLING K; what is rounded is uniform within a step."""
    found = warmth_of_readings(readings)
    assert found.factors == pytest.approx([2 ** (t / DOUBLING) for t in warmer])
    error = np.log(2) / DOUBLING * step / np.sqrt(12)
    assert found.error == pytest.approx(error, rel=1e-6)
