# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Prediction: what a model says of the pixels of one frame."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.frames.well import Well


@dataclass(frozen=True)
class Prediction:
    """Mean and variance over frames of every pixel, (T, h, w), signal units.

    exposed : the mean before noise. photon_variance : of the light, by its photons.
    light_variance : of light that nobody measured, part of the variance.
    shrinking : what integrates a nuisance out of residuals of a prediction.
    well : what fills a full well; None without one.
    tails : share of the read noise that is wider than the rest, and by which ratio of
    variances; 0 and 1 if none. memo : what was last made of it, for whoever asks again
    (likelihood.whitening)."""

    mean: Array
    variance: Array
    exposed: Array
    photon_variance: Array
    light_variance: Array | float = 0.0
    shrinking: Callable[["Prediction"], Any] | None = None
    well: Well | None = None
    tails: tuple[float, float] = (0.0, 1.0)
    memo: dict[str, Any] = field(
        init=False, default_factory=dict, compare=False, repr=False
    )

    @property
    def below(self) -> Array | float:
        """The chance that the charge of a pixel stays below the full well."""
        return 1.0 if self.well is None else self.well.below

    @cached_property
    def near_well(self) -> Mask | bool:
        """Where the full well is felt, and its density has all noise of the read-out;
        False without one."""
        well = self.well
        if well is None:
            return False
        return well.is_near(self.photon_variance + self.light_variance)

    @cached_property
    def shrinkage(self) -> Any:
        """What integrates the nuisance out of residuals; None if there is none."""
        return None if self.shrinking is None else self.shrinking(self)
