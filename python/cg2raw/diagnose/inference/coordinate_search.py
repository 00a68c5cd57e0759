# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Coordinate search: parabolas along one coordinate after the other."""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Values
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

ENOUGH = 0.3  # nats; a step that promises less is not taken
# The next steps, at least: as a share, of a parabola and of what bends the other way.
SMALLER, SMALLER_UNBENT = 0.1, 0.35
TOLD = 2.0  # nats that a step loses from the top: a smaller one tells no more
TOO_LITTLE = 0.01  # nats, of a sweep that is the last
SWEEPS = 4
MOST_RIDGE = 3  # steps along the way that coordinates led
FARTHEST_TOP = 4.0  # steps, of the top of a parabola


class SearchSpace(Protocol):
    """What is searched: where values may lie, and the first steps, as a share of each
    value and the least."""

    @property
    def first_step(self) -> float | tuple[float, ...]: ...

    @property
    def first_scale(self) -> float: ...

    def clipped(self, values: Values) -> Values: ...


class Box:
    """A search space between bounds."""

    def __init__(self, low: Values, high: Values, first_scale: float = 0.02) -> None:
        self._low, self._high = low, high
        self.first_step, self.first_scale = Effect.first_step, first_scale

    def clipped(self, values: Values) -> Values:
        return np.clip(values, self._low, self._high)


def fit_transform(
    model: Model, name: str, likelihood: Likelihood, quick: bool = False
) -> tuple[Model, float]:
    """Return (model with the best values of a transform, log-likelihood).

    quick : no better ones than those that a search starts from."""
    term = model.term(name)
    assert term is not None
    # What moves the prediction, too, is predicted anew.
    moves = term.effect.predicted or term.effect.scales
    known = None if moves else likelihood.predictions(model)

    def score(values: Values) -> float:
        return likelihood.total(model.with_values(name, values), known)

    values, highest = best_values(term, score, quick)
    return model.with_values(name, values).within_bounds(name), highest


def best_values(
    term: Term, score: Callable[[Values], float], quick: bool = False
) -> tuple[Values, float]:
    """Return (best values of a term, their score).

    A search goes on from what was found before: its steps reach far enough.
    quick : no better ones than those that a search starts from."""
    starts = [np.array(start, float) for start in term.effect.starts]
    began = any(np.array_equal(term.values, start) for start in starts)
    if np.any(term.values) and not began:
        starts = [term.values]
    values, highest = best_of(starts, score)
    if not quick:
        values, highest = climb(term.effect, values, highest, score)
    return values, highest


def best_of(
    starts: Sequence[Values], score: Callable[[Values], float]
) -> tuple[Values, float]:
    """Return (values, their score) of the start that scores highest."""
    scores = [score(values) for values in starts]
    best = int(np.argmax(scores))
    return starts[best], scores[best]


def climb(
    space: SearchSpace,
    values: Values,
    highest: float,
    score: Callable[[Values], float],
) -> tuple[Values, float]:
    """Return (values, their score): parabolas along one coordinate after the other,
    then along where these led, ever smaller, until they gain no more.

    Source: M. J. D. Powell, The Computer Journal 7(2), 1964."""
    scale = np.maximum(np.abs(values) * space.first_step, space.first_scale)
    for sweep in range(SWEEPS):
        start, low = values, highest
        shares = np.ones(len(values))
        for index in range(len(values)):
            unit = np.zeros(len(values))
            unit[index] = scale[index]
            values, highest, shares[index] = _climbed(
                space, values, highest, score, unit
            )
        for _ in range(MOST_RIDGE if len(values) > 1 else 0):
            led = values - start
            if np.count_nonzero(led) < 2:
                break
            start, before = values, highest
            values, highest, _ = _climbed(space, values, highest, score, led)
            if highest - before < ENOUGH / 3:
                break
        if highest - low < TOO_LITTLE and (sweep or (shares == 1).all()):
            break
        scale = scale * shares
    return values, highest


def _climbed(
    space: SearchSpace,
    values: Values,
    highest: float,
    score: Callable[[Values], float],
    unit: Values,
) -> tuple[Values, float, float]:
    """Return (values, score) of the best of a step to either side, and of the top of
    the parabola through them, and the next step as a share of this one."""
    points = [space.clipped(values + d * unit) for d in (-1, 1)]
    heights = [score(point) for point in points]
    bend = heights[0] - 2 * highest + heights[1]
    share = SMALLER_UNBENT
    if bend < 0:
        share = float(np.clip(np.sqrt(2 * TOLD / -bend), SMALLER, 1))
        top = 0.5 * (heights[0] - heights[1]) / bend
        top = np.clip(top, -FARTHEST_TOP, FARTHEST_TOP)
        points.append(space.clipped(values + top * unit))
        heights.append(score(points[-1]))
    best = int(np.argmax(heights))
    if heights[best] <= highest:
        return values, highest, share
    return points[best], heights[best], share
