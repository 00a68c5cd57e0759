# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Auto exposure, alike for all sources."""

import numpy as np
from numpy.typing import NDArray

from studies.protocol import PROTOCOL, ExposureRules

DARKEST = 1e-9  # of a quantile; below it a frame is black


def exposure(
    image: NDArray[np.float32], rules: ExposureRules = PROTOCOL.exposure
) -> float:
    """Return the factor that brings the brightest channel of pixels to its level.

    image : (..., 3), linear."""
    top = np.quantile(image.max(axis=-1), rules.quantile)
    return float(rules.level / max(top, DARKEST))


def exposed(
    image: NDArray[np.float32], rules: ExposureRules = PROTOCOL.exposure
) -> NDArray[np.float32]:
    """Return (H, W, 3) of camera RGB as a sensor keeps it: exposed, clipped to 0..1."""
    return auto_exposed(image, rules).clip(0.0, 1.0)


def auto_exposed(
    image: NDArray[np.float32], rules: ExposureRules = PROTOCOL.exposure
) -> NDArray[np.float32]:
    """Return (H, W, 3) at its exposure, unbounded, as renderers keep images."""
    return np.asarray(image * exposure(image, rules), np.float32)
