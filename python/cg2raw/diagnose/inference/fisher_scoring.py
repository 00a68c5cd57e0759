# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Fisher scoring: steps of smooth parameters, from derivatives of mean and variance.

Source: S. M. Kay, Fundamentals of Statistical Signal Processing I, 1993, section 3.9.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.families import TIME
from cg2raw.diagnose.effects.registry import registered
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.design import Derivatives, Design, Rows, scaled
from cg2raw.diagnose.likelihood.censored_offsets import censored_offsets
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import mean_of, predict
from cg2raw.diagnose.likelihood.whitening import (
    colour_offsets,
    cut_offsets,
    whiten_linearly,
)

FULL_STEP, SHORTER_STEPS = 1.0, (0.3, 0.1, 0.02)
KEPT_PROMISE = 0.3  # of the gain that a step promises, from which on it is taken
# Of what single parameters tell, that a direction of several has: of less, the sums
# over pixels in float32 are as much by themselves.
LEAST_CORRELATED = 1e-6
Parameter = tuple[str, int]  # name of a term, index of its value
# Of a frame: labels that are broadcast to its pixels, how many there are.
PixelLabels = Callable[[Frame], tuple[NDArray[np.intp], int]]


@dataclass
class _State:
    """Of one frame under a model: what every derivative is taken from.

    residual, square : scores of a pixel's mean, in standard deviations, and of the log
    of its variance. weight : root of its information on its mean, 1 but of pixels that
    are cut at an end of the ADC. mean : as if no well were full. own : derivatives by
    the model's parameters, once they were asked for."""

    prediction: Prediction
    residual: Array
    square: Array
    weight: Array
    mean: Array
    own: tuple[tuple[Parameter, ...], Design] | None = None


class Linearisation:
    """Derivatives of mean and variance of all frames by a model's parameters.

    Those of the model's own terms are kept while candidates come and go.
    near : of a model nearby, whose derivatives are taken for these."""

    def __init__(
        self,
        model: Model,
        likelihood: Likelihood,
        near: "Linearisation | None" = None,
    ) -> None:
        self.model, self.likelihood = model, likelihood
        self._near = near

    @cached_property
    def height(self) -> float:
        """The log-likelihood of the model."""
        return self.likelihood.total(self.model)

    @cached_property
    def _states(self) -> list[_State]:
        states = self.likelihood.each(self._state)
        if self._near is not None:
            for state, near in zip(states, self._near._states, strict=True):
                state.own = near.own
        return states

    def _state(self, frame: Frame) -> _State:
        p = predict(self.model, frame)
        cut = cut_offsets(self.model, frame)
        at = p if cut is None else censored_offsets(p, cut, frame).likeliest
        z, square, weight = scores(at, frame)
        if cut is not None:  # they lack the offsets; in part these are ours to explain
            z = colour_offsets(z, p, self.model, frame)
        white = whiten_linearly(z, p, self.model, frame, cut is None)
        # What pixels share is no variance of their own.
        own = (white * white - 1) * np.sqrt(0.5)
        square = np.where(frame.counted & ~frame.censored, own, square)
        bare = mean_of(self.model, frame)
        return _State(p, white, square, weight, bare)

    def _standardised(
        self, state: _State, frame: Frame, of: Derivatives
    ) -> Derivatives:
        """Return derivatives of the pixels that count, in standard deviations."""
        mean, variance = of
        p = state.prediction
        if mean is not None:
            mean = state.weight * np.where(frame.counted, mean / np.sqrt(p.variance), 0)
            mean = whiten_linearly(mean, p, self.model, frame, True)[frame.counted]
        if variance is not None:
            variance = (variance * np.sqrt(0.5) / p.variance)[frame.counted]
        return mean, variance

    def system(
        self, model: Model, held: Collection[str] = ()
    ) -> tuple[list[Parameter], Array, Array]:
        """Return (parameters, score, Fisher information) of a model that has this one's
        prediction: the same terms, or one more at its null.

        held : names of terms whose parameters rest."""
        parameters = [one for one in free_parameters(model) if one[0] not in held]
        if not parameters:
            return parameters, np.zeros(0), np.zeros((0, 0))

        own = tuple(p for p in parameters if self.model.term(p[0]) is not None)
        others = [p for p in parameters if p not in own]
        order = [(*own, *others).index(p) for p in parameters]

        def one(pair: tuple[_State, Frame]) -> tuple[Array, Array]:
            state, frame = pair
            known = self._own_design(state, frame, own, model)
            more = self._design(state, frame, others, model)
            right = _scores(state, frame)
            score = np.concatenate([known.scores(*right), more.scores(*right)])
            across = known.products(more)
            information = [[known.information, across], [across.T, more.information]]
            return score, np.block(information)

        pairs = list(zip(self._states, self.likelihood.frames, strict=True))
        parts = self.likelihood.workers.map(one, pairs)
        score = np.sum([part[0] for part in parts], 0)[order]
        information = np.sum([part[1] for part in parts], 0)[np.ix_(order, order)]
        return parameters, score, information

    def score_sums(self, labels: PixelLabels, step: Array) -> list[Array]:
        """Return, of every frame, the scores (n, count) of the model's free parameters
        after a step (n,) of these, summed over the pixels of each label.

        labels : returns (labels (T, h, w) of a frame's pixels, their count)."""
        own = tuple(free_parameters(self.model))

        def one(pair: tuple[_State, Frame]) -> Array:
            state, frame = pair
            design = self._own_design(state, frame, own, self.model)
            moved = design.after(*_scores(state, frame), step)
            return design.sums_by_label(*counted_labels(frame, labels), *moved)

        pairs = list(zip(self._states, self.likelihood.frames, strict=True))
        return self.likelihood.workers.map(one, pairs)

    def _own_design(
        self, state: _State, frame: Frame, own: tuple[Parameter, ...], model: Model
    ) -> Design:
        """Return the derivatives by parameters of the model itself, which stay."""
        if state.own is None or state.own[0] != own:
            state.own = own, self._design(state, frame, own, model)
        return state.own[1]

    def _design(
        self, state: _State, frame: Frame, of: Sequence[Parameter], model: Model
    ) -> Design:
        known: dict[Parameter, Derivatives] = {}
        rows: list[Derivatives] = []
        for name, index in of:
            term = model.term(name)
            assert term is not None
            if term.effect.acts_on_light and not frame.capture.shows.light:
                rows.append((None, None))
                continue
            alike = term.effect.in_proportion(term.effect.parameters[index], frame)
            other = (name, term.effect.parameters.index(alike[0])) if alike else None
            if alike and other in known:
                known[name, index] = scaled(known[other], alike[1])
            else:
                known[name, index] = _derivatives(state, frame, index, term, model)
            rows.append(self._standardised(state, frame, known[name, index]))
        return Design.of(rows, int(frame.counted.sum()))


def counted_labels(frame: Frame, labels: PixelLabels) -> tuple[NDArray[np.intp], int]:
    """Return (labels (N,) of the pixels of a frame that count, how many there are)."""
    of_pixels, count = labels(frame)
    return np.broadcast_to(of_pixels, frame.signal.shape)[frame.counted], count


def _scores(state: _State, frame: Frame) -> tuple[Rows, Rows]:
    """Return the scores (N,) of mean and variance of the pixels that count."""
    images = (state.residual, state.square)
    mean, variance = (image[frame.counted].astype(np.float32) for image in images)
    return mean, variance


def _derivatives(
    state: _State, frame: Frame, index: int, term: Term, model: Model
) -> Derivatives:
    """Return derivatives of mean and variance by a value of a term."""
    step = term.effect.steps[index]
    values = term.values.copy()
    if values[index] + step > term.effect.high[index]:
        step = -step
    values[index] += step
    moved = model.with_values(term.name, values)
    return scaled(_moved_by(state, frame, term.effect, moved), 1 / step)


def _moved_by(state: _State, frame: Frame, effect: Effect, model: Model) -> Derivatives:
    """Return how far mean and variance of a frame move to those of a model with another
    value of an effect.

    Of an effect that moves the mean only that counts: a variance that is a percent off
    would else decide a mean of which a nuisance leaves little."""
    p = state.prediction
    late = registered(effect.cfa)[effect.name]["stage"] == "readout"
    if effect.moves_mean and (effect.acts_on_light or late or effect.needs == TIME):
        # In pixels that a full well does not hide.
        mean = mean_of(model, frame) - state.mean
        return mean * (1.0 if late else p.below), None
    moved = predict(model, frame)
    mean = moved.mean - p.mean
    if effect.moves_mean:
        return mean, None
    return mean if mean.any() else None, moved.variance - p.variance


def free_parameters(model: Model) -> list[Parameter]:
    """Return what Fisher scoring moves."""
    return [
        (term.name, index)
        for term in model.terms
        if term.effect.scored
        for index, name in enumerate(term.effect.parameters)
        if name in term.effect.used
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
    told = eigenvalues > LEAST_CORRELATED
    along = (vectors.T @ (score / scale)) / np.where(told, eigenvalues, np.inf)
    step = vectors @ along
    return step / scale, 0.5 * float(step @ (score / scale))


def moved(model: Model, parameters: Sequence[Parameter], step: Array) -> Model:
    """Return the model with parameters moved, each within its bounds."""
    values = {term.name: term.values.copy() for term in model.terms}
    for (name, index), delta in zip(parameters, step, strict=True):
        values[name][index] += delta
    for term in model.terms:
        bounded = _bounded(model, term, values[term.name])
        model = model.with_values(term.name, bounded)
    return model


def _bounded(model: Model, term: Term, values: Array) -> Array:
    """Return values within the bounds of the search and, together with what the profile
    has, within those of the registry."""
    effect = term.effect
    clipped = effect.clipped(values)
    if effect.search or not effect.predicted:
        return clipped
    listed = model.profile_parameters.get(term.name)
    old = effect.null if listed is None else np.array(list(listed.values()), float)
    return effect.within_registry_bounds(old + clipped) - old


def one_step(
    model: Model, base: Linearisation, current: float, held: Collection[str] = ()
) -> tuple[Model, float]:
    """Return (model after one damped step, actual gain in nats).

    held : names of terms that rest."""
    parameters, score, information = base.system(model, held)
    if not parameters:
        return model, 0.0
    step, promised = solve(score, information)
    best = (model, 0.0)
    for share in (FULL_STEP, *SHORTER_STEPS):
        trial = moved(model, parameters, share * step)
        gain = base.likelihood.total(trial) - current
        if gain > best[1]:
            best = (trial, gain)
        if gain > 0 and (gain > KEPT_PROMISE * promised or share < FULL_STEP):
            break
    return best
