# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""From a neutral to chromaticity, temperature and matrix, as Adobe's renderer does it.

Source: DESIGN.md 3.2; DNG specification 1.7, chapter 6."""

import dataclasses

import numpy as np

from . import robertson

D50 = (0.3457, 0.3585)
D65 = (0.3127, 0.3290)

# Temperatures of EXIF LightSource codes. DESIGN.md 3.2.
LIGHT_SOURCE_KELVIN = {
    1: 5500.0,
    3: 2850.0,
    4: 5500.0,
    17: 2850.0,
    20: 5500.0,
    21: 6500.0,
    22: 7500.0,
    23: 5000.0,
}

MAX_PASSES = 30
CONVERGED = 1e-7

BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)


def xyz(xy):
    x, y = xy
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


def chromaticity(XYZ):
    return np.array(XYZ[:2]) / np.sum(XYZ)


def rounded_matrix(matrix):
    """A ColorMatrix as the renderer keeps it: D50 white near 1, steps of 1/10000."""
    largest = np.max(matrix @ xyz(D50))
    if not 0.99 <= largest <= 1.01:
        matrix = matrix / largest
    return np.floor(matrix * 10000.0 + 0.5) / 10000.0


@dataclasses.dataclass
class Camera:
    """Temperatures and ColorMatrices (XYZ -> camera), one or two, in any order."""

    kelvin: list
    matrices: list

    def __post_init__(self):
        order = np.argsort(self.kelvin)
        self.kelvin = [float(self.kelvin[i]) for i in order]
        self.matrices = [
            rounded_matrix(np.reshape(self.matrices[i], (3, 3))) for i in order
        ]

    def warm_weight(self, xy):
        """Share of the warmer calibration, linear in reciprocal temperature."""
        if len(self.kelvin) == 1:
            return 1.0
        warm, cool = 1.0 / self.kelvin[0], 1.0 / self.kelvin[1]
        here = 1.0 / robertson.temperature(xy, "adobe")[0]
        return float(np.clip((here - cool) / (warm - cool), 0.0, 1.0))

    def camera_from_xyz(self, xy):
        weight = self.warm_weight(xy)
        return weight * self.matrices[0] + (1.0 - weight) * self.matrices[-1]

    def xy_from_neutral(self, neutral):
        """(xy, passes, converged) of a neutral; the mean of the last two if not."""
        neutral = rounded_neutral(neutral)
        last = np.array(D50)
        for count in range(1, MAX_PASSES + 1):
            xy = chromaticity(np.linalg.solve(self.camera_from_xyz(last), neutral))
            if np.sum(np.abs(xy - last)) < CONVERGED:
                return xy, count, True
            if count == MAX_PASSES:
                return (xy + last) / 2.0, count, False
            last = xy
        raise AssertionError

    def neutral_from_xy(self, xy):
        """Camera RGB of a grey under a light, G = 1, in steps of 1e-6."""
        rgb = self.camera_from_xyz(xy) @ xyz(xy)
        return np.round(rgb / rgb[1], 6)


def rounded_neutral(neutral):
    """Divided by its maximum, in steps of 1e-6."""
    neutral = np.asarray(neutral, float)
    return np.floor(neutral / np.max(neutral) * 1e6 + 0.5) / 1e6


def bradford(to, source):
    """Linear Bradford adaptation of XYZ from one white to another."""
    scale = (BRADFORD @ xyz(to)) / (BRADFORD @ xyz(source))
    return np.linalg.solve(BRADFORD, np.diag(scale) @ BRADFORD)


def xyz_from_rgb(primaries, white):
    """XYZ from linear RGB, from the chromaticities of primaries and white."""
    columns = np.stack([xyz(xy) for xy in primaries], axis=1)
    return columns * np.linalg.solve(columns, xyz(white))


def xyz_d65_from_srgb():
    return xyz_from_rgb([(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)], D65)


def xyz_d50_from_srgb():
    return bradford(D50, D65) @ xyz_d65_from_srgb()
