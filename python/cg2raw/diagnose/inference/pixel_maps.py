# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Maps of pixels: offsets, rates and gains of the same pixels, estimated together.

Each map is Gaussian with a variance of its own, which all pixels together show (see
map_prior): what is known of a pixel is its posterior under these priors.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.ndimage import gaussian_filter

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.map_evidence import LEAST_INFORMATION, Evidence
from cg2raw.diagnose.inference.map_prior import bounded_tail, mixed_prior_of
from cg2raw.diagnose.likelihood.model import Term

SMOOTH = 5  # pixels of one colour; a slower map is shading, and not of the pixels
KEPT = 1 - 3 / (4 * np.pi * SMOOTH**2)  # of white noise's variance, by the high pass
MOST_TURNS = 30  # of all maps, until they agree
AGREED = 1e-3  # relative change of their deviations, from where on they do


def pixel_maps(
    terms: Sequence[Term], effects: Sequence[FixedPattern], evidence: Evidence
) -> list[Term]:
    """Return terms with their maps and the maps' standard deviations."""
    count = len(terms)
    priors = [_Prior(float(term.values[0]) ** 2) for term in terms]
    if count > 1 and not all(prior.variance for prior in priors):
        priors = [_prior(k, effects[k], evidence, None) for k in range(count)]
    for _ in range(MOST_TURNS if count > 1 else 1):
        before = [prior.variance for prior in priors]
        for k in range(count):
            priors[k] = _prior(k, effects[k], evidence, priors)
        now = [prior.variance for prior in priors]
        if np.allclose(np.sqrt(now), np.sqrt(before), rtol=AGREED, atol=0):
            break
    means = _means(effects, evidence, priors)
    covariance = _covariance(evidence, priors)
    found = []
    for k, term in enumerate(terms):
        others = {terms[i].name: covariance[k, i] for i in range(count) if i != k}
        sensor_map = SensorMap(means[k], covariance[k, k], others)
        values = np.array([np.sqrt(priors[k].variance)])
        found.append(replace(term, values=values, sensor_map=sensor_map))
    return found


@dataclass(frozen=True)
class _Prior:
    """Of a map: variance of all, and of each pixel, where a few are wide."""

    variance: float
    pixels: Array | None = None

    @property
    def each(self) -> Array | float:
        return max(self.variance, 0.0) if self.pixels is None else self.pixels


def _prior(
    one: int,
    effect: FixedPattern,
    evidence: Evidence,
    priors: Sequence[_Prior] | None,
) -> _Prior:
    """Return the prior of one map, where the others are as unsure as their priors; None
    for others that are 0."""
    known = evidence.known(one)
    information, score = _marginal(one, evidence, priors)
    information = np.where(known, np.maximum(information, LEAST_INFORMATION), 1.0)
    estimate = np.where(known, score / information, 0)
    kept = 1.0
    if effect.lacks_slow_part:
        estimate, kept = _high_pass(estimate, known, evidence.repeat), KEPT
    square, error = estimate**2 / kept, 1 / information
    of_known = square[known], error[known]
    variance = bounded_tail(*of_known)
    mixed = mixed_prior_of(*of_known) if effect.has_long_tails else None
    if mixed is None:
        return _Prior(variance)
    return _Prior(variance, np.where(known, mixed.at(square, error), variance))


def _marginal(
    one: int, evidence: Evidence, priors: Sequence[_Prior] | None
) -> tuple[Array, Array]:
    """Return (information, score) of one map, with the others integrated out."""
    information, score = evidence.information[one, one], evidence.score[one]
    others = [k for k in range(len(evidence.score)) if k != one]
    if priors is None or not others:
        return information, score
    cross = evidence.information[one, others]
    inner = _with_priors(evidence, priors, others)
    pull = np.linalg.solve(inner, np.moveaxis(cross, 0, -1)[..., None])[..., 0]
    pull = np.moveaxis(pull, -1, 0)
    return (
        information - (pull * cross).sum(0),
        score - (pull * evidence.score[others]).sum(0),
    )


def _with_priors(
    evidence: Evidence, priors: Sequence[_Prior], chosen: Sequence[int]
) -> Array:
    """Return (T, h, w, k, k) information of some maps, with that of their priors."""
    inner = np.moveaxis(evidence.information[np.ix_(chosen, chosen)], (0, 1), (-2, -1))
    inner = inner.copy()
    for place, k in enumerate(chosen):
        inner[..., place, place] += 1 / np.maximum(priors[k].each, LEAST_INFORMATION)
    return inner


def _means(
    effects: Sequence[FixedPattern], evidence: Evidence, priors: Sequence[_Prior]
) -> Array:
    """Return (K, T, h, w) posterior means: each map by what the others leave."""
    means = np.zeros_like(evidence.score)
    for _ in range(MOST_TURNS if len(effects) > 1 else 1):
        before = means.copy()
        for k, effect in enumerate(effects):
            own, known = evidence.information[k, k], evidence.known(k)
            others = np.einsum("k...,k...", evidence.information[k], means)
            own = np.where(known, own, LEAST_INFORMATION)
            left = (evidence.score[k] - others) / own
            estimate = np.where(known, means[k] + left, 0)
            if effect.lacks_slow_part:
                estimate = _high_pass(estimate, known, evidence.repeat)
            means[k] = estimate * (priors[k].each / (priors[k].each + 1 / own))
        if np.abs(means - before).max() <= AGREED * np.abs(means).max():
            break
    return means


def _covariance(evidence: Evidence, priors: Sequence[_Prior]) -> Array:
    """Return (K, K, T, h, w) posterior covariance."""
    every = range(len(evidence.score))
    if len(every) == 1:
        own = evidence.information[0, 0]
        known, prior = evidence.known(0), priors[0].each
        error = 1 / np.where(known, own, LEAST_INFORMATION)
        return np.where(known, error * (prior / (prior + error)), prior)[None, None]
    inverse = np.linalg.inv(_with_priors(evidence, priors, list(every)))
    return np.moveaxis(inverse, (-2, -1), (0, 1))


def _high_pass(image: Array, known: Mask, repeat: int) -> Array:
    """What is left of each CFA site's plane without its smooth part, where known.

    repeat : side of the CFA's, px; 1 without filters. Larger ones than Bayer's have
    sites of one colour everywhere, and go by his."""
    step = min(repeat, 2)
    rest = np.zeros_like(image)
    for row, col in product(range(step), repeat=2):
        at = np.s_[:, row::step, col::step]
        width = (0, SMOOTH, SMOOTH)
        weight = gaussian_filter(known[at].astype(float), width)
        slow = gaussian_filter(np.where(known[at], image[at], 0), width)
        rest[at] = image[at] - slow / np.maximum(weight, 1e-9)
    return np.where(known, rest, 0)
