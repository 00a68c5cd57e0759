# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""One map of the same pixels, beside the others: these are integrated out of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.map_evidence import LEAST_INFORMATION, Evidence

LEAST_LEFT = 1e-6  # of what frames tell of a pixel, that is left of it


@dataclass(frozen=True)
class Prior:
    """Of a map: variance of all, and of each pixel, where a few are wide.

    pulls : of each pixel's prior, its mean over its variance. lost : nats, by the law
    that a profile states, where the prior is not of that. told : estimates of a normal
    map's pixels and the variances of their errors, infinite where nothing is known."""

    variance: float
    pixels: Array | None = None
    pulls: Array | float = 0.0
    lost: float = 0.0
    told: tuple[Array, Array] | None = None

    @property
    def each(self) -> Array | float:
        return max(self.variance, 0.0) if self.pixels is None else self.pixels

    @property
    def pull(self) -> Array | float:
        return self.pulls

    @property
    def of_all(self) -> "Prior":
        """The prior before anything is known of a pixel, as another map's law needs
        it."""
        return self


def marginal(
    one: int, evidence: Evidence, priors: Sequence[Prior] | None
) -> tuple[Array, Array]:
    """Return ((K, T, h, w) weights of the scores of all maps, by which the others are
    integrated out of that of one; that score)."""
    weights = np.zeros_like(evidence.score)
    weights[one] = 1
    others = [k for k in range(len(evidence.score)) if k != one]
    if priors is None or not others:
        return weights, evidence.score[one]
    wide = [prior.of_all for prior in priors]
    inner = _with_priors(evidence, wide, others)
    weights[others] = -_solved(inner, evidence.information[one, others])
    scores = [
        evidence.score[k] + (wide[k].pull if k != one else 0) for k in range(len(wide))
    ]
    return weights, np.einsum("k...,k...", weights, np.stack(scores))


def slope_and_error(
    one: int, evidence: Evidence, weights: Array
) -> tuple[Array, Array]:
    """Return (how much of a map is in its score beside the others, the variance of an
    estimate by that). Frames that tell one map alone show others, too: what is not
    known of these is an error then, and no less of the map.

    weights : of the scores, which leave nothing of the others but by their priors."""
    own = evidence.information[one, one]
    slope = np.einsum("k...,k...", weights, evidence.information[:, one])
    shared = np.einsum("k...,k...", weights, evidence.shared(one))
    variance = 2 * shared - np.einsum("k...,k...", weights, evidence.information[one])
    least = LEAST_LEFT * own + LEAST_INFORMATION
    slope = np.maximum(slope, least)
    return slope, np.maximum(variance, least) / slope / slope


def _with_priors(
    evidence: Evidence, priors: Sequence[Prior], chosen: Sequence[int]
) -> Array:
    """Return (k, k, T, h, w) information of some maps, with that of their priors."""
    inner = evidence.information[np.ix_(chosen, chosen)]
    for place, k in enumerate(chosen):
        inner[place, place] += 1 / np.maximum(priors[k].each, LEAST_INFORMATION)
    return inner


def _solved(matrix: Array, right: Array) -> Array:
    """Return (k, ...) solutions of positive definite systems (k, k, ...) of few
    unknowns, of all pixels together: by elimination, which needs no pivots then.

    right : (k, ...), or (k, n, ...) of n systems of one matrix."""
    matrix, found = matrix.copy(), right.copy()
    count = len(matrix)
    for i in range(count):
        for j in range(i + 1, count):
            share = matrix[j, i] / matrix[i, i]
            matrix[j, i:] -= share * matrix[i, i:]
            found[j] -= share * found[i]
    for i in reversed(range(count)):
        for j in range(i + 1, count):
            found[i] -= matrix[i, j] * found[j]
        found[i] /= matrix[i, i]
    return found


def posterior_covariance(evidence: Evidence, priors: Sequence[Prior]) -> Array:
    """Return (K, K, T, h, w) posterior covariance."""
    every = range(len(evidence.score))
    if len(every) == 1:
        own = evidence.information[0, 0]
        known, prior = evidence.known(0), priors[0].each
        error = 1 / np.where(known, own, LEAST_INFORMATION)
        return np.where(known, error * (prior / (prior + error)), prior)[None, None]
    inner = _with_priors(evidence, priors, list(every))
    units = np.eye(len(every))[..., None, None, None]
    inverse = _solved(inner, np.broadcast_to(units, inner.shape))
    shared = np.minimum(inner, inner.swapaxes(0, 1))
    half = np.einsum("ik...,kl...->il...", inverse, shared)
    covariance: Array = np.einsum("il...,jl...->ij...", half, inverse)
    return covariance
