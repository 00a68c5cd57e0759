# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Outliers: pixels of single frames that no model of a camera is to explain.

A cosmic ray, or a pixel that flickers, lies hundreds of standard deviations out: a
Gaussian would give its nats to whatever widens the noise. Where nearly all pixels fit a
model, those few that are far out count neither for it nor against it.
"""

from dataclasses import replace

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Mask
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model

FARTHEST = 6.0  # standard deviations; of normal pixels one in 500 million lies beyond
# Such bounds, one after the other: what is far out moves the mean of its row, by which
# all the row is whitened, and its neighbours.
BOUNDS = (100.0, 25.0, FARTHEST)


def outliers(model: Model, frame: Frame, most: float) -> Mask:
    """Return (T, h, w), True in a frame's outliers under a model; nowhere if they are
    more than a share of its pixels: then it is the model that is wrong."""
    far: Mask = np.zeros_like(frame.keep)
    for bound in BOUNDS:
        rest = replace(frame, keep=frame.keep & ~far)
        far = far | (np.abs(log_density(model, rest)[1]) > bound) & rest.keep
    if far.sum() > most * max(int(frame.keep.sum()), 1):
        return np.zeros_like(far)
    return far


def without_outliers(model: Model, splits: Splits, most: float) -> Splits:
    """Return the frames without their outliers under a model.

    most : share of a frame's pixels."""

    def cleaned(frame: Frame) -> Frame:
        return replace(frame, keep=frame.keep & ~outliers(model, frame, most))

    return Splits(splits.workers.map(cleaned, splits.frames), splits.workers)


def share_set_aside(before: Splits, after: Splits) -> float:
    """Return the share of pixels that count before and not after."""
    kept = [sum(int(f.keep.sum()) for f in one.frames) for one in (before, after)]
    return 1 - kept[1] / max(kept[0], 1)
