# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Halves of the frame that differ, in offset or in response: those of two amplifiers.

No effect has that. It is measured by the step in the middle of the columns, or of the
rows; what such a step moves is taken off, so that it gets no name of what is smooth or
of lines."""

from collections.abc import Sequence
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


def _design(count: int) -> Array:
    """Return (n, 13): a step of 1 in the middle, and what is slow."""
    step = np.where(np.arange(count) < count // 2, -0.5, 0.5)
    return np.column_stack([step, polynomials(count).T])


def _steps(
    statistics: ConstantStatistics, split: str, axis: int
) -> list[tuple[float, float] | None]:
    """Return the step of darks, DN, and of light, relative, each with its standard
    error by what lines differ besides; None where there are none."""
    each: dict[str, list[Array]] = {"dark": [], "flat": []}
    frames: dict[str, list[float]] = {"dark": [], "flat": []}
    count = _lines(statistics.planes[0], axis).shape[1]
    if count < FEWEST:
        return [None, None]
    design = _design(count)
    for g, info in enumerate(statistics.groups):
        if info.split == split:
            lines = [_lines(plane, axis)[g] for plane in statistics.planes]
            each[info.kind].append(np.array(lines))
            frames[info.kind].append(float(statistics.frames[g]))
    darks = _mean(each["dark"], frames["dark"])
    found = [None if darks is None else _step(design, darks)]
    lights = [
        np.array([plane.level[g] for plane in statistics.planes])
        for g, info in enumerate(statistics.groups)
        if info.split == split and info.kind == "flat"
    ]
    blacks = _blacks(statistics, split)
    relative = [
        (lines - (0.0 if darks is None else darks)) / (level - blacks)[:, None]
        for lines, level in zip(each["flat"], lights, strict=True)
    ]
    flats = _mean(relative, frames["flat"])
    return [*found, None if flats is None else _step(design, flats)]


def _blacks(statistics: ConstantStatistics, split: str) -> Array:
    """Return (P,) DN, the levels of the shortest darks; 0 without darks."""
    darks = [
        (info.exposure_time or 0.0, g)
        for g, info in enumerate(statistics.groups)
        if info.split == split and info.kind == "dark"
    ]
    if not darks:
        return np.zeros(len(statistics.planes))
    return np.array([plane.level[min(darks)[1]] for plane in statistics.planes])


def _mean(each: Sequence[Array], weights: Sequence[float]) -> Array | None:
    if not each:
        return None
    found: Array = np.average(np.array(each), axis=0, weights=weights)
    return found


def _step(design: Array, planes: Array) -> tuple[float, float]:
    """Return the mean step of planes, (P, n), and its standard error, by what steps are
    elsewhere: lines next to each other may be alike."""
    lines = planes.mean(axis=0)
    count, low = len(lines), design[:, 1:]
    near = count // NEAR
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
    low, step = polynomials(lines.shape[1])[1:], _design(lines.shape[1])[:, 0]
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
