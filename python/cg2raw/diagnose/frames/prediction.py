# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Prediction: what a model says of the pixels of one frame."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from cg2raw.diagnose.frames.tiling import Array


@dataclass(frozen=True)
class Prediction:
    """Mean and variance over frames of every pixel, (T, h, w), signal units.

    exposed : the mean before noise. photon_variance : of the light, by its photons.
    light_variance : of light that nobody measured, part of the variance.
    shrinking : what integrates a nuisance out of residuals of a prediction.
    below : the chance that the charge of a pixel stays below the full well."""

    mean: Array
    variance: Array
    exposed: Array
    photon_variance: Array
    light_variance: Array | float = 0.0
    shrinking: Callable[["Prediction"], Any] | None = None
    below: Array | float = 1.0

    @cached_property
    def shrinkage(self) -> Any:
        """What integrates the nuisance out of residuals; None if there is none."""
        return None if self.shrinking is None else self.shrinking(self)
