# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Inverse white balance that keeps highlights white.

Source: T. Brooks et al., Unprocessing Images for Learned Raw Denoising, CVPR 2019,
section 3; DESIGN.md 3.4."""

import numpy as np

INFLECTION = 0.9


def unbalanced(balanced, gains):
    """Camera RGB (..., 3) of balanced camera RGB in 0..1 under the gains g_c."""
    balanced = np.clip(np.asarray(balanced, float), 0.0, 1.0)
    gray = np.mean(balanced, axis=-1, keepdims=True)
    mask = (np.maximum(gray - INFLECTION, 0.0) / (1.0 - INFLECTION)) ** 2
    safe = np.maximum(mask + (1.0 - mask) * gains, gains)
    return balanced * safe
