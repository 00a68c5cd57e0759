# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Variance map: which pixels jump from frame to frame, and how far.

A few pixels jump between two levels by steps of an exponential law, the others do not.
Of each pixel, the frames' residuals beside its own mean say how likely every step is;
share and mean of the steps are found by expectation and maximisation. Read noise with
long tails leaves pixels of which a frame or two are far out: as likely as that is, they
do not jump. Source: A. P. Dempster, N. M. Laird, D. B. Rubin, J. R. Stat. Soc. B 39(1),
1977.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit, logsumexp
from scipy.stats import chi2

from cg2raw.diagnose.effects.base import Predicted, SensorMap
from cg2raw.diagnose.effects.mixture import harmonic_variance, log_odds
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.map_prior import prior_of
from cg2raw.diagnose.inference.sparse_map import CLOSE, EM_ROUNDS
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import shot_noise_left_out
from cg2raw.diagnose.likelihood.tails import LEAST_CORE, tails_in

FEWEST_FRAMES = 3  # of a pixel, for what is left of them beside its mean
JUMPS_WEIGHED = 24  # of a jump that are weighed
SHORTEST_JUMP, LONGEST_JUMP = 0.7, 200.0  # of them, in noises of a dim frame
FIRST_SHARE, FIRST_STEP = 0.01, 6.0
RAREST_JUMPS = 1e-7
LARGEST_LOG_RATIO = 300.0
ROUNDS_OF_MEAN = 4  # from the median
NO_ERROR = 1e-9  # of variances that are 1


@dataclass(frozen=True)
class _Group:
    """Of frames of one light, (T, h, w): noise variance, and of their residuals the
    number, sum and sum of squares.

    wider : what the variance of a residual of the noise's tail is more. outlying :
    chance of one. residuals : of every frame, NaN where it does not count, if noise
    has tails."""

    variance: Array
    count: Array
    total: Array
    squares: Array
    wider: Array
    outlying: float = 0.0
    residuals: tuple[Array, ...] = ()

    @property
    def inflation(self) -> float:
        """What makes most pixels as noisy as they are about their own mean: noise that
        all have more of is no jump. 1 where frames do not repeat each other."""
        repeated = self.count > 1
        if not repeated.any():
            return 1.0
        count, total = self.count[repeated], self.total[repeated]
        about_mean = self.squares[repeated] - total**2 / count
        scaled = about_mean / (count - 1) / self.variance[repeated]
        return prior_of(scaled, np.full_like(scaled, NO_ERROR)) or 1.0

    def inflated(self, factor: float) -> "_Group":
        variance, wider = factor * self.variance, factor * self.wider
        return replace(self, variance=variance, wider=wider)


def fit_variance_map(term: Term, rest: Model, likelihood: Likelihood) -> Term:
    """Return the term with its map: the chance that a pixel jumps, and the variance
    that this adds to it on average. If it has a map already, half of that stays: a
    pixel that maps of means and this one explain by turns settles between them.

    rest : all but this term. likelihood : of frames of one shape."""
    groups = list(_groups(likelihood.predicted(rest), rest))
    none = np.zeros(likelihood.frames[0].signal.shape)
    count = np.sum([group.count for group in groups], 0)
    known = count >= FEWEST_FRAMES
    if not known.any():
        nothing = SensorMap(none, none, chance=none)
        return replace(term, values=np.zeros(2), sensor_map=nothing)
    groups = [group.inflated(group.inflation) for group in groups]
    inflation = _inflation(groups, count, known)
    groups = [group.inflated(inflation) for group in groups]
    noise = float(np.sqrt(min(np.median(g.variance[known]) for g in groups)))
    steps = noise * np.geomspace(SHORTEST_JUMP, LONGEST_JUMP, JUMPS_WEIGHED)
    jumps = [_sums(groups, known, (d / 2) ** 2).log_likelihood for d in steps]
    logs = np.array(jumps) - _without_jumps(groups, known)
    values, chances = _posterior(logs, steps, noise)
    # Of a pixel that no frames tell of, what is known of all.
    extra = np.full(none.shape, values[0] * values[1] ** 2 / 2)
    chance = np.full(none.shape, values[0])
    extra[known], chance[known] = (steps / 2) ** 2 @ chances, chances.sum(0)
    if (before := term.map_of(extra.shape)) is not None:
        extra, chance = (extra + before.mean) / 2, (chance + before.share) / 2
    sensor_map = SensorMap(extra, none, chance=chance)
    return replace(term, values=values, sensor_map=sensor_map)


def _groups(predicted: Predicted, rest: Model) -> Iterable[_Group]:
    """Yield the frames of each set together: their variances are nearly the same."""
    sets: dict[tuple[str, float], list[int]] = {}
    for number, (frame, _) in enumerate(predicted):
        key = (frame.capture.set, frame.seconds)
        sets.setdefault(key, []).append(number)
    for numbers in sets.values():
        yield _group([predicted[number] for number in numbers], rest)


def _group(predicted: Predicted, rest: Model) -> _Group:
    variance, count, total, squares, wider = np.zeros((5, *predicted[0][1].mean.shape))
    outlying = 0.0
    residuals = []
    for frame, p in predicted:
        used = frame.keep & ~frame.censored
        residual = np.where(used, frame.signal - p.mean, 0)
        tails = tails_in(rest, frame, p)
        own = p.variance if tails is None else tails.narrow
        of_charge = shot_noise_left_out(rest, frame, p)
        variance += np.maximum(own + of_charge, LEAST_CORE * own)
        count += used
        total += residual
        squares += residual**2
        if tails is not None:
            outlying = tails.outlying
            wider += tails.wide - tails.narrow
            residuals.append(np.where(used, residual, np.nan).astype(np.float32))
    frames = len(predicted)
    variance, wider = variance / frames, wider / frames
    return _Group(variance, count, total, squares, wider, outlying, tuple(residuals))


@dataclass(frozen=True)
class _Sums:
    """Of a pixel's residuals: chi-square, log of the product of their variances,
    weight of their mean, and weight times mean."""

    chi: Array
    logs: Array
    weight: Array
    pull: Array

    @property
    def chi_beside_mean(self) -> Array:
        return self.chi - self.pull**2 / self.weight

    @property
    def log_likelihood(self) -> Array:
        """Whatever the mean is."""
        return -0.5 * (self.chi_beside_mean + self.logs + np.log(self.weight))


def _sums(groups: Iterable[_Group], known: Mask, extra: float) -> _Sums:
    """extra : is added to variances."""
    chi, logs, weight, pull = np.zeros((4, int(known.sum())))
    for group in groups:
        variance, count = group.variance[known] + extra, group.count[known]
        weight += count / variance
        pull += group.total[known] / variance
        chi += group.squares[known] / variance
        logs += count * np.log(variance)
    return _Sums(chi, logs, weight, pull)


def _inflation(groups: Iterable[_Group], count: Array, known: Mask) -> float:
    """Return the same of frames of all groups, for the median pixel, 1 at least: what
    is wrong with the light of one is no jump."""
    chi = _sums(groups, known, 0.0).chi_beside_mean
    expected = chi2.ppf(0.5, count[known] - 1)
    return max(1.0, float(np.median(chi / expected)))


def _without_jumps(groups: Sequence[_Group], known: Mask) -> Array:
    """Return the log likelihood of each known pixel that does not jump, whatever its
    mean is. Where noise has tails, the most likely mean stands for all (P. S. Laplace's
    method), by expectation and maximisation."""
    tailed = [group for group in groups if group.residuals]
    if not tailed:
        return _sums(groups, known, 0.0).log_likelihood
    mean = np.nanmedian([r[known] for g in tailed for r in g.residuals], axis=0)
    for _ in range(ROUNDS_OF_MEAN):
        weight, pull, log = np.zeros((3, mean.size))
        for group in tailed:
            variance, wider = group.variance[known], group.wider[known]
            for residual in (each[known] for each in group.residuals):
                log_density, told = _beside(residual, mean, group, variance, wider)
                log += log_density
                weight += told
                pull += told * np.nan_to_num(residual)
        weight = np.maximum(weight, 1e-300)
        mean = pull / weight
    return log - 0.5 * np.log(weight)


def _beside(
    residual: Array, mean: Array, group: _Group, variance: Array, wider: Array
) -> tuple[Array, Array]:
    """Return (log density of residuals of a frame beside a mean, by how much they tell
    it); 0 where a frame does not count.

    That none is of a tail has no chance here: it is the same of pixels that jump."""
    used = np.isfinite(residual)
    away = np.where(used, residual - mean, 0)
    narrow = -0.5 * (away**2 / variance + np.log(variance))
    odds = log_odds(away, group.outlying, variance, variance + wider)
    told = 1 / harmonic_variance(expit(odds), variance, variance + wider)
    return used * (narrow + np.logaddexp(0, odds)), used * told


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
