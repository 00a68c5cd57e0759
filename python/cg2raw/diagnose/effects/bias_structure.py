# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Bias structure: a black level that is not the same all over the frame."""

from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Predicted, Values
from cg2raw.diagnose.effects.families import PEDESTAL
from cg2raw.diagnose.frames.tiling import Array

LENGTHS = 2.0 ** np.arange(0, 10)  # px, of an edge, that are tried first
LONGEST_EDGE = 0.125  # of the columns; a longer one is a ramp
FEWEST_LINES = 8  # rows, or columns, that tell a ramp


class BiasStructure(Effect):
    """A ramp, and first columns of their own; what single columns have besides is the
    column fixed pattern's, and what single pixels have is DSNU."""

    name = "bias_structure"
    title = "bias structure"
    where = "a ramp over the frame, or its first columns, whatever the light"
    step = 1e-4
    steps_of = {"edge_length": 0.5}
    # Found on top of what a profile has, which may be too much.
    bounds = {"edge_length": (-200.0, 200.0)}
    switches = ("horizontal", "vertical", "edge")
    shape_of = {"edge_length": "edge"}
    families = frozenset({PEDESTAL})
    signature = frozenset({"offset"})
    measured_by_uniform_frames = True
    starts_from_data = True  # an edge of no length has no slope
    told_apart = {
        "amplifier_glow": "Darks of two exposure times: what an amplifier's light "
        "leaves grows with time, a bias structure does not.",
        "black_level": "One dark: a black level lifts it evenly.",
    }

    def first_values(self, predicted: Predicted) -> Values | None:
        """Return ramps through the means of rows and of columns, and of edges of some
        lengths that with which columns are described best."""
        rows, columns = (_Lines.of(predicted, axis) for axis in (0, 1))
        if min(rows.count, columns.count) < FEWEST_LINES:
            return None
        (down,), _ = rows.fitted()
        lengths = LENGTHS[LENGTHS <= LONGEST_EDGE * columns.length]
        across = {x: columns.fitted(np.exp(-columns.places / x)) for x in lengths}
        length = min(across, key=lambda x: across[x][1])
        right, edge = across[length][0]
        return np.array([right, down, edge, length])


@dataclass(frozen=True)
class _Lines:
    """Rows or columns: places, mean residuals and weights of those that count."""

    places: Array
    residual: Array
    weight: Array
    length: int

    @staticmethod
    def of(predicted: Predicted, axis: int) -> "_Lines":
        """axis : 0 for rows, 1 for columns."""
        length = predicted[0][0].tiles.shape[axis]
        weight, total = np.zeros((2, length))
        for frame, p in predicted:
            if frame.tiles.shape[axis] != length:
                continue
            of_pixels = (frame.keep & ~frame.censored) / p.variance
            places = frame.tiles.rows_and_columns()[axis].ravel()
            along = 2 - axis
            pull = of_pixels * (frame.signal - p.mean)
            np.add.at(weight, places, of_pixels.sum(along).ravel())
            np.add.at(total, places, pull.sum(along).ravel())
        places = np.flatnonzero(weight)
        residual = total[places] / weight[places]
        return _Lines(places, residual, weight[places], length)

    @property
    def count(self) -> int:
        return len(self.places)

    def fitted(self, *more: Array) -> tuple[Values, float]:
        """Return (ramp and what else is fitted, what is left of squares)."""
        ramp = (self.places + 0.5) / self.length - 0.5
        design = np.stack([ramp, *more], 1)
        root = np.sqrt(self.weight)
        found = np.linalg.lstsq(design * root[:, None], self.residual * root)[0]
        rest = root * (self.residual - design @ found)
        return found, float(rest @ rest)


EFFECT = BiasStructure()
