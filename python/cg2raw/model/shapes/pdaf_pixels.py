# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Phase-detection pixels: those of a lattice have another share of the light."""

import numpy as np

from cg2raw.model.figures import NORMAL, Figure
from cg2raw.model.shapes.base import Shape, Shown
from cg2raw.model.shapes.light_patterns import Excess, excess_of, frame_shape, nats_of

NAME = "pdaf_pixels"
FAR = 4.0  # standard deviations from the median, of a pixel that is none of the others
MAD = 1.4826  # standard deviations in a median of absolute deviations


def pdaf_pixels(shown: Shown) -> Shape | None:
    """Return the evidence of the lattice that flats show, less that of any among all
    that were tried; None without one."""
    lattice = shown.statistics.lattice
    if lattice is None:
        return None
    samples = lattice.samples(frame_shape(shown))
    first, second, both = (
        excess_of(shown, splits, samples)
        for splits in (shown.splits[:1], shown.splits[1:], shown.splits)
    )
    if first is None or second is None or both is None:
        return None
    trained, measured, (gain, error) = map(_mean, (first, second, both))
    nats = nats_of(trained, measured, (gain, error), lattice.tried)
    ends = gain - NORMAL * error, gain + NORMAL * error
    known = ("pitch", lattice.pitch), ("row", lattice.row), ("column", lattice.column)
    return Shape(
        NAME,
        nats,
        (
            Figure("gain", "1", gain, error, *ends),
            *(Figure(name, "px", float(x), 0.0, x, x) for name, x in known),
        ),
    )


def _mean(excess: Excess) -> tuple[float, float]:
    """Return the mean without pixels that differ from the others, and its standard
    error, by how those left differ if that is more than noise."""
    middle = float(np.median(excess.values))
    away = np.abs(excess.values - middle)
    kept = excess.where(away <= FAR * max(MAD * float(np.median(away)), 1e-12))
    mean, error = kept.times(np.ones(len(kept.values)))
    spread = float(kept.values.std()) / np.sqrt(max(len(kept.values) - 1, 1))
    return mean, max(error, spread)
