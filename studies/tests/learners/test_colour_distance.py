# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The sliced Wasserstein distance: known of a shift, none of a set from itself."""

import numpy as np
import pytest

from studies.learners.colour_distance import colour_distance, directions

RNG = np.random.default_rng(5)
COLOURS = RNG.uniform(0.1, 0.8, (4, 20, 25, 3)).astype(np.float32)


def test_a_shift_is_half_its_length_away():
    """The mean of |cosine| over the sphere is a half; 48 directions are 1 % off."""
    for shift in ([0.1, 0.0, 0.0], [0.0, 0.0, 0.1], [0.05, -0.08, 0.03]):
        moved = COLOURS + np.array(shift, np.float32)
        half = np.linalg.norm(shift) / 2.0
        assert colour_distance(COLOURS, moved) == pytest.approx(half, rel=0.02)


def test_order_and_count_of_pixels_do_not_matter():
    shuffled = RNG.permutation(COLOURS.reshape(-1, 3))
    twice = np.concatenate([shuffled, shuffled])
    assert colour_distance(COLOURS, shuffled) < 1e-7
    assert colour_distance(COLOURS, twice) < 1e-3
    assert colour_distance(COLOURS, COLOURS[..., ::-1].copy()) < 0.01


def test_directions_are_evenly_spread_unit_vectors():
    found = directions().astype(np.float64)
    assert np.linalg.norm(found, axis=0) == pytest.approx(1.0, abs=1e-6)
    assert found @ found.T / found.shape[1] == pytest.approx(np.eye(3) / 3, abs=0.01)
