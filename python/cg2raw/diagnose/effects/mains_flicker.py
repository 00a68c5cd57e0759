# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Mains flicker: bands of light down the rows, of another phase in every frame."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import gamma

from cg2raw.diagnose.effects.base import (
    Estimates,
    Gain,
    Parameter,
    Predicted,
    Values,
    WhiteningStage,
)
from cg2raw.diagnose.effects.families import LIGHT, TEMPORAL
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.effects.shared_fields import SharedFields
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import shown_light
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

FEWEST_WAVES = 0.75  # in a frame: a slower one is a slope of its light
HIGHEST_FREQUENCY = 0.25  # per row
FINER = 8  # frequencies of a periodogram, of those that a frame's rows tell apart
SLOPES = 2  # degree of what is no wave
HIGHEST_BY_CHANCE = 1e-3  # highest waves by chance, of one that is looked at
FEWEST_ALIKE = 3  # frames from which on what they share is no wave


class MainsFlicker(SharedFields):
    """Its phase is no parameter: it is even over a turn, which a Gaussian wave of the
    same variance is nearly, and that is integrated out."""

    name = "mains_flicker"
    title = "mains flicker"
    where = "bands down the rows, in proportion to light, anew in every frame"
    estimator = "transform"
    search = (Parameter("amplitude", 0.0, 0.5), Parameter("period", 4.0, 1e5, "px"))
    starts = ((0.0, 4.0),)
    first_scale = 0.002
    first_step = (0.4, 0.01)
    switches = ("amplitude",)
    families = frozenset({TEMPORAL})
    signature = frozenset({"noise"})
    absorbs = True
    moves_mean = False
    needs = LIGHT
    whitening = WhiteningStage.NUISANCE
    starts_from_data = True
    told_apart = {
        "row_noise": "Darks beside flats: flicker is in proportion to light and has a "
        "period, row noise is in darks as well and differs from each row to the next.",
        "lens_shading": "Repeated flats: what a lens shades stays where it is, and "
        "flicker moves from frame to frame.",
    }

    def light(self, values: Values, frame: Frame) -> list[Array]:
        amplitude, period = values
        if amplitude <= 0 or not frame.capture.shows.light:
            return []
        turns = 2 * np.pi * frame.tiles.rows_and_columns()[0] / period
        return [amplitude / np.sqrt(2) * wave(turns) for wave in (np.cos, np.sin)]

    def first_values(self, predicted: Predicted) -> Values | None:
        """Return the highest wave of the rows' light over all frames; None if it is no
        higher than chance, or the same in all frames.

        What frames share is no wave, nor is a slope of one."""
        shown = [_Rows.of(frame, p) for frame, p in predicted]
        shown = [rows for rows in shown if rows.information.any()]
        if not shown:
            return None
        length = max(rows.information.size for rows in shown)
        waves = np.fft.rfftfreq(FINER * length)
        power, information, free = np.zeros(waves.size), 0.0, 0.0
        for rows in _without_shared(shown):
            score = rows.information * rows.light
            told = rows.information.sum()
            power += np.abs(np.fft.rfft(score, FINER * length)) ** 2 / told
            information += rows.free * told
            free += rows.free
        power[(waves < FEWEST_WAVES / length) | (waves > HIGHEST_FREQUENCY)] = 0
        top = int(np.argmax(power))
        # Of each frequency this is of the exponential law, by chance.
        if np.count_nonzero(power) * gamma.sf(power[top], free) > HIGHEST_BY_CHANCE:
            return None
        excess = max(power[top] - free, 1.0)
        frequency = waves[top] + _top_of(power[top - 1 : top + 2]) * waves[1]
        return np.array([2 * np.sqrt(excess / information), 1 / frequency])

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        told = [
            float((shown_light(frame, p) ** 2 / p.variance).sum())
            for frame, p in selected
        ]

        def gain(amplitude: float) -> float:
            each = amplitude**2 / 4 * np.array(told)
            return float((each - np.log1p(each)).sum())

        return gain

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        return listed_values(sensor, self.name)

    def size(self, values: Estimates) -> str:
        return (
            f"amplitude {percent(value_of(values, 'amplitude'))} of the light, one "
            f"wave in {value_of(values, 'period'):.4g} rows"
        )


class _Rows:
    """Of a frame's rows, (rows,): relative light beyond the prediction, information.

    free : share of their waves that is left where something was taken from them."""

    def __init__(self, light: Array, information: Array, free: float = 1.0) -> None:
        self.light, self.information, self.free = light, information, free

    @classmethod
    def of(cls, frame: Frame, p: Prediction) -> "_Rows":
        light = shown_light(frame, p)
        rows = np.broadcast_to(frame.tiles.rows_and_columns()[0], light.shape)
        height = frame.tiles.shape[0]
        score, information = (
            np.bincount(rows.ravel(), each.ravel(), height)
            for each in (
                light * (frame.signal - p.mean) / p.variance,
                light**2 / p.variance,
            )
        )
        return cls(score / np.maximum(information, 1e-300), information)

    def without(self, light: Array, degree: int, free: float = 1.0) -> "_Rows":
        """Return the rows without some light, and without a polynomial of what is
        left."""
        rest = self.light - light
        places = np.linspace(-1, 1, rest.size)
        weight = np.sqrt(self.information)
        slope = np.polynomial.Polynomial.fit(places, rest, degree, w=weight)
        return _Rows(rest - slope(places), self.information, free)


def _without_shared(shown: Sequence[_Rows]) -> list[_Rows]:
    """Return rows without their level and what all frames of a height have in common;
    where that is not known, without slopes."""
    result = []
    for rows in shown:
        alike = [r for r in shown if r.light.size == rows.light.size]
        if len(alike) < FEWEST_ALIKE:
            result.append(rows.without(0 * rows.light, SLOPES))
            continue
        total = np.sum([r.information for r in alike], 0)
        score = np.sum([r.information * r.light for r in alike], 0)
        own = 1 - rows.information.sum() / total.sum()
        result.append(rows.without(score / np.maximum(total, 1e-300), 0, own))
    return result


def _top_of(three: Array) -> float:
    """Return where a parabola through three heights is highest, from the middle on."""
    if three.size < 3 or (bend := three[0] - 2 * three[1] + three[2]) >= 0:
        return 0.0
    return float(0.5 * (three[0] - three[2]) / bend)


EFFECT = MainsFlicker()
