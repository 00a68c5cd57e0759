# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Outliers: pixels of single frames that no model of a camera is to explain.

A cosmic ray, or a pixel that flickers, lies hundreds of standard deviations out: a
Gaussian would give its nats to whatever widens the noise. Where nearly all pixels fit a
model, those few that are far out count neither for it nor against it.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Mask
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model

FARTHEST = 6.0  # standard deviations; of normal pixels one in 500 million lies beyond
# Such bounds, one after the other: what is far out moves the mean of its row, by which
# all the row is whitened, and its neighbours.
BOUNDS = (100.0, 25.0, FARTHEST)
MOST_EXPECTED = 2.0  # times what a profile says: a sensor 6 K warmer has as many


def outliers(model: Model, frame: Frame, most: float, trimmed: bool = False) -> Mask:
    """Return (T, h, w), True in a frame's outliers under a model; nowhere if they are
    more than a share of its pixels: then it is the model that is wrong.

    trimmed : then the farthest of them are, up to that share. What is fitted to the
        rest may lead to a model that is right, where a single cosmic ray outweighs a
        frame. Source: P. J. Rousseeuw, J. Am. Stat. Assoc. 79(388), 1984 (least trimmed
        squares)."""
    far: Mask = np.zeros_like(frame.keep)
    rest, away, farness = frame, None, np.zeros(frame.keep.shape)
    for bound in BOUNDS:
        if away is None:
            away = np.abs(log_density(model, rest)[1])
            farness = np.where(far, farness, away)
        more = (away > bound) & rest.keep
        if more.any():  # else nothing has moved
            far = far | more
            rest, away = replace(frame, keep=frame.keep & ~far), None
    allowed = int(most * max(int(frame.keep.sum()), 1))
    if far.sum() <= allowed:
        return far
    if not (trimmed and allowed):
        return np.zeros_like(far)
    farthest: Mask = far & (farness > np.partition(farness[far], -allowed)[-allowed])
    return farthest


def without_outliers(
    model: Model, splits: Splits, most: float, trimmed: bool = False
) -> Splits:
    """Return the frames without their outliers under a model.

    most, trimmed : see outliers()."""
    return _without(model, splits, [most] * len(splits.frames), trimmed)


def expected_outliers(model: Model, frame: Frame, known: Collection[str] = ()) -> float:
    """Return the share of a dark's pixels that lie far out by the profile's own laws of
    defects: which pixels these are, no profile can say, but as many are no noise.

    known : effects that do not count, since a map says which pixels they are."""
    if frame.capture.shows.light:
        return 0.0
    far = FARTHEST * float(np.sqrt(np.median(frame.beta2)))
    shares = [
        every()[name].share_beyond(parameters, far, frame.seconds)
        for name, parameters in model.profile_parameters.items()
        if name not in known
    ]
    return min(MOST_EXPECTED * sum(shares), 1.0)


def without_expected_outliers(model: Model, splits: Splits) -> tuple[Splits, float]:
    """Return the frames without the outliers that the profile's defects leave where no
    repeats map them, and the largest share of a frame that may be set aside."""
    shares = [expected_outliers(model, frame) for frame in splits.frames]
    if not any(shares):
        return splits, 0.0
    return _without(model, splits, shares), max(shares)


def _without(
    model: Model, splits: Splits, shares: Sequence[float], trimmed: bool = False
) -> Splits:
    """Return the frames without their outliers, of each by its share."""

    def cleaned(one: tuple[Frame, float]) -> Frame:
        frame, most = one
        far = outliers(model, frame, most, trimmed)
        return replace(frame, keep=frame.keep & ~far)

    pairs = list(zip(splits.frames, shares, strict=True))
    return Splits(splits.workers.map(cleaned, pairs), splits.workers)
