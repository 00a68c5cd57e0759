# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The 3x3 matrices that are best for the very colours they are measured by."""

import numpy as np

from oracles import spectral

STEPS = 15  # of the reweighting; the mean angle then changes by less than 1e-3 of it
SMALLEST = 1e-3  # radians: nearer colours count as if they were so far


def least_squares(rgb, truth):
    """Return rgb @ matrix (n, 3) of the least squared difference to truth (n, 3)."""
    return rgb @ np.linalg.lstsq(rgb, truth, rcond=None)[0]


def angles(truth, other):
    """Return (n,) radians between vectors (n, 3)."""
    return np.radians(spectral.degrees(truth, other))


def least_angle(rgb, truth):
    """Return rgb @ matrix (n, 3) of the least mean angle to truth (n, 3).

    By iteratively reweighted least squares of what of a colour is across its truth; an
    angle says nothing of the scale, which is that of least squares."""
    unit = truth / np.linalg.norm(truth, axis=1, keepdims=True)
    across = np.eye(3) - unit[:, :, None] * unit[:, None, :]
    found = [least_squares(rgb, truth)]
    for _ in range(STEPS):
        angle = np.maximum(angles(truth, found[-1]), SMALLEST)
        weight = 1.0 / (np.sum(found[-1] ** 2, axis=1) * angle)
        weighted = rgb[:, :, None] * rgb[:, None, :] * weight[:, None, None]
        normal = np.einsum("nij,nkl->ikjl", weighted, across, optimize=True)
        matrix = np.linalg.eigh(normal.reshape(9, 9))[1][:, 0].reshape(3, 3)
        found.append(rgb @ matrix)
        found[-1] *= np.sum(found[-1] * truth) / np.sum(found[-1] ** 2)
    return min(found, key=lambda colours: angles(truth, colours).mean())
