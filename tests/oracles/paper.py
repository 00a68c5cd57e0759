# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The transform of Graphics2RAW with the constants of its reference implementation.

Source: D. Seo et al., Graphics2RAW, ICCV 2023, equations 4-7; DESIGN.md 3.3."""

import numpy as np

from . import highlights, robertson

SRGB_FROM_XYZ = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)
KELVIN_A, KELVIN_D65 = 2500.0, 6500.0
START_XYZ = (0.3, 0.3, 0.3)
STEP = 1e-4


def row_normalised(matrix):
    return matrix / np.sum(matrix, axis=1, keepdims=True)


def weight_of_d65(kelvin):
    return (1.0 / kelvin - 1.0 / KELVIN_A) / (1.0 / KELVIN_D65 - 1.0 / KELVIN_A)


def mixed(cm_a, cm_d65, weight_a, weight_d65):
    return weight_a * row_normalised(cm_a) + weight_d65 * row_normalised(cm_d65)


def temperature(neutral, cm_a, cm_d65):
    """(CCT, Duv) of a neutral (G = 1): those by which the last matrix was made."""
    XYZ = np.array(START_XYZ)
    for _ in range(10000):
        kelvin, duv = robertson.temperature(XYZ[:2] / np.sum(XYZ), "corrected")
        w = weight_of_d65(kelvin)
        last, XYZ = XYZ, np.linalg.solve(mixed(cm_a, cm_d65, 1.0 - w, w), neutral)
        if np.linalg.norm(XYZ - last) <= STEP:
            return kelvin, duv
    raise ValueError(f"no convergence for {neutral}")


def camera(rgb, neutral, cm_a, cm_d65, digital_gain=1.0, keep_highlights=True):
    """Camera RGB (..., 3) of linear sRGB (..., 3) under a neutral (G = 1)."""
    w = weight_of_d65(temperature(neutral, cm_a, cm_d65)[0])
    matrix = row_normalised(
        mixed(cm_a, cm_d65, np.clip(1.0 - w, 0.0, 1.0), np.maximum(w, 0.0))
    )
    xyz_from_srgb = np.linalg.inv(row_normalised(SRGB_FROM_XYZ))
    XYZ = np.clip(np.asarray(rgb, float) @ xyz_from_srgb.T, 0.0, 1.0)
    balanced = np.clip(XYZ @ matrix.T, 0.0, 1.0)
    gains = digital_gain * np.asarray(neutral, float)
    if keep_highlights:
        return np.clip(highlights.unbalanced(balanced, gains), 0.0, 1.0)
    return np.clip(balanced * gains, 0.0, 1.0)
