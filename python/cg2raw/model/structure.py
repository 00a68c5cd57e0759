# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Structure: what is smooth of an offset, of a dark current, or of a response to light.

It is a shape, not a draw of a law: its size is that of its own coefficients."""

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.components import LOW, PATTERNS
from cg2raw.model.fit import Fit
from cg2raw.model.planes import PlaneLikelihood
from cg2raw.statistics.constant import PIXEL, Array
from cg2raw.statistics.frame_statistics import MOST_CUT

NOT_KNOWN = (np.nan, np.nan)


def structure_of(found: Fit, signature: str) -> tuple[float, float]:
    """Return the mean square over the frame and its standard error; nan where the
    frames do not show it. signature : "constant", "time" or "light"."""
    squares, variances, samples = 0.0, 0.0, 0
    slopes = np.zeros(len(found.theta))
    for plane in found.likelihood.planes:
        # Of groups with many samples at 0, as darks without a pedestal, shapes are
        # recorded in part: they count where nothing else tells.
        low = plane.plane.low
        for used in (low <= MOST_CUT, low <= 1):
            one, variance, slope = _in_plane(found, plane, used, signature)
            if np.isfinite(one):
                break
        squares, variances = squares + one, variances + variance
        samples += plane.plane.masked.size
        slopes += slope
    variances += found.variance_of(slopes)
    return squares / samples, float(np.sqrt(variances)) / samples


def _in_plane(
    found: Fit, plane: PlaneLikelihood, used: NDArray[np.bool_], wanted: str
) -> tuple[float, float, Array]:
    """Return the sum of squares of the low coefficients, its variance, and its (n,)
    slopes by parameters, on which it depends how places are recorded; nan where they
    are not shown. used : (G,) groups."""
    signatures = {"constant": np.ones(len(plane.time))}
    if len(set(plane.time[~plane.is_flat & used])) > 1:
        signatures["time"] = plane.time
    if (plane.is_flat & used).any():
        signatures["light"] = plane.light
    if wanted not in signatures:
        return (*NOT_KNOWN, 0 * found.theta)
    records, slopes = plane.records(found.theta)
    response = records.places * used
    design = np.column_stack(list(signatures.values())) * response[:, None]
    largest = np.abs(design).max(axis=0)
    is_seen = bool((np.isfinite(largest) & (largest > 0)).all())  # codes may hide all
    if not is_seen or np.linalg.matrix_rank(design / largest) < design.shape[1]:
        return (*NOT_KNOWN, 0 * found.theta)
    noises = plane.usual_scatter(found.theta)
    weighted = design / (noises[:, PIXEL] / plane.frames)[:, None]
    weights = np.linalg.solve(weighted.T @ design, weighted.T)
    weights = weights[list(signatures).index(wanted)]
    by_response = (weights * signatures[wanted]) @ slopes.places
    square = variance = 0.0
    for part in map(int, np.flatnonzero(LOW)):
        freedom = plane.plane.freedom[part]
        noise = weights**2 * noises[:, part] / plane.frames
        pixel = float((weights**2 * noises[:, PIXEL] / plane.frames).sum())
        pixel += _patterns_in(found, plane, part, wanted, "sample")
        chance = float(noise.sum()) + _patterns_in(found, plane, part, wanted)
        chance *= plane.plane.count[part] * plane.plane.mean_noise[part] / freedom
        size = freedom * float(weights @ plane.products[part] @ weights - chance)
        square += size
        # Of coefficients with their chance, which planes share but for the pixels', and
        # of the noise as it was measured.
        shared = (plane.side - 1) * max(chance - pixel, 0.0)
        variance += 2 * freedom * (chance + shared) * chance
        variance += 4 * (chance + shared) * max(size, 0.0)
        of_noise = 2 * freedom * noise**2 / np.maximum(plane.frames - 1, 1)
        variance += float(of_noise.sum())
    slopes_of_square = -by_response
    if wanted == "light":
        each, by_level = _by_light(found, plane, weights * response * plane.is_flat)
        slopes_of_square = slopes_of_square + each
        variance += 4 * square**2 * by_level
    return square, variance, 2 * max(square, 0.0) * slopes_of_square


def _by_light(
    found: Fit, plane: PlaneLikelihood, weights: Array
) -> tuple[Array, float]:
    """Return how what is relative to light depends on what is not light of the levels:
    (n,) slopes of its logarithm by parameters, and its variance by their drift.
    weights : (G,) by which mean images add up to it."""
    place = found.parameters.of
    slopes = np.zeros(len(found.theta))
    slopes[place("black_level", plane.site)] = weights.sum()
    slopes[place("dark_current")] = weights @ plane.time
    drift = max(float(found.theta[place("black_level_drift")]), 0.0)
    return slopes, float(drift * weights**2 @ (1 / plane.frames))


def _patterns_in(
    found: Fit, plane: PlaneLikelihood, part: int, signature: str, per: str = ""
) -> float:
    """Return what patterns of pixels and lines, or of one of both, are in a coefficient
    of a low part."""
    each = [
        found.theta[found.parameters.of(c.name)] * c.in_means(plane.plane)[part]
        for c in PATTERNS
        if c.signature == signature and c.per in (per or c.per,)
    ]
    return max(float(sum(each)), 0.0)
