# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Intervals of what was fitted, and the strengths that could have been seen."""

from collections.abc import Mapping, Sequence

import numpy as np

from cg2raw.diagnose.diagnosis import Estimate, Power
from cg2raw.diagnose.fitting import Linearisation, information_of
from cg2raw.diagnose.frames import Frame
from cg2raw.diagnose.likelihood import Workers, total
from cg2raw.diagnose.prediction import Model, Term, place
from cg2raw.diagnose.vocabulary import Candidate

NORMAL_95 = 1.96


def standard_errors(
    model: Model, frames: Sequence[Frame], workers: Workers
) -> dict[tuple[str, int], float]:
    """Return the standard error of every value of a model's terms."""
    parameters, information = information_of(model, frames, workers)
    errors = {}
    if parameters:
        scale = np.sqrt(np.maximum(np.diag(information), 1e-30))
        correlation = information / np.outer(scale, scale)
        inverse = np.linalg.pinv(correlation, rcond=1e-9, hermitian=True)
        spread = np.sqrt(np.maximum(np.diag(inverse), 0)) / scale
        errors = dict(zip(parameters, map(float, spread), strict=True))
    for term in model.terms:
        for index in range(len(term.values)):
            if (term.name, index) not in errors:
                error = _error_by_likelihood(model, term, index, frames, workers)
                errors[term.name, index] = error
    return errors


def _error_by_likelihood(
    model: Model, term: Term, index: int, frames: Sequence[Frame], workers: Workers
) -> float:
    """From the bend of the likelihood; of a map's strength, from its pixels' number."""
    value = float(term.values[index])
    if term.pattern is not None:
        prior = max(value, 1e-12) ** 2
        doubt = float(np.mean(term.pattern.variance))
        share = min(max(1 - doubt / prior, 1e-3), 1.0)
        return value / np.sqrt(2 * term.pattern.mean.size) / share
    step = max(0.1 * abs(value), 1e-3)
    heights = []
    for delta in (-step, 0.0, step):
        values = term.values.copy()
        values[index] += delta
        values = term.candidate.clipped(values)
        heights.append(total(model.with_values(term.name, values), frames, workers))
    bend = (2 * heights[1] - heights[0] - heights[2]) / step**2
    return float(1 / np.sqrt(bend)) if bend > 0 else abs(value)


def estimates(
    model: Model, frames: Sequence[Frame], workers: Workers
) -> dict[str, Mapping[str, Estimate]]:
    """Return the values of every term with their intervals, in the registry's units."""
    errors = standard_errors(model, frames, workers)
    result: dict[str, Mapping[str, Estimate]] = {}
    for term in model.terms:
        scale = scale_of(term.name, frames)
        of_term = {}
        for index, (name, unit) in enumerate(
            zip(term.candidate.parameters, term.candidate.units, strict=True)
        ):
            value = float(term.values[index]) * scale
            half = NORMAL_95 * errors[term.name, index] * scale
            of_term[name] = Estimate(value, unit, (value - half, value + half))
        result[term.name] = of_term
    return result


def scale_of(name: str, frames: Sequence[Frame]) -> float:
    """Return what turns a value of the search into the registry's unit."""
    if name != "row_noise" or not frames:
        return 1.0
    return float(np.sqrt(np.mean([frame.beta2.mean() for frame in frames])))


def smallest_visible(
    model: Model,
    candidates: Sequence[Candidate],
    frames: Sequence[Frame],
    workers: Workers,
    alpha: float,
) -> list[Power]:
    """Return, for the smooth effects that were not named, the strength that would gain
    what a name has to gain."""
    base = Linearisation(model, frames, workers)
    needed = np.log(max(len(candidates), 1) / alpha)
    powers = []
    for candidate in candidates:
        if candidate.way != "smooth" or candidate.name in model.names:
            continue
        parameters, _, information = base.system(place(model, candidate))
        own = [i for i, (name, _) in enumerate(parameters) if name == candidate.name]
        strongest = max(own, key=lambda i: information[i, i])
        known = float(information[strongest, strongest])
        index = parameters[strongest][1]
        strength = (
            float(np.sqrt(2 * (needed + len(own) / 2) / known))
            if known > 1e-6
            else None
        )
        if strength is not None and strength > candidate.high[index]:
            strength = None
        powers.append(
            Power(
                candidate.name,
                candidate.parameters[index],
                strength,
                candidate.units[index],
            )
        )
    return powers
