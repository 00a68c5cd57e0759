# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Angles and their summary, by values that can be told without a machine."""

import numpy as np
import pytest

from studies.tasks.angles import degrees, summary


@pytest.mark.parametrize(
    ("one", "other", "angle"),
    [
        ([1, 0, 0], [0, 1, 0], 90.0),
        ([1, 1, 0], [1, 0, 0], 45.0),
        ([2, 4, 6], [1, 2, 3], 0.0),
        ([1, 1e-9, 0], [1, 0, 0], np.degrees(1e-9)),
    ],
)
def test_degrees(one, other, angle):
    assert degrees(one, other) == pytest.approx(angle, rel=1e-9)


def test_summary_of_known_errors():
    found = summary(np.array([8.0, 1, 2, 3, 4, 5, 6, 7]))
    assert (found.mean, found.median, found.best, found.worst) == (4.5, 4.5, 1.5, 7.5)
