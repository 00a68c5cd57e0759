# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Amplifier glow: light of the read-out amplifier, at an edge or in a corner."""

from itertools import product

import numpy as np
from scipy.optimize import minimize

from cg2raw.diagnose.effects.base import Effect, Estimates, Predicted, Values
from cg2raw.diagnose.effects.families import PEDESTAL, TIME
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.diagnose.frames.tiling import Array, Tiling
from cg2raw.sensor import Sensor

PLACES = [place for place in product((-1.0, 0.0, 1.0), repeat=2) if any(place)]
EXTENTS = (0.1, 0.25, 0.6)  # half diagonals, that are tried first
NARROW_AND_WIDE = (0.03, 1.0)  # where the first is looked for
MOST_TRIED = 120  # places, on the way to the first


class AmplifierGlow(Effect):
    """Charge that fades from a point; what it leaves grows with exposure time."""

    name = "amplifier_glow"
    title = "amplifier glow"
    where = "fades from an edge or a corner, with exposure time, in darks too"
    step = 1e-3
    steps_of = {"row": 0.02, "column": 0.02, "extent": 0.02}
    # Found on top of what a profile has, which may be too much.
    bounds = {
        "per_second": (-10.0, 10.0),
        "row": (-2.0, 2.0),
        "column": (-2.0, 2.0),
        "extent": (-1.0, 1.0),
    }
    switches = ("per_second",)
    ends = frozenset({"row", "column"})  # beside the pixels
    shape_of = dict.fromkeys(("row", "column", "extent"), "per_second")
    families = frozenset({PEDESTAL})
    signature = frozenset({"offset"})
    needs = TIME
    measured_by_uniform_frames = True
    starts_from_data = True  # a glow without extent has no slope
    told_apart = {
        "bias_structure": "Darks of two exposure times: what an amplifier's light "
        "leaves grows with time, a bias structure does not.",
        "dark_current": "One long dark: dark current lifts all of it evenly.",
    }

    def first_values(self, predicted: Predicted) -> Values | None:
        """Return the glow, of those from corners and edges, that describes what is
        left of the frames best."""
        information, score = _of_charge(predicted)
        if not information.any():
            return None
        tiles = predicted[0][0].tiles

        def glow(place: Values) -> tuple[float, float]:
            """place : row, column and log of the extent."""
            row, column, extent = *place[:2], np.exp(place[2])
            shape = np.exp(-distance(tiles, row, column) / extent)
            return _fitted(shape, information, score)

        grid = [np.array([*at, np.log(x)]) for at, x in product(PLACES, EXTENTS)]
        best = max(grid, key=lambda place: glow(place)[0])
        if glow(best)[0] <= 0:
            return None
        found = minimize(
            lambda place: -glow(place)[0],
            best,
            method="Nelder-Mead",
            bounds=[(-1.0, 1.0), (-1.0, 1.0), tuple(np.log(NARROW_AND_WIDE))],
            options={"maxfev": MOST_TRIED, "fatol": 0.1, "xatol": 1e-3},
        )
        row, column, log_extent = found.x
        return np.array([glow(found.x)[1], row, column, np.exp(log_extent)])

    def size(self, values: Estimates) -> str:
        return self.words(values, None)

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        return self.words(values, sensor)

    def words(self, values: Estimates, sensor: Sensor | None) -> str:
        """Return rate, place and extent; the rate in the units of a sensor."""
        rate = of_white(value_of(values, "per_second"), sensor)
        places = (value_of(values, "row"), value_of(values, "column"))
        down, across = (f"{place:+.2f}" for place in places)
        return (
            f"{rate} per second at row {down}, column {across} (-1 and +1 at the "
            f"edges), less by a factor e every {value_of(values, 'extent'):.3g} half "
            "diagonals"
        )


def distance(tiles: Tiling, row: float, column: float) -> Array:
    """Return how far each pixel lies from a point, (T, h, w), in half diagonals.

    row, column : -1 and 1 at the edges of the frame."""
    u, v = tiles.field()
    diagonal = np.hypot(*tiles.shape)
    down, across = row * tiles.shape[0] / diagonal, column * tiles.shape[1] / diagonal
    return np.asarray(np.hypot(u - across, v - down))


def _of_charge(predicted: Predicted) -> tuple[Array, Array]:
    """Return (information, score) of a charge per second of each pixel, from frames of
    the first one's shape."""
    information, score = np.zeros((2, *predicted[0][0].signal.shape))
    for frame, p in predicted:
        if frame.signal.shape == score.shape:
            weight = (frame.keep & ~frame.censored) * frame.seconds / p.variance
            information += weight * frame.seconds
            score += weight * (frame.signal - p.mean)
    return information, score


def _fitted(shape: Array, information: Array, score: Array) -> tuple[float, float]:
    """Return (nats that a shape gains, its strength); no gain if that is below 0."""
    known, pull = float((information * shape**2).sum()), float((score * shape).sum())
    if known <= 0 or pull <= 0:
        return 0.0, 0.0
    return 0.5 * pull**2 / known, pull / known


EFFECT = AmplifierGlow()
