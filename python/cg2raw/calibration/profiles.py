# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Profiles of a map: its columns and rows, each in two halves of the frame."""

import numpy as np

from cg2raw.calibration.robust import Array


def profiles_of(image: Array) -> tuple[Array, Array]:
    """Return (2, W) columns in the upper and the lower half of an (H, W) map, and
    (2, H) rows in its left and right half: medians, once those of the other lines are
    taken off, which dust in less than half of a line does not move."""
    columns, rows = (
        np.array([_medians(half) for half in np.split(one, [len(one) // 2])], float)
        for one in (image, image.T)
    )
    return columns, rows


def _medians(image: Array) -> Array:
    """Return (w,) medians of the columns of an (h, w) map, less those of its rows."""
    found: Array = np.median(image - np.median(image, 1, keepdims=True), 0)
    return found
