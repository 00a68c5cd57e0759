# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""PDAF pixels: a regular grid of pixels has another sensitivity."""

import numpy as np
from scipy.ndimage import uniform_filter

from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Gain,
    Parameter,
    Predicted,
    Values,
)
from cg2raw.diagnose.effects.families import GAIN, LIGHT, TEMPORAL
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import shown_light
from cg2raw.diagnose.frames.tiling import Array

PITCHES = range(4, 65)
TYPICAL_PITCH = 16  # of a grid, of whose detection limit is told
LEAST_AROUND = 1e-9  # of the most information around a site, that is any
AROUND = 9  # sites of one place of a CFA's repeat that a pixel is compared with, a side
FEWEST_OF_GRID = 4  # of a grid that may be one


class PdafPixels(Effect):
    """Its grid is found once, in the light that pixels lack or have more of than those
    around them; its gain is fitted."""

    name = "pdaf_pixels"
    title = "phase-detection pixels"
    where = "pixels of a regular grid, in proportion to light"
    search = (
        Parameter("gain", -0.9, 0.5),
        Parameter("pitch", 0.0, 64.0, "px"),
        Parameter("row", 0.0, 63.0, "px"),
        Parameter("column", 0.0, 63.0, "px"),
    )
    switches = ("gain",)
    held = frozenset({"pitch", "row", "column"})
    families = frozenset({GAIN, TEMPORAL})
    signature = frozenset({"gain", "map"})
    needs = LIGHT
    starts_from_data = True
    told_apart = {
        "prnu": "Flats: phase-detection pixels stand on a regular grid and all lack "
        "the same share, PRNU has no order.",
        "hot_pixels": "Darks beside flats: a hot pixel is bright in darks, a "
        "phase-detection pixel shows in light alone.",
        "gr_gb_imbalance": "Flats: an imbalance is that of all greens of a row, "
        "phase-detection pixels are few.",
    }

    def first_values(self, predicted: Predicted) -> Values | None:
        """Return the grid whose pixels differ most from those around them."""
        score, information = np.zeros((2, 1, 1, 1))
        chosen = [(f, p) for f, p in predicted if f.samples is None]
        most = max((frame.signal.size for frame, _ in chosen), default=0)
        chosen = [one for one in chosen if one[0].signal.size == most]
        for frame, p in chosen:
            told, weight = _light_beside(frame, p)
            score, information = score + told, information + weight
        if not np.any(information):
            return None
        rows, columns = chosen[0][0].tiles.rows_and_columns()
        rows, columns = (np.broadcast_to(x, score.shape) for x in (rows, columns))
        best = max(
            (_strongest(n, rows, columns, score, information) for n in PITCHES),
            key=lambda found: found[0],
        )
        return np.array(best[1:])

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        """Of a grid of TYPICAL_PITCH."""
        told = sum(
            float((shown_light(f, p) ** 2 / p.variance).sum()) for f, p in selected
        )

        def gain(excess: float) -> float:
            return 0.5 * excess**2 * told / TYPICAL_PITCH**2

        return gain

    def added(self, listed: Values, values: Values) -> Values:
        """The gains of both, on the grid that was found."""
        return np.array([listed[0] + values[0], *values[1:]])

    def size(self, values: Estimates) -> str:
        gain, pitch = value_of(values, "gain"), value_of(values, "pitch")
        verb = "lack" if gain < 0 else "have"
        more = "" if gain < 0 else " more"
        row, column = value_of(values, "row"), value_of(values, "column")
        return (
            f"one pixel in {pitch:.0f} x {pitch:.0f}, from row {row:.0f} and column "
            f"{column:.0f} on, {verb} {percent(abs(gain))}{more} of the light"
        )


def _light_beside(frame: Frame, p: Prediction) -> tuple[Array, Array]:
    """Return (score, information) (T, h, w) of each pixel's relative light beyond the
    prediction and beyond that of sites around it."""
    light = shown_light(frame, p)
    information = light**2 / p.variance
    score = light * (frame.signal - p.mean) / p.variance
    side = round(np.sqrt(int(frame.site.max()) + 1))
    rest = np.zeros_like(score)
    for row in range(side):
        for column in range(side):
            at = np.s_[:, row::side, column::side]
            around = (1, AROUND, AROUND)
            weight = uniform_filter(information[at], around)
            # Running sums leave a little of what they have passed where there is none.
            some = weight > LEAST_AROUND * weight.max()
            level = some * uniform_filter(score[at], around) / np.where(some, weight, 1)
            rest[at] = score[at] - information[at] * level
    return rest, information


def _strongest(
    pitch: int, rows: Array, columns: Array, score: Array, information: Array
) -> tuple[float, float, float, float, float]:
    """Return (nats, gain, pitch, row, column) of the strongest grid of a pitch."""
    cell = (rows % pitch * pitch + columns % pitch).ravel()
    told, weight, count = (
        np.bincount(cell, each, pitch * pitch)
        for each in (score.ravel(), information.ravel(), (information > 0).ravel())
    )
    nats = np.where(count < FEWEST_OF_GRID, 0, told**2 / np.maximum(weight, 1e-300) / 2)
    top = int(np.argmax(nats))
    gain = told[top] / max(weight[top], 1e-300)
    return float(nats[top]), float(gain), pitch, top // pitch, top % pitch


EFFECT = PdafPixels()
