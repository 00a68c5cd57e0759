# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Prediction: what a model says of the pixels of one frame."""

from dataclasses import dataclass

from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.frames.well import Well


@dataclass(frozen=True)
class Prediction:
    """Mean and variance over frames of every pixel, (T, h, w), signal units.

    exposed : the mean before noise. photon_variance : of the light, by its photons.
    well : what fills a full well; None without one. pattern_third_cumulant : of fixed
    patterns of pixels, of signals cubed."""

    mean: Array
    variance: Array
    exposed: Array
    photon_variance: Array
    well: Well | None = None
    pattern_third_cumulant: float = 0.0
