# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Lenses and read noise as others measured them, in place of the generator's own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.random import Generator
from scipy.ndimage import map_coordinates
from scipy.stats import tukeylambda

from cg2raw.synthetic.camera import Plane


@dataclass(frozen=True)
class ReadNoise:
    """Read noise of a Tukey-lambda distribution, and Gaussian row offsets.

    shape : lambda, above -0.5; 0.14 is nearly Gaussian, less has heavier tails.
    sigma, row_sigma : standard deviations in shares of the profile's read noise.

    Source: Wei et al., CVPR 2020, section 3.2."""

    shape: float
    sigma: float
    row_sigma: float

    def draw(self, rng: Generator, shape: tuple[int, int]) -> Plane:
        """Return (H, W) of one frame, in read noises of the profile."""
        u = rng.random(shape)
        if self.shape == 0:  # the limit: a logistic distribution
            quantiles = np.log(u / (1 - u))
        else:
            quantiles = (u**self.shape - (1 - u) ** self.shape) / self.shape
        pixels: Plane = self.sigma / np.sqrt(tukeylambda.var(self.shape)) * quantiles
        return pixels + self.row_sigma * rng.standard_normal((shape[0], 1))


@dataclass(frozen=True)
class Measured:
    """What is hidden besides effects. transmission : (H, W) factor of the light at each
    pixel. read_noise : in place of the profile's; its density is not known."""

    transmission: Plane | None = None
    read_noise: ReadNoise | None = None


def gain_map_transmission(
    maps: Sequence[Mapping[str, Any]], cfa: int, shape: tuple[int, int]
) -> Plane:
    """Return (H, W) of the fall-off that the GainMaps of a whole frame undo.

    maps : of read_dng_metadata. cfa : number of its sites.

    Bilinear between the map's points, their nearest beyond.
    Source: DNG specification 1.7.1, chapter 7, GainMap."""
    n = round(cfa**0.5)
    height, width = shape
    field = np.ones(shape)
    for one in maps:
        (down, across), (top, left) = one["spacing"], one["origin"]
        v = ((np.arange(height) + 0.5) / height - top) / down
        u = ((np.arange(width) + 0.5) / width - left) / across
        grid = np.meshgrid(v, u, indexing="ij")
        gains = np.asarray(one["gains"], np.float64)
        whole = 1 / map_coordinates(gains, grid, order=1, mode="nearest")
        for site in one["sites"]:
            here = np.s_[site // n :: n, site % n :: n]
            field[here] = whole[here]
    return field


def polynomial_transmission(
    coefficients: Sequence[float], shape: tuple[int, int]
) -> Plane:
    """Return (H, W) of 1 + k1 r^2 + k2 r^4 + k3 r^6, r = 1 in the corner.

    Source: lensfun's vignetting model "pa"."""
    height, width = shape
    rows, cols = np.mgrid[:height, :width]
    square: Plane = (rows - (height - 1) / 2) ** 2 + (cols - (width - 1) / 2) ** 2
    square = square / (height**2 + width**2) * 4
    k1, k2, k3 = coefficients
    return 1 + square * (k1 + square * (k2 + square * k3))
