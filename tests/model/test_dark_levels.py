# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What settles along lines and adds to the mean, and medians of an unknown law."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.model.dark_levels import first_columns, mean_of_decay, unknown_median
from model.test_levels import SHAPE, darks, fitted


@pytest.mark.parametrize(
    ("height", "length", "ramp"),
    [(0, 10, 0), (0, 10, 8), (3, 5, 2), (3, 20, -6), (-3, 40, 4), (-2, 40, 0)],
)
def test_a_decay_beside_a_ramp(height, length, ramp):
    """8 z of 1 have a root mean square below 1.7 in 99.8 of 100 cases. Of unknown
    length the mean is known less well than by its noise, 0.1 / 12."""
    along, z = np.arange(144), []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        decay = height * np.exp(-along / length)
        lines = decay + ramp * along / 144 + 0.1 * rng.standard_normal(144)
        mean, error = mean_of_decay(lines - lines.mean())
        z.append((mean - decay.mean()) / error)
        assert error < 0.15
    assert np.sqrt(np.mean(np.square(z))) < 1.7


def test_first_columns_raise_the_shortest_darks():
    """Of the mean of four biases, and not of other darks."""
    rng = np.random.default_rng(6)
    decay = 30 * np.exp(-np.arange(SHAPE[1]) / 8)
    groups = darks(rng, np.ones((2, 4)), (0.0, 60.0), frames=4)
    groups = [
        (info, [np.rint(frame + decay).astype(np.uint16) for frame in frames])
        for info, frames in groups
    ]
    mean, error = first_columns(fitted(groups))
    assert abs(mean - decay.mean()) < 3.5 * error < 0.5


@pytest.mark.parametrize(("median", "log_sigma"), [(0.3, 0.4), (1.0, 1.0), (0.2, 0.0)])
def test_a_median_is_between_the_mean_and_that_of_a_law_from_zero(median, log_sigma):
    mean = median * np.exp(log_sigma**2 / 2)
    variance = mean**2 * np.expm1(log_sigma**2)
    parameters = SimpleNamespace(
        of=("dark_current", "dark_current_nonuniformity").index
    )
    found = SimpleNamespace(theta=np.array([mean, variance]), parameters=parameters)
    value, error = unknown_median(found)
    assert value - error == pytest.approx(median - mean, abs=1e-12)
    assert value + error == pytest.approx(0, abs=1e-12)
