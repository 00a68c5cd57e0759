# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a plan is built with: the scene's random numbers, materials and lights."""

from dataclasses import dataclass

import numpy as np

from studies.mitsuba_judge.spectra import PAVING, SIGNS, Spectra

MAIN = 0  # the light of most lamps


@dataclass(frozen=True)
class Kit:
    """Draws of one scene, in the order in which its plan asks for them."""

    rng: np.random.Generator
    spectra: Spectra
    lit: float  # share of lit windows
    mixed: float  # share of lamps that are not of the main light

    def paint(self) -> int:
        """Return a material, any but those that every scene has."""
        first = PAVING + 1
        return int(self.rng.integers(first, len(self.spectra.materials)))

    def lamp(self) -> int:
        """Return the light of a lamp outdoors: mostly the main one."""
        return self.any_lamp() if self.rng.random() < self.mixed else MAIN

    def any_lamp(self) -> int:
        """Return one of the lamps' lights."""
        return int(self.rng.integers(self.spectra.lamps))

    def sign(self) -> int:
        """Return the light of a sign."""
        return self.spectra.lamps + int(self.rng.integers(SIGNS))

    def level(self, middle: float, spread: float) -> float:
        """Return a radiance, its log normal: @middle is the median."""
        return float(middle * np.exp(self.rng.normal(0.0, spread)))
