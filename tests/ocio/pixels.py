# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Kinds of scene pixels that a chain must get right."""

import numpy as np

BLACK_AND_WHITE = {  # what is no radiance: the result is all black, or that of white
    "black": [
        [np.nan] * 3,
        [np.nan, 0.5, 0.2],
        [0.5, 0.2, np.nan],
        [-np.inf] * 3,
        [-1e30] * 3,
        [0.0] * 3,
    ],
    "white": [
        [np.inf] * 3,
        [np.inf, 0.5, 0.2],
        [0.1, np.inf, 0.2],
        [1e30] * 3,
        [65504.0] * 3,
        [2.0] * 3,
    ],
}


def kinds_of_pixels(count, seed=1):
    """Return {kind: (N, 3) float32}; count of each but of the edges."""
    rng = np.random.default_rng(seed)
    shape = (count, 3)
    exposure = 10.0 ** rng.uniform(-4.0, 1.0, (count, 1))
    kinds = {
        "unit": rng.random(shape),
        "near highlights": rng.uniform(0.85, 1.05, shape),
        "HDR": exposure * rng.random(shape),
        "negative": rng.uniform(-1.0, 1.0, shape),
        "edges": edges(),
    }
    return {kind: rgb.astype(np.float32) for kind, rgb in kinds.items()}


def edges():
    """Return all triples of the levels where the arithmetic changes, and of their
    neighbours."""
    zero, start, white, two = np.float32([0.0, 0.9, 1.0, 2.0])
    below, above = np.nextafter(start, zero), np.nextafter(start, two)
    levels = [zero, below, start, above, np.nextafter(white, zero), white]
    levels.append(np.nextafter(white, two))
    return np.stack(np.meshgrid(*[levels] * 3), axis=-1).reshape(-1, 3)
