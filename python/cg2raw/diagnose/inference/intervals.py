# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Intervals of what was fitted."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.fisher_scoring import information_of
from cg2raw.diagnose.likelihood.likelihood import Workers, total
from cg2raw.diagnose.likelihood.prediction import Model, Term

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
        if (term.name, 0) in errors:
            continue
        if term.pattern is not None:
            errors[term.name, 0] = _error_of_prior(term)
            continue
        of_term = _errors_by_likelihood(model, term, frames, workers)
        errors.update({(term.name, i): e for i, e in enumerate(of_term)})
    return errors


def _error_of_prior(term: Term) -> float:
    """Of a map's standard deviation, from its pixels' number and what is known of each;
    of a share of pixels, from their number."""
    assert term.pattern is not None
    value, count = float(term.values[0]), term.pattern.mean.size
    if term.name == "column_noise":
        count = term.pattern.mean[:, 0].size
    if term.name == "hot_pixels":
        return float(np.sqrt(max(value * (1 - value), 1 / count) / count))
    prior = max(value, 1e-12) ** 2
    share = min(max(1 - float(np.mean(term.pattern.variance)) / prior, 1e-3), 1.0)
    return float(value / np.sqrt(2 * count) / share)


def _errors_by_likelihood(
    model: Model, term: Term, frames: Sequence[Frame], workers: Workers
) -> list[float]:
    """Errors of a flow's values from the bend of the likelihood in all of them."""
    low, high = term.candidate.low, term.candidate.high
    steps = np.maximum(0.1 * np.abs(term.values), 1e-3)
    steps = np.minimum(steps, (high - low) / 4)
    centre = np.clip(term.values, low + steps, high - steps)

    def height(shift: NDArray[np.float64]) -> float:
        values = centre + shift * steps
        return total(model.with_values(term.name, values), frames, workers)

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
    values, vectors = np.linalg.eigh(bend)
    if values[0] <= 0:
        return [float(max(abs(value), 1e-3)) for value in term.values]
    spread = np.sqrt(np.diag(vectors / values @ vectors.T))
    return [float(error) for error in spread * steps]


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
            interval = (value - half, value + half)
            if term.name == "hot_pixels":
                interval = _of_share(term)
            of_term[name] = Estimate(value, unit, interval)
        result[term.name] = of_term
    return result


def _of_share(term: Term) -> tuple[float, float]:
    """Return the 95 % interval of a share of few pixels: their number is Poisson's.

    Source: F. Garwood, Biometrika 28(3/4), 1936."""
    assert term.pattern is not None
    pixels = term.pattern.mean.size
    count = float(term.values[0]) * pixels
    low = 0.5 * chi2.ppf(0.025, 2 * count) if count > 0 else 0.0
    return float(low / pixels), float(0.5 * chi2.ppf(0.975, 2 * count + 2) / pixels)


def scale_of(name: str, frames: Sequence[Frame]) -> float:
    """Return what turns a value of the search into the registry's unit."""
    if name != "row_noise" or not frames:
        return 1.0
    return float(np.sqrt(np.mean([frame.beta2.mean() for frame in frames])))
