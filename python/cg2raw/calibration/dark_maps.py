# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark maps: what each pixel has without light, as a line over exposure time."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.repeats import Repeats
from cg2raw.calibration.robust import middle_of

Map = NDArray[np.float32]
LEAST_LEVER = 1e-4  # of the squared spread of times, where rounding of sums is felt


@dataclass(frozen=True)
class DarkMaps:
    """Offset (DN at 0 s) and dark current (DN/s) of each pixel, (H, W) float32.

    rate is None if all darks have one exposure: then the offset holds its charge.
    covariance : (2, 2) of an unmasked pixel's offset and rate, by temporal noise.
    known : (H, W) bool, False in defects, and where a pixel is saturated in all but
    one exposure.
    exposure_time : s, mean of the darks in the offset; 0 if there is a rate."""

    offset: Map
    rate: Map | None
    covariance: NDArray[np.floating[Any]]
    known: NDArray[np.bool_]
    exposure_time: float


class DarkSums:
    """Sums over groups of darks, one at a time, for a straight line per pixel.

    The first group, of the shortest exposure, is the origin of all others."""

    def __init__(self, first: Repeats, variance: float, step: int) -> None:
        self.step = step  # of the codes, DN
        """variance : DN^2, of one frame's pixel in the first group."""
        self.origin = first.mean
        self.first_time = first.group.exposure_time or 0.0
        self.plain = np.zeros((2, 2))  # of an unmasked pixel: weights, with time
        shape = (3, *first.mean.shape)
        self.weights = np.zeros(shape, np.float32)
        self.moments = np.zeros((2, *first.mean.shape), np.float32)
        self.exposures: set[float] = set()
        self.add(first, variance)

    def add(self, repeats: Repeats, variance: float) -> float:
        """Take up a group; return how far its middle lies above the first's, DN."""
        time = repeats.group.exposure_time or 0.0
        excess = repeats.mean - self.origin
        used = repeats.known
        middle = (
            0.0 if repeats.mean is self.origin else middle_of(excess[used], self.step)
        )
        weight = repeats.count / variance
        each = np.where(used, np.float32(weight), np.float32(0))
        for index in range(3):
            self.weights[index] += each * np.float32(time**index)
        excess *= each
        for index in range(2):
            self.moments[index] += excess * np.float32(time**index)
        powers = np.array([1.0, time])
        self.plain += weight * np.outer(powers, powers)
        self.exposures.add(time)
        return middle

    def middle(self, repeats: Repeats) -> float:
        """Return how far a group's middle lies above the first's, DN."""
        return middle_of((repeats.mean - self.origin)[repeats.known], self.step)

    def maps(self) -> DarkMaps:
        """Return offset and rate of each pixel."""
        if len(self.exposures) < 2:
            known = self.weights[0] > 0
            covariance = np.array([[1 / self.plain[0, 0], 0], [0, 0]])
            return DarkMaps(self.origin, None, covariance, known, self.first_time)
        one, by_time, by_square = self.weights
        spread = one * by_square - by_time**2
        known = spread > LEAST_LEVER * np.maximum(one * by_square, 1e-12)
        spread = np.where(known, spread, 1)
        rate = np.where(known, one * self.moments[1] - by_time * self.moments[0], 0)
        rate /= spread
        offset = np.where(
            known, by_square * self.moments[0] - by_time * self.moments[1], 0
        )
        offset /= spread
        offset += self.origin
        return DarkMaps(offset, rate, np.linalg.inv(self.plain), known, 0.0)
