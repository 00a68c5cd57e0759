# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Noise of scenes: its size where no darks and flats tell it, and what captures have
beyond it. Both calibrate, and are no finding."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from cg2raw.diagnose.scenes.gram import Array
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.point import Point
from cg2raw.diagnose.scenes.predict import photon_gain, variance_left
from cg2raw.normal import MAD

ROUNDS = 6
FARTHEST = 16.0  # variances; squares beyond are those of defects
LEAST_FACTOR = 1e-3
MOST_SHIFT, MOST_TEXTURE = 0.5, 0.1  # px; relative


def noise_factors(
    points: Sequence[Point], residuals: Sequence[Array]
) -> tuple[Array, Array]:
    """Return what multiplies the variance of light and that of the read-out, (2,), and
    the information of it, (2, 2); what else the model has of noise, as by rounding,
    stays.

    residuals : (T, h, w) of the mean images; of a view whose frames repeat, what these
    differ by is used instead."""
    every, others, square, freedom = [], [], [], []
    for point, residual in zip(points, residuals, strict=True):
        view, used = point.view, point.root > 0
        every.append(noise_parts(point)[:, used])
        own = (view.away**2).sum(0) / (view.n - 1) if view.n > 1 else residual**2
        own = own / variance_left(point.model)
        whole = point.frame_variance if view.n > 1 else point.noise_variance
        others.append(np.maximum(whole[used] - every[-1].sum(0), 0))
        square.append(own[used])
        freedom.append(np.full(used.sum(), max(view.n - 1, 1)))
    parts = np.concatenate(every, axis=1)
    rest, squares = np.concatenate(others), np.concatenate(square)
    weights = np.concatenate(freedom)
    factors, model = np.ones(2), points[0].model
    gains = np.array([model.noise_gain(name) for name in ("beta1", "beta2")])
    for _ in range(ROUNDS):
        expected = factors @ parts + rest
        near = squares < FARTHEST * expected
        weight = near * np.sqrt(weights) / expected
        # Where light is bright, nothing tells the read noise: then it is the profile's.
        design = np.vstack([(parts * weight).T, np.sqrt(2) * np.diag(gains)])
        target = np.concatenate([(squares - rest) * weight, np.full(2, np.sqrt(2))])
        factors = nnls(design, target)[0]
        factors = np.maximum(factors, LEAST_FACTOR / gains)
    return factors, design.T @ design / 2  # squares have twice the variance


def noise_parts(point: Point) -> Array:
    """Return the variance of light and that of the read-out, (2, T, h, w)."""
    light = photon_gain(point.model, point.frame) * np.maximum(point.base, 0)
    readout = point.model.noise_gain("beta2") * point.frame.beta2
    return np.stack(np.broadcast_arrays(light, readout))


def noise_shares(point: Point) -> Array:
    """Return the same, (2, T, h, w), as shares of the variance of the mean of frames; 0
    of samples that are not used."""
    return np.asarray(noise_parts(point) / point.view.n * point.root**2)


def freedom_of(n: float, points: Sequence[Point], of_noise: Array) -> float:
    """Return the degrees of freedom of the chi-square of @n samples, whose noise is
    known by the information (2, 2) of another fit."""
    shares = [noise_shares(point).sum((1, 2, 3)) for point in points]
    mean = np.sum(shares, axis=0) / n
    return float(1 / (1 / n + mean @ np.linalg.solve(of_noise, mean) / 2))


def excess_of(
    points: Sequence[Point], residuals: Sequence[Array]
) -> tuple[float, float]:
    """Return the deviation that mean images have beyond their noise: of a shift, px,
    and of light, relative."""
    slopes, lights, squares, variances = [], [], [], []
    for point, residual in zip(points, residuals, strict=True):
        used = point.root > 0
        slope, _ = point.frame.squared_slope_and_light
        slopes.append(slope[used])
        light = np.maximum(point.base, 0) ** 2
        lights.append(light[used])
        squares.append((residual**2)[used])
        variances.append(point.noise_variance[used])
    if not squares:
        return 0.0, 0.0
    parts = np.array([np.concatenate(slopes), np.concatenate(lights)])
    square, noise = np.concatenate(squares), np.concatenate(variances)
    # From the median of what is in proportion to light, which few defects move.
    lit = parts[1] > 0
    more = np.maximum(square - noise, 0)[lit] / parts[1][lit]
    start = MAD**2 * float(np.median(more)) if lit.any() else 0.0
    found = np.array([0.0, min(start, MOST_TEXTURE**2)])
    for _ in range(ROUNDS):
        expected = noise + found @ parts
        near = square < FARTHEST * expected
        weight = near / expected
        found = nnls((parts * weight).T, (square - noise) * weight)[0]
        found = np.minimum(found, (MOST_SHIFT**2, MOST_TEXTURE**2))
    shift, texture = np.sqrt(found)
    return float(shift), float(texture)


def patch_deviation(points: Sequence[Point], residuals: Sequence[Array]) -> float:
    """Return the deviation of a chart's colours from the published ones, relative."""
    squares = []
    for point, residual in zip(points, residuals, strict=True):
        used = point.root > 0
        light = np.maximum(point.base, 0)[used]
        labels, weight = point.view.patches[used], light / point.noise_variance[used]
        precision = np.bincount(labels, weight * light)
        lit = precision > 0
        error = np.bincount(labels, weight * residual[used])[lit] / precision[lit]
        squares.append(np.maximum(error**2 - 1 / precision[lit], 0))
    found = MAD * np.sqrt(np.median(np.concatenate(squares)))
    return float(min(found, MOST_TEXTURE))


def with_noise(model: Model, factors: Array) -> Model:
    """Return a model whose noise is so many times as large."""
    for name, factor in zip(("beta1", "beta2"), factors, strict=True):
        for term in model.terms:
            if term.calibration and term.effect.scales == name:
                moved = replace(term, values=term.values + np.log(factor))
                model = model.with_term(moved)
    return model
