# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Confidence intervals of fitted values."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import NORMAL_95, Estimates, EstimatesByEffect
from cg2raw.diagnose.inference.fisher_scoring import (
    Linearisation,
    Parameter,
)
from cg2raw.diagnose.inference.robust_errors import (
    Covariances,
    covariances,
    inverse_of,
)
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

LARGEST_LOG = 20.0  # of the factor that a strength is known to


def standard_errors(
    model: Model, likelihood: Likelihood
) -> dict[tuple[str, int], float]:
    """Return the standard error of every value of a model's terms."""
    parameters, _, information = Linearisation(model, likelihood).system(model)
    return _standard_errors(model, likelihood, parameters, information)


def _standard_errors(
    model: Model,
    likelihood: Likelihood,
    parameters: Sequence[Parameter],
    information: NDArray[np.float64],
) -> dict[Parameter, float]:
    errors = dict(zip(parameters, _errors(information), strict=True))
    for (name, index), told in zip(parameters, np.diag(information), strict=True):
        term = model.term(name)
        if term is not None and told <= 0:  # the frames say nothing: anything goes
            errors[name, index] = float(
                np.ptp([term.effect.low, term.effect.high], 0)[index]
            )
    for term in model.terms:
        if (term.name, 0) not in errors:
            of_term = _errors_by_likelihood(model, term, likelihood)
            errors.update({(term.name, i): e for i, e in enumerate(of_term)})
    return errors


def _errors_of_shape(
    term: Term, parameters: Sequence[Parameter], information: NDArray[np.float64]
) -> dict[str, float]:
    """Return the standard errors of a term's values while its shape is what it is.

    Where something of it fades, and how far, may be hardly known: how strong it is at
    that place is then as unsure, and that it is there is not."""
    names = [
        term.effect.parameters[index] if name == term.name else ""
        for name, index in parameters
    ]
    free = [i for i, name in enumerate(names) if name not in term.effect.shape_of]
    errors = _errors(information[np.ix_(free, free)])
    return {names[i]: e for i, e in zip(free, errors, strict=True) if names[i]}


def _errors(information: NDArray[np.float64]) -> list[float]:
    """Return standard errors from Fisher's information."""
    spread = np.sqrt(np.maximum(np.diag(inverse_of(information)), 0))
    return [float(error) for error in spread]


def _errors_by_likelihood(
    model: Model, term: Term, likelihood: Likelihood
) -> list[float]:
    """Errors of a transform's values from the bend of the likelihood in all of them;
    of their logarithms, if it does not bend down in these: of shares and ratios the
    likelihood is skewed."""
    low, high = term.effect.low, term.effect.high
    steps = np.maximum(0.1 * np.abs(term.values), 1e-3)
    steps = np.minimum(steps, (high - low) / 4)
    centre = np.clip(term.values, low + steps, high - steps)

    def height(shift: NDArray[np.float64]) -> float:
        return likelihood.total(model.with_values(term.name, centre + shift * steps))

    axes = np.eye(len(steps))
    bend = np.zeros((len(steps), len(steps)))
    middle = height(0 * steps)
    ends = [(height(axis), height(-axis)) for axis in axes]
    for i, (above, below) in enumerate(ends):
        bend[i, i] = 2 * middle - above - below
        for j in range(i):
            both = height(axes[i] + axes[j]) + height(-axes[i] - axes[j])
            both -= above + below + sum(ends[j]) - 2 * middle
            bend[i, j] = bend[j, i] = -0.5 * both
    errors = _spread(bend)
    if errors is not None:
        return [float(error) for error in errors * steps]
    slope = np.array([(above - below) / 2 for above, below in ends])
    of_logs = centre / steps
    errors = _spread(bend * np.outer(of_logs, of_logs) - np.diag(slope * of_logs))
    if errors is None or not (centre > 0).all():
        return [float(max(abs(value), 1e-3)) for value in term.values]
    return [float(error) for error in errors * centre]


def _spread(bend: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return standard errors of what a likelihood bends in; None if not downwards."""
    values, vectors = np.linalg.eigh(bend)
    if values[0] <= 0:
        return None
    spread: NDArray[np.float64] = np.sqrt(np.diag(vectors / values @ vectors.T))
    return spread


def estimates(model: Model, likelihood: Likelihood) -> EstimatesByEffect:
    """Return the values of every term with their intervals, in the registry's units:
    as wide as noise makes them, or what frames show that no effect describes."""
    base = Linearisation(model, likelihood)
    parameters, score, information = base.system(model)
    errors = _standard_errors(model, likelihood, parameters, information)
    found = covariances(base, score, information).errors
    for one, error in zip(parameters, found, strict=True):
        errors[one] = max(errors[one], float(error))
    result: dict[str, Estimates] = {}
    for term in model.terms:
        scale = term.effect.unit_scale(likelihood.frames)
        of_shape = _errors_of_shape(term, parameters, information)
        of_term = {}
        for index, (name, unit) in enumerate(
            zip(term.effect.parameters, term.effect.units, strict=True)
        ):
            if name not in term.effect.used:
                continue
            error = errors[term.name, index]
            low, high = _interval(term, index, error, of_shape)
            value = float(term.values[index]) * scale
            of_term[name] = Estimate(value, unit, (low * scale, high * scale))
        result[term.name] = of_term
    return result


@dataclass(frozen=True)
class SmoothValues:
    """The smooth values of a model, (name of a term, index), and their covariances."""

    model: Model
    parameters: Sequence[Parameter]
    covariances: Covariances

    @classmethod
    def of(cls, model: Model, likelihood: Likelihood) -> "SmoothValues":
        base = Linearisation(model, likelihood)
        parameters, score, information = base.system(model)
        return cls(model, parameters, covariances(base, score, information))

    def widening(self, name: str) -> float:
        """Return how much larger than by noise squares of distances of a term's values
        are, all of them together; 1 of a term without any."""
        return self.covariances.widening_of_all(
            [number for number, (of, _) in enumerate(self.parameters) if of == name]
        )

    def square_of_distance(self, name: str, used: Collection[str]) -> float:
        """Return how far the values of a term that are used are from 0, all of them
        together, in standard errors, squared: of n whose truth is 0, it is of the
        chi-square of n. Source: A. Wald, Trans. Am. Math. Soc. 54(3), 1943."""
        term = self.model.term(name)
        assert term is not None
        own = [
            number
            for number, (of, index) in enumerate(self.parameters)
            if of == name and term.effect.parameters[index] in used
        ]
        values = term.values[[self.parameters[number][1] for number in own]]
        told = inverse_of(self.covariances.by_noise[np.ix_(own, own)])
        widening = self.covariances.widening_of_all(own)
        return float(values @ told @ values) / widening


def _interval(
    term: Term, index: int, error: float, of_shape: Mapping[str, float]
) -> tuple[float, float]:
    """Return the interval of a value. of_shape : as of _errors_of_shape."""
    name, value = term.effect.parameters[index], float(term.values[index])
    half = NORMAL_95 * error
    if abs(value) < half and name in term.effect.shape_of.values():
        if NORMAL_95 * of_shape[name] < abs(value):
            return _to_a_factor(value, half)
    return value - half, value + half


def _to_a_factor(value: float, half: float) -> tuple[float, float]:
    """Return the interval of what is not 0, and known to a factor."""
    factor = float(np.exp(min(half / abs(value), LARGEST_LOG)))
    low, high = sorted((value / factor, value * factor))
    return low, high
