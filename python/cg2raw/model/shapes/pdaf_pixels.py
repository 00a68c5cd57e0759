# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Phase-detection pixels: those of a lattice have another share of the light."""

import numpy as np

from cg2raw.model.figures import Figure
from cg2raw.model.shapes.base import Shape, Shown
from cg2raw.model.shapes.light_patterns import Excess, excesses_of, frame_shape, nats_of
from cg2raw.normal import robust_deviation

NAME = "pdaf_pixels"
FAR = 4.0  # standard deviations from the median, of a pixel that is none of the others


def pdaf_pixels(shown: Shown) -> Shape | None:
    """Return the evidence of the lattice that flats show, less that of any among all
    that were tried; None without one."""
    lattice = shown.statistics.lattice
    if lattice is None:
        return None
    excesses = excesses_of(shown, lattice.samples(frame_shape(shown)))
    if excesses is None:
        return None
    trained, measured, (gain, error) = map(_mean, excesses)
    nats = nats_of(trained, measured, (gain, error), lattice.tried)
    known = ("pitch", lattice.pitch), ("row", lattice.row), ("column", lattice.column)
    return Shape(
        NAME,
        nats,
        (
            Figure.normal("gain", "1", gain, error),
            *(Figure.normal(name, "px", float(x), 0.0) for name, x in known),
        ),
    )


def _mean(excess: Excess) -> tuple[float, float]:
    """Return the mean without pixels that differ from the others, and its standard
    error, by how those left differ if that is more than noise."""
    middle = float(np.median(excess.values))
    most = FAR * max(robust_deviation(excess.values), 1e-12)
    kept = excess.where(np.abs(excess.values - middle) <= most)
    mean, error = kept.times(np.ones(len(kept.values)))
    spread = float(kept.values.std()) / np.sqrt(max(len(kept.values) - 1, 1))
    return mean, max(error, spread)
