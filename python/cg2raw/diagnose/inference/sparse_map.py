# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sparse map: which pixels leak charge, how fast, and with which certainty.

A few pixels leak at rates of an exponential law, the others do not leak: a spike and a
slab, whose share and mean rate are found by expectation and maximisation. Source: A. P.
Dempster, N. M. Laird, D. B. Rubin, J. R. Stat. Soc. B 39(1), 1977.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from cg2raw.diagnose.effects.base import Predicted, SensorMap
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.rate_law import RateLaw
from cg2raw.diagnose.effects.sensor_map import BeyondLaw
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference import exponential_rates
from cg2raw.diagnose.inference.map_evidence import (
    LEAST_INFORMATION,
    told_by_darks,
    unseen_by,
)
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.jumps import predict_for_means
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import photon_gain, shot_noise_left_out
from cg2raw.diagnose.likelihood.tails import tails_of

STANDS_OUT = 3.0  # standard deviations above the others that a pixel must lie
UNLIKELY = 0.02  # probability below which a pixel counts as any other
EM_ROUNDS = 30  # of expectation and maximisation
CLOSE = 1e-3  # relative change of the share that ends them
MOST_CHI_SQUARE = 6.0  # standard deviations of chi-square between frames
MISFIT = 0.02  # of the evidence, which the model of light may be wrong by


@dataclass(frozen=True)
class _Leak:
    """Of every pixel, (T, h, w): rate, its standard deviation, and how far the frames
    contradict each other: chi-square and its degrees of freedom."""

    rate: Array
    deviation: Array
    known: Mask
    chi2: Array
    freedom: Array

    @property
    def agreed(self) -> Mask:
        """Where the frames agree on one rate, which an outlier in one does not."""
        freedom = np.maximum(self.freedom, 1)
        most = freedom + MOST_CHI_SQUARE * np.sqrt(2 * freedom)
        agreed: Mask = self.chi2 < most + MISFIT * (self.rate / self.deviation) ** 2
        return agreed


def fit_sparse_map(
    term: Term, effect: FixedPattern, rest: Model, likelihood: Likelihood
) -> Term:
    """Return the term with its map: rates in signal per second, 0 of most pixels.

    Of a log-normal map whose law says which pixels are hot beyond it, these are the
    map. rest : all but this term. likelihood : of frames of one shape."""
    shape = likelihood.frames[0].signal.shape
    unseen = unseen_by(likelihood.frames)
    if (beyond := _beyond_law(rest, shape)) is not None:
        term = replace(term, contradicted=beyond.lost)
        parts = beyond.chance, beyond.mean, beyond.variance
        return _with_map(term, *parts, ~unseen, unseen)
    predictions = likelihood.each(lambda frame: predict_for_means(rest, frame))
    predicted = list(zip(likelihood.frames, predictions, strict=True))
    if told_by_darks(effect, likelihood.frames):
        predicted = [one for one in predicted if not one[0].capture.shows.light]
    cold = np.zeros(shape)
    first = _leak(effect, rest, predicted, cold)
    leak = _leak(effect, rest, predicted, np.maximum(first.rate, 0))
    if not leak.known.any():
        return replace(term, values=np.zeros(1), sensor_map=SensorMap(cold, cold))
    hot, rate, variance = _posterior(leak, first, tails_of(rest, likelihood.frames[0]))
    mean = hot * rate
    doubt = hot * (variance + rate**2) - mean**2
    return _with_map(term, hot, mean, doubt, leak.known, unseen)


def _beyond_law(rest: Model, shape: tuple[int, ...]) -> BeyondLaw | None:
    for _, effect, known in rest.maps:
        if effect.is_log_normal and known.mean.shape == shape:
            return known.beyond_law
    return None


def _with_map(
    term: Term, hot: Array, mean: Array, doubt: Array, known: Mask, unseen: Mask
) -> Term:
    """hot : the chance that a pixel is. mean, doubt : of its rate, hot or not."""
    total = float(hot[known].sum())
    share = total / max(int(known.sum()), 1)
    law = None
    if share > 0:
        law = RateLaw.of_few(share, float(mean[known].sum()) / max(total, 1.0))
    sensor_map = SensorMap(mean, doubt, unknown=unseen, rate_law=law)
    return replace(term, values=np.array([share]), sensor_map=sensor_map)


def _leak(
    effect: FixedPattern, rest: Model, predicted: Predicted, rate: Array
) -> _Leak:
    """Weighted least squares per pixel; a rate brings shot noise of its own. What the
    ADC cuts at 0 is not hot."""
    information, score, squares, count, charged = np.zeros((5, *rate.shape))
    for frame, p in predicted:
        sensitivity = effect.sensitivity(frame, np.maximum(p.exposed, 0))
        used = frame.keep & ~frame.at_white
        variance = p.variance + shot_noise_left_out(rest, frame, p)
        variance = variance + photon_gain(rest, frame) * sensitivity * rate
        z, _, weight = scores(replace(p, variance=variance), frame)
        slope = used * weight * sensitivity / np.sqrt(variance)
        information += slope**2
        score += slope * z
        squares += used * z**2
        count += used
        charged += used * (sensitivity > 0)
    known = information > LEAST_INFORMATION
    information = np.where(known, information, 1.0)
    found = np.where(known, score / information, 0.0)
    # One frame's rate nothing contradicts: a hot pixel leaves offsets in biases.
    chi2 = np.where(charged > 1, squares - found**2 * information, 0)
    deviation = 1 / np.sqrt(information)
    middle = np.median(found[known]) if known.any() else 0.0
    z = np.where(known, (found - middle) / deviation, 0.0)
    spread = 1.4826 * np.median(np.abs(z[known])) if known.any() else 1.0
    return _Leak(found - middle, deviation * max(1.0, spread), known, chi2, count - 1)


def _posterior(
    leak: _Leak, cold: _Leak, tails: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Return (probability to be hot, rate if hot, its variance) of every pixel.

    leak, cold : with and without the shot noise of the rate."""
    z = np.where(leak.known & leak.agreed, cold.rate / cold.deviation, 0.0)
    likely = z > STANDS_OUT
    hot, rate, variance = np.zeros((3, *z.shape))
    if not likely.any():
        return hot, rate, variance
    e, s, narrow = leak.rate[likely], leak.deviation[likely], cold.deviation[likely]
    spike = np.logaddexp(
        np.log1p(-tails[0]) + _log_normal(e, narrow),
        np.log(tails[0] + 1e-300) + _log_normal(e, narrow * np.sqrt(tails[1])),
    )
    pixels = int(leak.known.sum())
    share, mean = max(likely.sum(), 1) / pixels, float(e.mean())
    probability = np.zeros(e.shape)
    for _ in range(EM_ROUNDS):
        mean_rate = mean
        slab = exponential_rates.log_density(e, s, mean_rate)
        odds = np.log(share) - np.log1p(-min(share, 0.5)) + slab - spike
        probability = expit(odds)
        before, share = share, max(float(probability.sum()) / pixels, 1e-12)
        mean = float((probability * e).sum() / max(float(probability.sum()), 1e-12))
        if abs(share - before) < CLOSE * before:
            break
    rate[likely], variance[likely] = exponential_rates.posterior(e, s, mean_rate)
    hot[likely] = np.where(probability > UNLIKELY, probability, 0.0)
    return hot, rate, variance


def _log_normal(x: Array, deviation: Array) -> Array:
    size = np.sqrt(2 * np.pi) * deviation
    density: Array = -0.5 * (x / deviation) ** 2 - np.log(size)
    return density
