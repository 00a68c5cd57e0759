# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the surfaces of one scene are made of."""

import numpy as np

from cg2raw.profile.spectral_file import WAVELENGTHS
from studies.protocol import MaterialRules
from studies.world.colorimetry import Array

LEAST, MOST = 0.01, 0.95  # of a reflectance
DIRT = 0.1  # how far the grey that an object fades to is from its own mean, at most


def palette(
    rng: np.random.Generator, measured: Array, count: int, rules: MaterialRules
) -> Array:
    """Return reflectances (count, 81) of measured objects (n, 81), faded, some grey.

    Objects of a collection are more colourful than what lies about: each fades towards
    its own mean."""
    chosen = measured[rng.choice(len(measured), count)]
    share = rng.uniform(*rules.vivid) * rng.beta(*rules.fade, (count, 1))
    dirt = rng.uniform(1.0 - DIRT, 1.0 + DIRT, (count, 1))
    faded = share * chosen + (1.0 - share) * dirt * chosen.mean(axis=1, keepdims=True)
    grey = rng.random(count) < rules.greys
    level = rng.uniform(*rules.grey_level, (count, 1))
    low, high = rng.uniform(*rules.tilt, (2, count, 1))
    slope = low + (high - low) * np.linspace(0.0, 1.0, len(WAVELENGTHS))
    chosen = np.where(grey[:, None], level * slope, faded)
    return np.asarray(chosen.clip(LEAST, MOST))
