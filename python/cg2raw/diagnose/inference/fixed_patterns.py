# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Fixed patterns: maps of the sensor, by empirical Bayes from the fit frames.

A map is no free parameter: its prior's variance is estimated from the pixels together,
and the map is the posterior mean. What is uncertain of it goes into the variance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.optimize import brentq
from scipy.special import ndtr

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, Mask, Tiling
from cg2raw.diagnose.inference.sparse_map import LEAST_INFORMATION, fit_sparse_map
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import predict

SMOOTH = 5  # pixels of one colour; a slower map is shading, and not of the pixels
KEPT = 1 - 3 / (4 * np.pi * SMOOTH**2)  # of white noise's variance, by the high pass
HUBER_BOUND = 2.5  # standard deviations that a pixel counts for in the prior
LONGEST_TAIL = 6.0
LEAST_KNOWN = 1e-6  # of the best pixel's information; a pixel with less is not known


def fit_patterns(model: Model, likelihood: Likelihood) -> Model:
    """Return the model with the maps of all its fixed patterns estimated."""
    for term in model.terms:
        if isinstance(term.effect, FixedPattern):
            rest = model.without(term.name)
            model = model.with_term(_fitted(term, term.effect, rest, likelihood))
    return model


@dataclass(frozen=True)
class _Evidence:
    """What frames say about a map, (T, h, w): information (its inverse is the variance
    of an estimate), score (information times estimate). known : pixels that any frame
    says anything about."""

    information: Array
    score: Array
    known: Mask

    @property
    def estimate(self) -> Array:
        return np.where(self.known, self.score / self.information, 0)


def _fitted(
    term: Term, effect: FixedPattern, rest: Model, likelihood: Likelihood
) -> Term:
    """Weighted least squares per pixel, then shrinkage."""
    chosen = likelihood.of(_of_common_shape(likelihood.frames))
    if effect.layout == "sparse":
        return fit_sparse_map(term, effect, rest, chosen)
    evidence = _evidence(effect, rest, chosen)
    if effect.layout == "columns":
        return _columns(term, evidence, chosen.frames[0].tiles)
    return _pixels(term, evidence)


def _evidence(effect: FixedPattern, rest: Model, likelihood: Likelihood) -> _Evidence:
    def of_frame(frame: Frame) -> tuple[Array, Array]:
        p = predict(rest, frame)
        sensitivity = effect.sensitivity(frame, np.maximum(p.exposed, 0))
        z, _, weight = scores(p, frame)
        weight = np.where(frame.keep & ~frame.at_white, weight, 0)
        spread = np.sqrt(p.variance)
        return (sensitivity * weight / spread) ** 2, sensitivity / spread * weight * z

    information, score = np.zeros((2, *likelihood.frames[0].signal.shape))
    for part in likelihood.each(of_frame):
        information += part[0]
        score += part[1]
    known = information > max(LEAST_KNOWN * information.max(), LEAST_INFORMATION)
    information = np.where(known, information, LEAST_INFORMATION)
    return _Evidence(information, score, known)


def _of_common_shape(frames: Sequence[Frame]) -> list[Frame]:
    """Return the frames of the shape of most pixels: masked borders have their own."""
    pixels: dict[tuple[int, ...], int] = {}
    for frame in frames:
        shape = frame.signal.shape
        pixels[shape] = pixels.get(shape, 0) + int(frame.keep.sum())
    most = max(pixels, key=lambda shape: pixels[shape])
    return [frame for frame in frames if frame.signal.shape == most]


def _high_pass(image: Array, known: Mask) -> Array:
    """What is left of each CFA site's plane without its smooth part, where known."""
    rest = np.zeros_like(image)
    for site in ((row, col) for row in (0, 1) for col in (0, 1)):
        at = np.s_[:, site[0] :: 2, site[1] :: 2]
        width = (0, SMOOTH, SMOOTH)
        weight = gaussian_filter(known[at].astype(float), width)
        slow = gaussian_filter(np.where(known[at], image[at], 0), width)
        rest[at] = image[at] - slow / np.maximum(weight, 1e-9)
    return np.where(known, rest, 0)


def _prior(square: Array, error: Array) -> float:
    """Return the variance of a map from squares of estimates and their errors.

    Each square counts at most HUBER_BOUND**2 times its variance: a few pixels that are
    hot, or wrong, are no map. Source: P. J. Huber, Ann. Math. Stat. 35(1), 1964,
    proposal 2."""
    if not square.size:
        return 0.0
    density = np.exp(-0.5 * HUBER_BOUND**2) / np.sqrt(2 * np.pi)
    beyond = ndtr(-HUBER_BOUND)
    expected = 1 - 2 * beyond - 2 * HUBER_BOUND * density + 2 * HUBER_BOUND**2 * beyond

    def excess(prior: float) -> float:
        scaled = square / (error + prior)
        return float(np.minimum(scaled, HUBER_BOUND**2).mean() - expected)

    high = float(square.mean()) + 1e-30
    if excess(0.0) <= 0:
        return 0.0
    while excess(high) > 0:
        high *= 2
    return float(brentq(excess, 0.0, high, rtol=1e-6, xtol=1e-30))


def _pixels(term: Term, evidence: _Evidence) -> Term:
    known, error = evidence.known, 1 / evidence.information
    estimate = _high_pass(evidence.estimate, known)
    square, of_known = (estimate**2)[known] / KEPT, error[known]
    prior = _prior(square, of_known)
    # A map with long tails: half of what they add.
    bounded = np.minimum(square, LONGEST_TAIL**2 * (of_known + prior))
    weight = 1 / (of_known + prior + 1e-300)
    mean = ((bounded - of_known) * weight).sum() / max(weight.sum(), 1e-300)
    prior = max(prior, 0.5 * float(mean))
    share = prior / (prior + error)
    sensor_map = SensorMap(estimate * share, np.where(known, error * share, prior))
    return replace(term, values=np.array([np.sqrt(prior)]), sensor_map=sensor_map)


def _columns(term: Term, evidence: _Evidence, tiles: Tiling) -> Term:
    """One offset per column of the frame."""
    a = tiles.over_columns(np.where(evidence.known, evidence.information, 0))
    b = tiles.over_columns(np.where(evidence.known, evidence.score, 0))
    used = a > 0
    estimate = np.where(used, b / np.maximum(a, LEAST_INFORMATION), 0)
    error = 1 / np.maximum(a, LEAST_INFORMATION)
    prior = _prior((estimate**2)[used], error[used])
    share = prior / (prior + error)
    shape = evidence.known.shape
    sensor_map = SensorMap(
        np.broadcast_to(estimate * share, shape),
        np.broadcast_to(np.where(used, error * share, prior), shape),
    )
    return replace(term, values=np.array([np.sqrt(prior)]), sensor_map=sensor_map)
