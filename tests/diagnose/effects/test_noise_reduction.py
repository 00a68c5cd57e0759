# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise that a camera reduced becomes white again, and its rounding stays white."""

import numpy as np
import pytest

from cg2raw.diagnose.frames.prediction import Prediction
from diagnose.planted import BY_NAME, capture_of, frames_of, sensor_of


def whitened(z, values, deviation):
    """Return (residuals, log of the determinant). deviation : DN, of all noise."""
    (frame,) = frames_of(sensor_of(), [capture_of("dark")])
    variance = np.full(z.shape, (deviation / frame.range.mean()) ** 2)
    p = Prediction(0 * variance, variance, 0 * variance, 0 * variance)
    return BY_NAME["noise_reduction"].whiten(z, p, values, frame, variance)


def filter_matrix(shape, blend, diagonal):
    """Return the dense matrix of a camera's blend of same-colour neighbours; borders
    are those of a torus, as the effect has them."""
    count = shape[0] * shape[1]
    matrix = np.zeros((count, count))
    index = np.arange(count).reshape(shape)
    sides = [(2, 0), (-2, 0), (0, 2), (0, -2)]
    corners = [(2, 2), (2, -2), (-2, 2), (-2, -2)]
    matrix[np.arange(count), np.arange(count)] = 1 - blend - diagonal
    for moves, share in ((sides, blend / 4), (corners, diagonal / 4)):
        for move in moves:
            there = np.roll(index, move, (0, 1)).ravel()
            matrix[np.arange(count), there] += share
    return matrix


@pytest.mark.parametrize("shape", [(12, 16), (11, 13)])
def test_noise_reduction_against_the_dense_matrix(shape):
    rng = np.random.default_rng(3)
    blend, diagonal = 0.3, 0.05
    matrix = filter_matrix(shape, blend, diagonal)
    matrix /= np.sqrt((matrix[0] ** 2).sum())
    source = rng.standard_normal((1, *shape))
    z = (matrix @ source.ravel()).reshape(source.shape)
    values = np.array([blend, diagonal])
    white, cost = whitened(z, values, 30.0)
    assert white == pytest.approx(source, abs=0.01)
    _, log_determinant = np.linalg.slogdet(matrix)
    assert cost * source.size == pytest.approx(-log_determinant, abs=0.05)


@pytest.mark.parametrize("deviation", [0.4, 1.0, 30.0])
def test_noise_that_was_reduced_becomes_white(deviation):
    """Whole DN are white noise that the filter did not blend. deviation : DN."""
    rng = np.random.default_rng(4)
    values = np.array([0.4, 0.1])
    matrix = filter_matrix((16, 16), *values)
    matrix /= np.sqrt((matrix[0] ** 2).sum())
    rounding = np.sqrt(1 / 12) / deviation
    blended = (rng.standard_normal((500, 256)) @ matrix.T).reshape(500, 16, 16)
    z = np.sqrt(1 - rounding**2) * blended + rounding * rng.standard_normal(
        blended.shape
    )
    white, _ = whitened(z, values, deviation)
    assert np.square(white).mean() == pytest.approx(1, abs=0.01)
    for lag in ((0, 2), (2, 0), (2, 2)):
        shifted = np.roll(white, lag, (1, 2))
        assert abs((white * shifted).mean()) < 4 / np.sqrt(z.size)
    assert abs((z * np.roll(z, 2, 2)).mean()) > 0.05
