# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How far two sets of colours are apart: a sliced Wasserstein distance.

Source: N. Bonneel et al., Sliced and Radon Wasserstein Barycenters of Measures, Journal
of Mathematical Imaging and Vision 51, 2015."""

import numpy as np
from numpy.typing import NDArray

DIRECTIONS = 48
LEVELS = 256  # quantiles by which two distributions on a line are compared
GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))


def colour_distance(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """Return the sliced 1-Wasserstein distance of colours (..., 3) and (..., 3).

    The mean over DIRECTIONS of the area between the distributions of projections; it
    is in units of the colours, and draws nothing."""
    levels = (np.arange(LEVELS) + 0.5) / LEVELS
    found = [
        np.quantile(colours.reshape(-1, 3) @ directions(), levels, axis=0)
        for colours in (one, other)
    ]
    return float(np.abs(found[0] - found[1]).mean())


def directions() -> NDArray[np.float32]:
    """Return unit vectors (3, DIRECTIONS), evenly spread over a half sphere."""
    height = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    around = np.arange(DIRECTIONS) * GOLDEN_ANGLE
    radius = np.sqrt(1.0 - height**2)
    points = [radius * np.cos(around), radius * np.sin(around), height]
    return np.asarray(points, np.float32)
