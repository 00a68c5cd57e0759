# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Angles between colours, and what is told of many."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


def degrees(one: ArrayLike, other: ArrayLike) -> NDArray[np.float64]:
    """Return the angles (...) between colours (..., 3) that are not black."""
    a, b = np.asarray(one, float), np.asarray(other, float)
    # Exact for small angles, too, unlike the cosine.
    sine, cosine = np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1)
    return np.asarray(np.degrees(np.arctan2(sine, cosine)))


@dataclass(frozen=True)
class Summary:
    """Errors in degrees, as papers on illuminant estimation tell them."""

    mean: float
    median: float
    best: float  # mean of the best quarter
    worst: float  # mean of the worst quarter


def summary(errors: NDArray[np.float64]) -> Summary:
    """Return the Summary of errors (n,), at least 1; a quarter has one at least."""
    ordered, quarter = np.sort(errors), max(len(errors) // 4, 1)
    parts = ordered, ordered[:quarter], ordered[-quarter:]
    mean, best, worst = (float(part.mean()) for part in parts)
    return Summary(mean, float(np.median(ordered)), best, worst)
