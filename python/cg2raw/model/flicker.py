# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Mains flicker: a wave of light down the rows, of another phase in every frame.

What frames have of it beyond the mean of their group is in the scatter of rows; what
that mean has left of it, and its period, are in what means of flats differ by."""

from collections.abc import Iterator

import numpy as np
from scipy.optimize import minimize_scalar

from cg2raw.model.fit import Fit
from cg2raw.normal import CI95
from cg2raw.statistics.constant import (
    PARTS,
    SMOOTH,
    Array,
    lines_of_mosaic,
    polynomials,
)

NAME = "mains_flicker"
PADDED = 4  # times the rows, of the transform that finds the period
SHORTEST = 4.0  # px, as the registry bounds periods
STEP = 1e-3  # of the transform's resolution, of which the curvature is taken


def flicker(fit: Fit) -> Iterator[tuple[str, float, float, float]]:
    """Yield (parameter, value, low, high): 95 % intervals of the amplitude, relative to
    the light, and of the period, px; nothing of flats of one mean image."""
    planes = fit.likelihood.planes
    flats = np.flatnonzero(planes[0].is_flat & (planes[0].light > 0))
    if len(flats) < 2:
        return
    frames = planes[0].frames[flats].astype(float)
    rows = lines_of_mosaic(
        [plane.plane.rows[flats] / plane.light[flats, None] for plane in planes],
        across=False,
    )
    rows -= frames @ rows / frames.sum()
    smooth = polynomials(rows.shape[1])[: SMOOTH + 1]
    rows -= rows @ smooth.T @ smooth
    rows *= np.sqrt(frames)[:, None]
    count = rows.shape[1]

    def squares(frequency: float) -> float:
        """Of rows, those of a wave."""
        wave = _wave(frequency, count)
        found, *_ = np.linalg.lstsq(wave.T @ wave, wave.T @ rows.T, rcond=None)
        return float((wave.T @ rows.T * found).sum())

    power = (np.abs(np.fft.rfft(rows, PADDED * count)) ** 2).sum(axis=0)
    last = int(PADDED * count / SHORTEST)
    first = np.argmax(power[PADDED : last + 1]) + PADDED  # a wave in the frame at least
    around = (first - 1) / PADDED / count, (first + 1) / PADDED / count
    best = minimize_scalar(lambda x: -squares(x), bounds=around, method="bounded")
    frequency, own = float(best.x), -float(best.fun)
    freedom = (len(flats) - 1) * (count - SMOOTH - 1)
    noise = max(float((rows**2).sum()) - own, 0.0) / max(freedom - 3, 1)
    step = STEP / count
    bent = 2 * own - squares(frequency + step) - squares(frequency - step)
    error = float(np.sqrt(2 * noise / max(bent, 1e-300))) * step / frequency**2
    period, half = 1 / frequency, CI95 * error
    within, of_within = _in_scatter(fit, frequency)
    wave = _wave(frequency, count)
    between = max(own - 2 * noise, 0.0) / float((wave**2).sum())
    # Of squares about means of groups, and of these about that of all.
    again = frames.sum() - len(flats), frames.sum() - 1
    square = (within * again[0] + 2 * between) / again[1]
    # Waves of chance phases sum up to the root of their number, more or less.
    chance = float(np.hypot(of_within, square / again[1]))
    ends = square - CI95 * chance, square, square + CI95 * chance
    low, amplitude, high = (float(np.sqrt(max(x, 0.0))) for x in ends)
    yield "amplitude", amplitude, low, high
    yield "period", period, max(period - half, SHORTEST), period + half


def _wave(frequency: float, count: int) -> Array:
    """Return (count, 2) a wave of both phases, without what is smooth."""
    turns = 2 * np.pi * frequency * np.arange(count)
    both = np.column_stack([np.cos(turns), np.sin(turns)])
    smooth = polynomials(count)[: SMOOTH + 1]
    found: Array = both - smooth.T @ (smooth @ both)
    return found


def _in_scatter(fit: Fit, frequency: float) -> tuple[float, float]:
    """Return the square of the amplitude by what frames of a group differ by, and its
    standard error."""
    first = fit.likelihood.planes[0]
    names = [f"{NAME}, {part}" for part in ("slow_rows", "fast_rows")]
    places = [fit.parameters.of(name) for name in names]
    freedom = [first.plane.freedom[PARTS.index(name.split(", ")[1])] for name in names]
    wave = _wave(frequency * first.side, first.plane.shape[0])
    each = 2 * np.array(freedom) / float((wave**2).sum()) / first.plane.shape[1]
    covariance = np.nan_to_num(fit.covariance[np.ix_(places, places)])
    return float(each @ fit.theta[places]), float(np.sqrt(each @ covariance @ each))
