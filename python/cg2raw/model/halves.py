# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Halves of the frame that differ, in offset or in response: those of two amplifiers.

No effect has that. It is measured by the step in the middle of the columns, or of the
rows; what such a step moves is taken off, so that it gets no name of what is smooth or
of lines."""

from dataclasses import dataclass, replace

import numpy as np

from cg2raw.statistics.constant import (
    PARTS,
    SMOOTH,
    Array,
    ConstantStatistics,
    PlaneStatistics,
    polynomials,
)

NAME = "halves"
NEAR = 8  # parts of a side, as wide as what is slow can follow a step
FEWEST = 32  # lines, of which the slow ones, 12 numbers, leave more than half


@dataclass(frozen=True)
class Halves:
    """nats : of the step that training frames show, on validation frames. offset : how
    far the halves' black levels are apart, DN. response : relative, their responses."""

    nats: float = 0.0
    offset: float = 0.0
    response: float = 0.0


def halves_of(
    statistics: ConstantStatistics, splits: tuple[str, str], axis: int
) -> Halves:
    """Return how the halves of a side differ. splits : to train and to validate by.
    axis : 1 for left and right, 0 for top and bottom."""
    trained, measured = (_steps(statistics, split, axis) for split in splits)
    nats, sizes = 0.0, [0.0, 0.0]
    for n, (first, second) in enumerate(zip(trained, measured, strict=True)):
        if first is None or second is None:
            continue
        (step, _), (value, error) = first, second
        nats = max(nats, (value**2 - (value - step) ** 2) / error**2 / 2)
        sizes[n] = (step + value) / 2
    return Halves(nats, *sizes)


def without_halves(statistics: ConstantStatistics, axis: int) -> ConstantStatistics:
    """Return the same without what a step in the middle of mean images moves."""
    return replace(
        statistics,
        planes=tuple(_without(plane, axis) for plane in statistics.planes),
    )


def _lines(plane: PlaneStatistics, axis: int) -> Array:
    """Return (G, n) DN, means of columns, axis 1, or of rows."""
    return plane.columns if axis else plane.rows


def _steps(
    statistics: ConstantStatistics, split: str, axis: int
) -> list[tuple[float, float] | None]:
    """Return the step of darks, DN, and of light, relative, each with its standard
    error by what lines differ besides; None where there are none."""
    lines = np.array([_lines(plane, axis) for plane in statistics.planes])
    found: list[tuple[float, float] | None] = [None, None]
    if (count := lines.shape[-1]) < FEWEST:
        return found
    own, frames = statistics.splits == split, statistics.frames
    darks, flats = (
        np.flatnonzero(own & (statistics.is_flat == is_lit)) for is_lit in (False, True)
    )
    levels = np.array([plane.level for plane in statistics.planes])
    blacks, dark = np.zeros(len(levels)), np.zeros((len(levels), count))
    if len(darks):
        times = [statistics.groups[g].exposure_time or 0.0 for g in darks]
        blacks = levels[:, darks[np.argmin(times)]]
        dark = np.average(lines[:, darks], axis=1, weights=frames[darks])
        found[0] = _step(dark)
    if len(flats):
        light = levels[:, flats] - blacks[:, None]
        relative = (lines[:, flats] - dark[:, None]) / light[:, :, None]
        found[1] = _step(np.average(relative, axis=1, weights=frames[flats]))
    return found


def _step(planes: Array) -> tuple[float, float]:
    """Return the mean step of planes, (P, n), and its standard error, by what steps are
    elsewhere: lines next to each other may be alike."""
    lines = planes.mean(axis=0)
    count, near = len(lines), len(lines) // NEAR
    low = polynomials(count).T
    places = np.arange(near, count - near)
    steps = np.where(np.arange(count) < places[:, None], -0.5, 0.5)
    steps -= steps @ low @ low.T
    sizes = np.linalg.norm(steps, axis=1)
    middle = int(np.flatnonzero(places == count // 2)[0])
    value = float(steps[middle] @ lines) / float(sizes[middle]) ** 2
    each = steps @ (lines - value * steps[middle]) / sizes
    far = np.abs(places - count // 2) > near
    error = float(np.sqrt(np.mean(each[far] ** 2)))
    return value, error / float(sizes[middle])


def _without(plane: PlaneStatistics, axis: int) -> PlaneStatistics:
    """Each part of the lines loses the one of its coefficients that a step moves."""
    lines = _lines(plane, axis)
    low = polynomials(count := lines.shape[1])[1:]
    step = np.where(np.arange(count) < count // 2, -0.5, 0.5)
    smooth, slow = (some.T @ (some @ step) for some in (low[:SMOOTH], low[SMOOTH:]))
    rest, freedom, scatter = lines, plane.freedom.copy(), plane.scatter.copy()
    name = "columns" if axis else "rows"
    fast = step - step.mean() - smooth - slow
    for part, own in (("smooth", smooth), ("slow", slow), ("fast", fast)):
        if (square := float(own @ own)) < 1e-9:
            continue
        rest = rest - np.outer(rest @ own / square, own)
        at = PARTS.index(f"{part}_{name}")
        left = max(freedom[at] - 1, 0.0)
        scatter[:, at] *= left / max(freedom[at], 1.0)
        freedom[at] = left
    across = plane.shape[1 - axis]
    whole = plane.whole - across * (lines @ lines.T - rest @ rest.T)
    found = replace(plane, freedom=freedom, scatter=scatter, whole=whole)
    return replace(found, columns=rest) if axis else replace(found, rows=rest)
