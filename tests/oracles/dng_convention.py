# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The `dng` convention: the exact inverse of a DNG renderer.

Source: DESIGN.md 3.3, 3.4."""

import numpy as np

from . import adobe, highlights


def balanced_from_srgb(camera, xy, forward=None):
    """White to (1, 1, 1); forward: XYZ D50 from balanced camera RGB, or None."""
    if forward is not None:
        rows = adobe.xyz(adobe.D50) / np.sum(forward, axis=1)
        return np.linalg.inv(rows[:, None] * forward) @ adobe.xyz_d50_from_srgb()
    adapted = adobe.bradford(xy, adobe.D50) @ adobe.xyz_d50_from_srgb()
    matrix = camera.camera_from_xyz(xy) @ adapted
    return matrix / (matrix @ np.ones(3))[:, None]


def camera_rgb(
    rgb, camera, neutral, digital_gain=1.0, keep_highlights=True, forward=None
):
    """Camera RGB (..., 3) of linear sRGB (..., 3) under a neutral."""
    xy = camera.xy_from_neutral(neutral)[0]
    balanced = np.asarray(rgb, float) @ balanced_from_srgb(camera, xy, forward).T
    gains = digital_gain * np.asarray(neutral, float) / np.max(neutral)
    if keep_highlights:
        return highlights.unbalanced(balanced, gains)
    return np.clip(balanced, 0.0, 1.0) * gains
