# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Fixed patterns: maps of the sensor, by empirical Bayes from the fit frames.

A map is no free parameter: its prior's variance is estimated from the pixels together,
and the map is the posterior mean. What is uncertain of it goes into the variance.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter

from cg2raw.diagnose.frames import Frame
from cg2raw.diagnose.tiling import Array
from cg2raw.diagnose.likelihood import Workers
from cg2raw.diagnose.prediction import Model, Pattern, Term, pattern_bearing, predict

SMOOTH = 5  # pixels of one colour; a slower map is shading, and not of the pixels
MEDIAN_OF_SQUARE = 0.4549  # of a standard normal
HOT = 5.5  # standard deviations above the others
CERTAIN = 8.0
SEEN = 3.5  # standard deviations in a single frame


def fit_patterns(model: Model, frames: Sequence[Frame], workers: Workers) -> Model:
    """Return the model with the maps of all its fixed patterns estimated."""
    for term in model.terms:
        if term.candidate.way == "pattern":
            rest = replace(
                model, terms=tuple(t for t in model.terms if t.name != term.name)
            )
            model = model.with_term(_fitted(term, rest, frames, workers))
    return model


def _fitted(term: Term, rest: Model, frames: Sequence[Frame], workers: Workers) -> Term:
    """Weighted least squares per pixel, then shrinkage."""
    shape = _common_shape(frames)
    chosen = [f for f in frames if f.signal.shape == shape]

    def evidence(frame: Frame) -> tuple[Array, Array, Array]:
        p = predict(rest, frame)
        bearing = pattern_bearing(term.name, frame, np.maximum(p.exposed, 0))
        residual = np.where(frame.censored, 0, frame.signal - p.mean)
        weight = np.where(frame.censored, 1e-9, 1 / p.variance)
        hit = residual / np.sqrt(p.variance) > SEEN
        return bearing**2 * weight, bearing * residual * weight, hit

    parts = workers.map(evidence, chosen)
    information = sum(part[0] for part in parts) + 1e-300
    score = sum(part[1] for part in parts)
    seen = sum(part[2].astype(int) for part in parts)
    keep = np.logical_or.reduce([f.keep for f in chosen])
    if term.name == "column_noise":
        return _columns(term, information, score, keep)
    if term.name == "hot_pixels":
        return _hot(term, information, score, seen, keep)
    return _pixels(term, information, score, keep)


def _common_shape(frames: Sequence[Frame]) -> tuple[int, ...]:
    shapes = [f.signal.shape for f in frames]
    return max(set(shapes), key=shapes.count)


def _high_pass(image: Array, keep: Array) -> Array:
    """What is left of each CFA site's plane without its smooth part, that of the pixels
    which are kept; others are 0."""
    rest = np.zeros_like(image)
    width = (0, SMOOTH, SMOOTH)
    for row in (0, 1):
        for col in (0, 1):
            site = np.s_[:, row::2, col::2]
            plane, used = np.where(keep[site], image[site], 0), keep[site].astype(float)
            near = np.maximum(gaussian_filter(used, width), 1e-6)
            rest[site] = (plane - gaussian_filter(plane, width) / near) * used
    return rest


def _pixels(term: Term, information: Array, score: Array, keep: Array) -> Term:
    raw = np.where(keep, score / information, 0)
    raw = np.where(information > 1e-200, raw, 0)
    estimate = _high_pass(raw, keep)
    error = 1 / information
    square, known = (estimate**2)[keep], error[keep]
    prior = max(np.median(square / MEDIAN_OF_SQUARE - known), 0)
    limit = 6 * np.sqrt(known + prior)
    bounded = np.clip(estimate[keep], -limit, limit) ** 2
    prior = max(prior, 0.5 * max(np.mean(bounded - known), 0))
    share = prior / (prior + error)
    pattern = Pattern(np.where(keep, estimate * share, 0), error * share)
    return replace(term, values=np.array([np.sqrt(prior)]), pattern=pattern)


def _columns(term: Term, information: Array, score: Array, keep: Array) -> Term:
    a = (information * keep).sum(1, keepdims=True)
    b = (score * keep).sum(1, keepdims=True)
    used = a > 1e-200
    estimate = np.where(used, b / np.maximum(a, 1e-300), 0)
    error = 1 / np.maximum(a, 1e-300)
    prior = max(np.mean((estimate**2 - error)[used]), 0)
    share = prior / (prior + error)
    shape = information.shape
    pattern = Pattern(
        np.broadcast_to(np.where(used, estimate * share, 0), shape),
        np.broadcast_to(np.where(used, error * share, prior), shape),
    )
    return replace(term, values=np.array([np.sqrt(prior)]), pattern=pattern)


def _hot(
    term: Term, information: Array, score: Array, seen: Array, keep: Array
) -> Term:
    estimate = score / information
    estimate = estimate - np.median(estimate[keep])
    z = np.where(keep, estimate * np.sqrt(information), 0)
    spread = 1.4826 * np.median(np.abs(z[keep] - np.median(z[keep])))
    hot = z > HOT * max(1.0, spread)
    hot &= (seen >= 2) | (z > CERTAIN)
    share = hot[keep].mean()
    pattern = Pattern(np.where(hot, estimate, 0), np.where(hot, 1 / information, 0))
    return replace(term, values=np.array([share]), pattern=pattern)
