# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a CameraTransform says, in float64: scene to camera RGB and back.

Source: DESIGN.md 3.3, 3.4; transform.h. A transform is any object with the fields of
`cg2raw._core.CameraTransform`."""

import numpy as np

from . import highlights

LARGEST = 1e6


def legal(rgb):
    """Finite pixels as OCIO spaces make them: a NaN blackens its pixel, an infinity
    lifts or sinks the whole of it."""
    rgb = np.array(rgb, float)
    rgb[np.isnan(rgb).any(axis=-1)] = 0.0
    above, below = np.isposinf(rgb).any(axis=-1), np.isneginf(rgb).any(axis=-1)
    rgb[below] = -LARGEST
    rgb[above & ~below] = LARGEST
    return np.clip(rgb, -LARGEST, LARGEST)


def balanced(rgb, transform):
    """Camera RGB (..., 3) of linear sRGB (..., 3), white at (1, 1, 1)."""
    rgb = np.clip(legal(rgb) @ np.asarray(transform.first).T, 0.0, 1.0)
    if transform.two_steps:
        rgb = np.clip(rgb @ np.asarray(transform.second).T, 0.0, 1.0)
    return rgb


def camera_from_scene(rgb, transform):
    """Camera RGB (..., 3) of linear sRGB (..., 3)."""
    rgb, gains = balanced(rgb, transform), np.asarray(transform.gains)
    if transform.keep_highlights:
        rgb = highlights.unbalanced(rgb, gains)
    else:
        rgb = rgb * gains
    return np.clip(rgb, 0.0, 1.0) if transform.clip_result else rgb


def scene_from_camera(rgb, transform):
    """Linear sRGB of camera RGB: balance, clip at white, inverse matrices."""
    rgb = np.clip(np.asarray(rgb, float) / transform.gains, 0.0, 1.0)
    if transform.two_steps:
        rgb = np.clip(rgb @ np.linalg.inv(transform.second).T, 0.0, 1.0)
    return rgb @ np.linalg.inv(transform.first).T
