# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Variance map: which pixels jump from frame to frame, and how far.

A few pixels jump between two levels by steps of an exponential law, the others do not.
Of each pixel, the frames' residuals beside its own mean say how likely every step is;
share and mean of the steps are found by expectation and maximisation. Source: A. P.
Dempster, N. M. Laird, D. B. Rubin, J. R. Stat. Soc. B 39(1), 1977.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from cg2raw.diagnose.effects.base import Predicted, SensorMap
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.sparse_map import CLOSE, EM_ROUNDS
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

FEWEST_FRAMES = 3  # of a pixel, for what is left of them beside its mean
JUMPS_WEIGHED = 24  # of a jump that are weighed
SHORTEST_JUMP, LONGEST_JUMP = 0.7, 200.0  # of them, in noises of a dim frame
FIRST_SHARE, FIRST_STEP = 0.01, 6.0
RAREST_JUMPS = 1e-7
LARGEST_LOG_RATIO = 300.0


@dataclass(frozen=True)
class _Group:
    """Of frames of one light, (T, h, w): noise variance, and of their residuals the
    number, sum and sum of squares."""

    variance: Array
    count: Array
    total: Array
    squares: Array


def fit_variance_map(term: Term, rest: Model, likelihood: Likelihood) -> Term:
    """Return the term with its map: the chance that a pixel jumps, and the variance
    that this adds to it on average.

    rest : all but this term. likelihood : of frames of one shape."""
    groups = list(_groups(likelihood.predicted(rest)))
    none = np.zeros(likelihood.frames[0].signal.shape)
    count = np.sum([group.count for group in groups], 0)
    known = count >= FEWEST_FRAMES
    if not known.any():
        nothing = SensorMap(none, none, chance=none)
        return replace(term, values=np.zeros(2), sensor_map=nothing)
    inflation = _inflation(groups, count, known)
    groups = [replace(g, variance=inflation * g.variance) for g in groups]
    noise = float(np.sqrt(min(np.median(g.variance[known]) for g in groups)))
    steps = noise * np.geomspace(SHORTEST_JUMP, LONGEST_JUMP, JUMPS_WEIGHED)
    logs = np.array([_log_likelihood(groups, known, (d / 2) ** 2) for d in steps])
    logs -= _log_likelihood(groups, known, 0.0)
    values, chances = _posterior(logs, steps, noise)
    # Of a pixel that no frames tell of, what is known of all.
    extra = np.full(none.shape, values[0] * values[1] ** 2 / 2)
    chance = np.full(none.shape, values[0])
    extra[known], chance[known] = (steps / 2) ** 2 @ chances, chances.sum(0)
    sensor_map = SensorMap(extra, none, chance=chance)
    return replace(term, values=values, sensor_map=sensor_map)


def _groups(predicted: Predicted) -> Iterable[_Group]:
    """Yield the frames of each set together: their variances are nearly the same."""
    sets: dict[tuple[str, float], list[int]] = {}
    for number, (frame, _) in enumerate(predicted):
        key = (frame.capture.set, frame.seconds)
        sets.setdefault(key, []).append(number)
    for numbers in sets.values():
        variance, count, total, squares = np.zeros((4, *predicted[0][1].mean.shape))
        for frame, p in (predicted[number] for number in numbers):
            used = frame.keep & ~frame.censored
            residual = np.where(used, frame.signal - p.mean, 0)
            variance += p.variance / len(numbers)
            count += used
            total += residual
            squares += residual**2
        yield _Group(variance, count, total, squares)


def _beside_mean(
    groups: Iterable[_Group], known: Mask, extra: float
) -> tuple[Array, Array, Array]:
    """Return (chi-square of a pixel's residuals about their own mean, log of the
    product of their variances, weight of the mean); extra : is added to variances."""
    chi, logs, weight, pull = np.zeros((4, int(known.sum())))
    for group in groups:
        variance, count = group.variance[known] + extra, group.count[known]
        weight += count / variance
        pull += group.total[known] / variance
        chi += group.squares[known] / variance
        logs += count * np.log(variance)
    return chi - pull**2 / weight, logs, weight


def _inflation(groups: Iterable[_Group], count: Array, known: Mask) -> float:
    """Return what makes the median pixel as noisy as it is, 1 at least: noise that all
    pixels have more of is no jump."""
    chi = _beside_mean(groups, known, 0.0)[0]
    expected = chi2.ppf(0.5, count[known] - 1)
    return max(1.0, float(np.median(chi / expected)))


def _log_likelihood(groups: Iterable[_Group], known: Mask, extra: float) -> Array:
    """Return that of each known pixel, whatever its mean is."""
    chi, logs, weight = _beside_mean(groups, known, extra)
    log: Array = -0.5 * (chi + logs + np.log(weight))
    return log


def _posterior(logs: Array, steps: Array, noise: float) -> tuple[Array, Array]:
    """Return (share of pixels that jump and their mean step, (steps, pixels) chances
    of the steps).

    logs : (steps, pixels) log of the likelihood ratio of a step."""
    share, mean = FIRST_SHARE, FIRST_STEP * noise
    top = np.maximum(logs.max(0), 0)
    likelihood = np.exp(np.maximum(logs - top, -LARGEST_LOG_RATIO))
    none = np.exp(np.maximum(-top, -LARGEST_LOG_RATIO))
    for _ in range(EM_ROUNDS):
        prior = share * np.exp(_log_prior(steps, mean))
        slab = prior @ likelihood
        all_of_it = slab + (1 - share) * none
        of_steps = likelihood @ (1 / all_of_it) * prior
        before = share, mean
        share = max(float(of_steps.sum()) / none.size, RAREST_JUMPS)
        mean = float(of_steps @ steps) / max(float(of_steps.sum()), 1e-300)
        mean = float(np.clip(mean, steps[0], steps[-1]))
        if np.allclose((share, mean), before, rtol=CLOSE, atol=0):
            break
    return np.array([share, mean]), likelihood * prior[:, None] / all_of_it


def _log_prior(steps: Array, mean: float) -> Array:
    """Return the log of the chance of each step, even in their logarithms."""
    log = np.log(steps) - steps / mean
    prior: Array = log - logsumexp(log)
    return prior
