# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Fitting: Fisher scoring of smooth parameters, coordinate search of flows.

Sources: D. Nychka's and others' Fisher scoring of mean and variance of a Gaussian:
S. M. Kay, Fundamentals of Statistical Signal Processing I, 1993, section 3.9.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.effects.catalogue import Candidate, Values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.censored_rows import cut_rows
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.likelihood import Workers, total
from cg2raw.diagnose.likelihood.prediction import (
    Model,
    Prediction,
    flow_values,
    place,
    predict,
)
from cg2raw.diagnose.likelihood.whitening import noise_reduction, row_noise

ENOUGH = 0.3  # nats; a step that promises less is not taken
FULL_STEP, FLOW_SHARE = 1.0, 0.4
LEAST_PILE = 2  # pixels at one level that may be a well's
FARTHEST = 4.0  # steps, of the top of a parabola
MOST_RIDGE = 3  # steps along the way that coordinates led
Parameter = tuple[str, int]  # name of a term, index of its value


@dataclass
class _State:
    """Of one frame under a model: what every derivative is taken from.

    residual, square : scores of a pixel's mean, in standard deviations, and of the log
    of its variance. weight : root of what it tells of its mean, 1 but of pixels that
    are cut at an end of the ADC."""

    prediction: Prediction
    residual: Array
    square: Array
    weight: Array
    columns: dict[Parameter, tuple[NDArray[np.float32], NDArray[np.float32]]]


class Linearisation:
    """Derivatives of mean and variance of all frames by a model's parameters.

    Those of the model's own terms are kept while candidates come and go."""

    def __init__(self, model: Model, frames: Sequence[Frame], workers: Workers) -> None:
        self.model, self.frames, self.workers = model, frames, workers
        self._states = workers.map(self._state, frames)

    def _state(self, frame: Frame) -> _State:
        p = predict(self.model, frame)
        rows = self._rows(frame) if frame.is_cut else None
        at = p if rows is None else cut_rows(p, rows, frame).likeliest
        z, square, weight = scores(at, frame)
        if rows is not None:  # they lack the offsets; in part these are ours to explain
            z = row_noise(z, p, rows, frame, power=0.5)[0]
        return _State(p, self._white(z, p, frame, rows is None), square, weight, {})

    def _rows(self, frame: Frame) -> Values | None:
        return flow_values(self.model, frame, "row_noise")

    def _white(self, z: Array, p: Prediction, frame: Frame, rows: bool = True) -> Array:
        """Whiten by what is Gaussian and linear: filtered noise, offsets of rows, and
        the nuisance."""
        blend = flow_values(self.model, frame, "noise_reduction")
        if blend is not None:
            z = noise_reduction(z, blend)[0]
        sigma = self._rows(frame) if rows else None
        if sigma is not None:
            z = row_noise(z, p, sigma, frame)[0]
        nuisance = self.model.nuisance
        return z if nuisance is None else nuisance.whiten(z, p, frame)[0]

    def _column(
        self, state: _State, frame: Frame, parameter: Parameter, model: Model
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        name, index = parameter
        term = model.term(name)
        assert term is not None
        step = term.candidate.steps[index]
        values = term.values.copy()
        if values[index] + step > term.candidate.high[index]:
            step = -step
        values[index] += step
        p = state.prediction
        moved = predict(model.with_values(name, values), frame)
        mean = (moved.mean - p.mean) / step / np.sqrt(p.variance)
        mean = self._white(state.weight * np.where(frame.counted, mean, 0), p, frame)
        spread = (moved.variance - p.variance) / step * np.sqrt(0.5) / p.variance
        return mean[frame.counted].astype("f4"), spread[frame.counted].astype("f4")

    def system(
        self, model: Model, but: str = ""
    ) -> tuple[list[Parameter], Array, Array]:
        """Return (parameters, score, Fisher information) of a model that has this one's
        prediction: the same terms, or one more at its null.

        but : name of a term whose parameters rest."""
        parameters = [one for one in free_parameters(model) if one[0] != but]

        def one(pair: tuple[_State, Frame]) -> tuple[Array, Array]:
            state, frame = pair
            rows = []
            for parameter in parameters:
                column = state.columns.get(parameter)
                if column is None:
                    column = self._column(state, frame, parameter, model)
                    if self.model.term(parameter[0]) is not None:
                        state.columns[parameter] = column
                rows.append(np.concatenate(column))
            z, square = (a[frame.counted] for a in (state.residual, state.square))
            design = np.array(rows)
            right = np.concatenate([z, square]).astype("f4")
            return (
                (design @ right).astype(float),
                (design @ design.T).astype(float),
            )

        if not parameters:
            return parameters, np.zeros(0), np.zeros((0, 0))
        pairs = list(zip(self._states, self.frames, strict=True))
        parts = self.workers.map(one, pairs)
        score = np.sum([part[0] for part in parts], 0)
        return parameters, score, np.sum([part[1] for part in parts], 0)


def free_parameters(model: Model) -> list[Parameter]:
    """Return what Fisher scoring moves: smooth parameters, and noise reduction's."""
    return [
        (term.name, index)
        for term in model.terms
        if term.candidate.way == "smooth" or term.name == "noise_reduction"
        for index in range(len(term.values))
    ]


def solve(score: Array, information: Array) -> tuple[Array, float]:
    """Return (step, promised gain in nats); directions without information rest."""
    if not score.size:
        return score, 0.0
    scale = np.sqrt(np.diag(information))
    scale = np.where(scale > 1e-9 * (scale.max() + 1e-300), scale, np.inf)
    correlation = information / np.outer(scale, scale)
    correlation[np.diag_indices(len(scale))] = 1.0
    eigenvalues, vectors = np.linalg.eigh(correlation)
    eigenvalues = np.maximum(eigenvalues, 1e-7)
    step = vectors @ ((vectors.T @ (score / scale)) / eigenvalues)
    return step / scale, 0.5 * float(step @ (score / scale))


def moved(model: Model, parameters: Sequence[Parameter], step: Array) -> Model:
    """Return the model with parameters moved, each within its bounds."""
    values = {term.name: term.values.copy() for term in model.terms}
    for (name, index), delta in zip(parameters, step, strict=True):
        values[name][index] += delta
    for term in model.terms:
        if term.candidate.way != "pattern":
            clipped = term.candidate.clipped(values[term.name])
            model = model.with_values(term.name, clipped)
    return model


def one_step(
    model: Model, base: Linearisation, current: float, but: str = ""
) -> tuple[Model, float]:
    """Return (model after one damped step, actual gain in nats).

    but : name of a term that rests."""
    parameters, score, information = base.system(model, but)
    if not parameters:
        return model, 0.0
    step, promised = solve(score, information)
    best = (model, 0.0)
    for share in (FULL_STEP, 0.3, 0.1, 0.02):
        trial = moved(model, parameters, share * step)
        gain = total(trial, base.frames, base.workers) - current
        if gain > best[1]:
            best = (trial, gain)
        if gain > 0 and (gain > 0.3 * promised or share < FULL_STEP):
            break
    return best


def fit_flow(
    model: Model,
    name: str,
    frames: Sequence[Frame],
    workers: Workers,
    quick: bool = False,
) -> tuple[Model, float]:
    """Return (model with a flow's best values, log-likelihood)."""
    term = model.term(name)
    assert term is not None
    candidate = term.candidate
    # Only noise reduction moves the prediction too.
    still = name != "noise_reduction"
    known = workers.map(lambda f: predict(model, f), frames) if still else None

    def score(values: Values) -> float:
        return total(model.with_values(name, values), frames, workers, known)

    starts = [np.array(start, float) for start in candidate.starts]
    if np.any(term.values):
        starts.append(term.values)
    scores = [score(values) for values in starts]
    best = int(np.argmax(scores))
    values, highest = starts[best], scores[best]
    if not quick:
        values, highest = search(candidate, values, highest, score)
    return model.with_values(name, values), highest


def search(
    candidate: Candidate,
    values: Values,
    highest: float,
    score: Callable[[Values], float],
) -> tuple[Values, float]:
    """Return (values, their score): parabolas along one coordinate after the other,
    then along where these led, ever smaller.

    Source: M. J. D. Powell, The Computer Journal 7(2), 1964."""
    scale = np.maximum(np.abs(values) * FLOW_SHARE, candidate.first_scale)
    for _ in range(4):
        start = values
        for index in range(len(values)):
            unit = np.zeros(len(values))
            unit[index] = scale[index]
            values, highest = _climbed(candidate, values, highest, score, unit)
        for _ in range(MOST_RIDGE if len(values) > 1 else 0):
            led = values - start
            if np.count_nonzero(led) < 2:
                break
            start, before = values, highest
            values, highest = _climbed(candidate, values, highest, score, led)
            if highest - before < ENOUGH / 3:
                break
        scale = scale * 0.35
    return values, highest


def _climbed(
    candidate: Candidate,
    values: Values,
    highest: float,
    score: Callable[[Values], float],
    unit: Values,
) -> tuple[Values, float]:
    """Return (values, score) of the best of a step to either side, and of the top of
    the parabola through them."""
    points = [candidate.clipped(values + d * unit) for d in (-1, 1)]
    heights = [score(point) for point in points]
    bend = heights[0] - 2 * highest + heights[1]
    if bend < 0:
        top = np.clip(0.5 * (heights[0] - heights[1]) / bend, -FARTHEST, FARTHEST)
        points.append(candidate.clipped(values + top * unit))
        heights.append(score(points[-1]))
    best = int(np.argmax(heights))
    return (
        (points[best], heights[best]) if heights[best] > highest else (values, highest)
    )


def fit(
    model: Model, frames: Sequence[Frame], workers: Workers, rounds: int = 7
) -> Model:
    """Return the model of maximum likelihood near a model, all terms together."""
    current = total(model, frames, workers)
    for _ in range(2):
        start = current
        model, current = _scored(model, current, frames, workers, rounds)
        structured = [t.name for t in model.terms if t.candidate.way != "smooth"]
        if not structured:
            break
        model = fit_patterns(model, frames, workers)
        for name in structured:
            term = model.term(name)
            if term is not None and term.candidate.way == "flow":
                model, _ = fit_flow(model, name, frames, workers)
        current = total(model, frames, workers)
        if abs(current - start) < 0.5:
            break
    return model


def _scored(
    model: Model,
    current: float,
    frames: Sequence[Frame],
    workers: Workers,
    rounds: int,
) -> tuple[Model, float]:
    """Fisher scoring with damped steps until it gains no more."""
    for _ in range(rounds):
        base = Linearisation(model, frames, workers)
        model, gain = one_step(model, base, current)
        current += gain
        if gain < ENOUGH:
            break
    return model, current


def start_of_clipping(
    model: Model, candidate: Candidate, frames: Sequence[Frame], workers: Workers
) -> Model | None:
    """Early clipping where bright pixels pile up; its likelihood has no slope at null.

    None if no pixels lie far below what is predicted of them."""

    def low_ones(frame: Frame) -> Array:
        p = predict(model, frame)
        low = p.mean - frame.signal > 6 * np.sqrt(p.variance - p.light_variance)
        return frame.signal[
            frame.counted & ~frame.censored & low & (frame.signal > 0.25)
        ]

    values = np.concatenate(workers.map(low_ones, frames))
    if not values.size:
        return None
    width = max(4 * np.sqrt(max(f.beta2.mean() for f in frames)), 2e-4)
    bins = (values / width).astype(int)
    fullest = np.argmax(np.bincount(bins))
    pile = values[bins == fullest]
    if pile.size < LEAST_PILE:
        return None
    below_white = max(1 - float(np.median(pile)), 1e-3)
    return place(model, candidate, candidate.clipped(np.array([below_white])))


def information_of(
    model: Model, frames: Sequence[Frame], workers: Workers
) -> tuple[list[Parameter], Array]:
    """Return (parameters, Fisher information) of a model on frames."""
    parameters, _, information = Linearisation(model, frames, workers).system(model)
    return parameters, information
