# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Maps of pixels: offsets, rates and gains of the same pixels, estimated together.

Each map is Gaussian with a variance of its own, which all pixels together show (see
map_prior): what is known of a pixel is its posterior under these priors.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.map_evidence import LEAST_INFORMATION, Evidence
from cg2raw.diagnose.inference.map_prior import long_tailed_prior_of
from cg2raw.diagnose.likelihood.model import Term

SMOOTH = 5  # pixels of one colour; a slower map is shading, and not of the pixels
KEPT = 1 - 3 / (4 * np.pi * SMOOTH**2)  # of white noise's variance, by the high pass
MOST_TURNS = 30  # of all maps, until they agree
CLOSE = 1e-3  # relative change of their deviations, from where on they do


def pixel_maps(
    terms: Sequence[Term], effects: Sequence[FixedPattern], evidence: Evidence
) -> list[Term]:
    """Return terms with their maps and the maps' standard deviations."""
    count = len(terms)
    priors = [float(term.values[0]) ** 2 for term in terms]
    if count > 1 and not all(priors):
        priors = [_marginal(k, effects[k], evidence, None)[0] for k in range(count)]
    for _ in range(MOST_TURNS if count > 1 else 1):
        before = list(priors)
        for k in range(count):
            priors[k] = _marginal(k, effects[k], evidence, priors)[0]
        if np.allclose(np.sqrt(priors), np.sqrt(before), rtol=CLOSE, atol=0):
            break
    means = _means(effects, evidence, priors)
    covariance = _covariance(evidence, priors)
    found = []
    for k, term in enumerate(terms):
        others = {terms[i].name: covariance[k, i] for i in range(count) if i != k}
        sensor_map = SensorMap(means[k], covariance[k, k], others)
        values = np.array([np.sqrt(priors[k])])
        found.append(replace(term, values=values, sensor_map=sensor_map))
    return found


def _marginal(
    one: int, effect: FixedPattern, evidence: Evidence, priors: Sequence[float] | None
) -> tuple[float, Array]:
    """Return (variance of one map, its estimate without the prior), where the others
    are as unsure as their priors; None for others that are 0."""
    information, score = evidence.information[one, one], evidence.score[one]
    known = evidence.known(one)
    others = [k for k in range(len(evidence.score)) if k != one]
    if priors is not None and others:
        cross = evidence.information[one, others]
        inner = _with_priors(evidence, priors, others)
        pull = np.linalg.solve(inner, np.moveaxis(cross, 0, -1)[..., None])[..., 0]
        pull = np.moveaxis(pull, -1, 0)
        information = information - (pull * cross).sum(0)
        score = score - (pull * evidence.score[others]).sum(0)
    information = np.where(known, np.maximum(information, LEAST_INFORMATION), 1.0)
    estimate = np.where(known, score / information, 0)
    if effect.lacks_slow_part:
        estimate = _high_pass(estimate, known)
    kept = KEPT if effect.lacks_slow_part else 1.0
    square, error = (estimate**2)[known] / kept, (1 / information)[known]
    return long_tailed_prior_of(square, error), estimate


def _with_priors(
    evidence: Evidence, priors: Sequence[float], chosen: Sequence[int]
) -> Array:
    """Return (T, h, w, k, k) information of some maps, with that of their priors."""
    inner = np.moveaxis(evidence.information[np.ix_(chosen, chosen)], (0, 1), (-2, -1))
    inner = inner.copy()
    for place, k in enumerate(chosen):
        inner[..., place, place] += 1 / max(priors[k], LEAST_INFORMATION)
    return inner


def _means(
    effects: Sequence[FixedPattern], evidence: Evidence, priors: Sequence[float]
) -> Array:
    """Return (K, T, h, w) posterior means: each map by what the others leave."""
    means = np.zeros_like(evidence.score)
    for _ in range(MOST_TURNS if len(effects) > 1 else 1):
        before = means.copy()
        for k, effect in enumerate(effects):
            own, known = evidence.information[k, k], evidence.known(k)
            left = evidence.score[k] - np.einsum(
                "k...,k...", evidence.information[k], means
            )
            own = np.where(known, own, LEAST_INFORMATION)
            estimate = np.where(known, means[k] + left / own, 0)
            if effect.lacks_slow_part:
                estimate = _high_pass(estimate, known)
            means[k] = estimate * (priors[k] / (priors[k] + 1 / own))
        if np.abs(means - before).max() <= CLOSE * np.abs(means).max():
            break
    return means


def _covariance(evidence: Evidence, priors: Sequence[float]) -> Array:
    """Return (K, K, T, h, w) posterior covariance."""
    every = range(len(evidence.score))
    if len(every) == 1:
        own = evidence.information[0, 0]
        known, prior = evidence.known(0), priors[0]
        error = 1 / np.where(known, own, LEAST_INFORMATION)
        return np.where(known, error * (prior / (prior + error)), prior)[None, None]
    inverse = np.linalg.inv(_with_priors(evidence, priors, list(every)))
    return np.moveaxis(inverse, (-2, -1), (0, 1))


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
