# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Noise reduction: the camera blended a pixel with its neighbours."""

import numpy as np

from cg2raw.diagnose.effects.base import (
    Effect,
    Parameter,
    Values,
)
from cg2raw.model.lags import variance_left

LEAST_BLEND = np.array([0.0, -0.1])


class NoiseReduction(Effect):
    """It blurs the mean, too, and goes where noise goes all the same."""

    name = "noise_reduction"
    title = "in-camera noise reduction"
    where = "neighbours of one colour share their noise"
    of_mean = False
    # On top of what a profile has, which may be too much.
    fitted = (Parameter("blend", -0.9, 0.9), Parameter("diagonal", -0.4, 0.4))
    step = 5e-3
    signature = frozenset({"softener"})
    told_apart = dict.fromkeys(
        ("read_noise", "shot_noise"),
        "Two darks of one exposure time and two flats of one light in each group: "
        "noise that neighbours share in their difference is noise reduction.",
    )
    bayer_only = True

    @property
    def predicted(self) -> bool:
        return True

    def within_registry_bounds(self, values: Values) -> Values:
        """Return values of a filter that blends: one that sharpens is none of these."""
        bounded = super().within_registry_bounds(values)
        return np.asarray(np.maximum(bounded, LEAST_BLEND))

    def variance_left(self, values: Values) -> float:
        return variance_left(*map(float, values))


EFFECT = NoiseReduction()
