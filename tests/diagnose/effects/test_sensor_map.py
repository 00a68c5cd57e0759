# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""SensorMap: maps that are displaced have the same numbers at other pixels."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap


@pytest.mark.parametrize("shape", [(1, 64, 96), (25, 42, 56), (2, 24, 30)])
def test_displaced_maps_have_the_numbers_of_others_of_a_colour(shape):
    rows, columns = np.mgrid[: shape[1], : shape[2]]
    place = np.broadcast_to(1000.0 * rows + columns, shape)
    known = SensorMap(place, 2 * place, chance=place / place.max())
    moved = list(known.displaced())
    assert len({one.mean.tobytes() for one in moved}) == 8
    for one in moved:
        assert (one.mean != place).all()
        np.testing.assert_array_equal(np.sort(one.mean, None), np.sort(place, None))
        np.testing.assert_array_equal(one.variance, 2 * one.mean)
        np.testing.assert_allclose(one.chance, one.mean / place.max())
        repeat = 6 if shape[1] % 6 == shape[2] % 6 == 0 else 2  # X-Trans, or Bayer
        assert not ((one.mean // 1000 - rows) % repeat).any()
        assert not ((one.mean % 1000 - columns) % repeat).any()
