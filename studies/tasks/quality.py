# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""PSNR and SSIM of restored planes beside clean ones."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]
Weights = NDArray[np.float64]
# SSIM. Source: Z. Wang et al., IEEE Transactions on Image Processing 13(4), 2004.
WINDOW, SIGMA = 11, 1.5
K1, K2 = 0.01, 0.03


def psnr(restored: Array, clean: Array) -> list[float]:
    """Return PSNR in dB of each frame (n, 4, h, w), whose peak is 1."""
    squares = ((restored - clean) ** 2).mean(axis=(1, 2, 3), dtype=np.float64)
    return [float(value) for value in -10.0 * np.log10(squares + 1e-12)]


def ssim(restored: Array, clean: Array, peak: float) -> list[float]:
    """Return SSIM of each frame (n, 4, h, w), the mean over its planes.

    peak : what the constants of SSIM are shares of: the range of the clean planes, so
        that a dark frame is judged as it is seen once it is made bright. Windows that
        reach over the border are left out."""
    c1, c2 = (K1 * peak) ** 2, (K2 * peak) ** 2
    down, along = (averaging(size) for size in clean.shape[2:])

    def local(planes: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(down.T @ planes @ along)

    x, y = restored.astype(np.float64), clean.astype(np.float64)
    mean_x, mean_y = local(x), local(y)
    spread = local(x * x) - mean_x**2 + local(y * y) - mean_y**2
    common = local(x * y) - mean_x * mean_y
    likeness = (2.0 * mean_x * mean_y + c1) * (2.0 * common + c2)
    found = likeness / ((mean_x**2 + mean_y**2 + c1) * (spread + c2))
    return [float(value) for value in found.mean(axis=(1, 2, 3))]


def averaging(size: int) -> Weights:
    """Return (size, size - WINDOW + 1): weights of Gaussian windows along an axis."""
    places = np.arange(WINDOW) - WINDOW // 2
    weights = np.exp(-0.5 * (places / SIGMA) ** 2)
    found = np.zeros((size, size - WINDOW + 1))
    for first in range(size - WINDOW + 1):
        found[first : first + WINDOW, first] = weights / weights.sum()
    return found
