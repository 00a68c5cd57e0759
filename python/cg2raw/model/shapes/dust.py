# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Dust: round spots that lack light, of which none has more."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.special import gammaincinv, stdtrit

from cg2raw.model.figures import Figure
from cg2raw.model.shapes.base import Shape, Shown
from cg2raw.model.shapes.light_patterns import (
    Excess,
    excess_of,
    excesses_of,
    frame_shape,
    nats_of,
)
from cg2raw.normal import CI95
from cg2raw.statistics.constant import FIELD, Array, PlaneStatistics, polynomials
from cg2raw.statistics.spots import HALF

NAME = "dust"
MEGAPIXEL = 1e6
SMALLEST = 1.0  # px, of that radius, as the registry bounds it
STEEPEST = 8.0  # power of the radius by which the loss falls; 2 is a Gaussian
FEWEST = 6  # pixels of which a spot's five numbers are fitted
MOST_LEFT = 0.1  # nats that their law may leave in spots, over those that it gains
EVEN = 0.3  # relative sd of the depths, and radii, of spots: even from 1/2 to 3/2


@dataclass(frozen=True)
class Spot:
    """numbers : row and column of the middle, depth, radius to where half of it is
    left, px, and power. errors : their standard errors. left : chi-square of what is
    not explained, beyond its freedom and chance."""

    numbers: Array
    errors: Array
    left: float


def dust(shown: Shown) -> Shape | None:
    """Return the evidence of dark spots, each less that of any among all places that
    were tried, and less that of bright ones. It is of something unlike dust where their
    law leaves more than MOST_LEFT of it: a telescope's mirror in the way of light makes
    rings of shadows. None without spots."""
    spots = shown.statistics.spots
    if spots is None:
        return None
    shape = frame_shape(shown)
    numbers = spots.numbers(shape)
    if (excesses := excesses_of(shown, numbers > 0)) is None:
        return None
    first, _, both = excesses
    of_pixels = numbers[first.rows, first.columns]
    nats, left, fitted = 0.0, 0.0, []
    for number, place in enumerate(spots.places, 1):
        own = of_pixels == number
        if not own.any():
            continue
        away = np.hypot(first.rows[own] - place[0], first.columns[own] - place[1])
        profile = np.exp2(-((away / (HALF * place[2])) ** 2))
        trained, measured, together = (
            one.where(own).times(profile) for one in excesses
        )
        more = nats_of(trained, measured, together, spots.tried)
        nats += more if together[0] < 0 else -more
        spot = _fitted(both.where(own), place)
        if together[0] < 0 and spot is not None:
            left += max(spot.left, 0.0) / 2
            fitted.append(spot)
    figures = _figures(fitted, shape)
    if left > MOST_LEFT * max(nats, 0.0):
        return Shape(NAME, 0.0, figures, unlike=nats)
    return Shape(NAME, nats - left, figures)


def power_of_spots(shown: Shown, split: str) -> float:
    """Return what the pixels in spots add to the mean square of the sensitivity, beyond
    what all differ by; 0 without spots."""
    spots, shape = shown.statistics.spots, frame_shape(shown)
    if spots is None:
        return 0.0
    excess = excess_of(shown, (split,), spots.samples(shape))
    if excess is None:
        return 0.0
    squares = float((excess.values**2 - 1 / excess.weights).sum())
    return max(squares, 0.0) / (shape[0] * shape[1])


def like_shading(found: Shape, plane: PlaneStatistics, side: int) -> float:
    """Return the mean square of smooth coefficients of the light that spots in all four
    corners would lack, relative: there they are like a lens's shading. found : dust, as
    deep and as wide. side : planes along the CFA's repeat."""
    depth, radius = (f.value for f in found.figures if f.name in ("depth", "radius"))
    if not np.isfinite(depth):
        return 0.0
    rows, columns = (side * np.arange(length) for length in plane.shape)
    spot = depth * (np.hypot.outer(rows, columns) < radius)
    down, across = (polynomials(length)[: FIELD + 1] for length in plane.shape)
    coefficients = down @ spot @ across.T
    return 4 * float((coefficients.ravel()[1:] ** 2).mean())


def unseen_light(found: Shape) -> float:
    """Return the share of all light that dust may take outside of what its law says:
    as much of what it takes as the law may leave of its evidence."""
    density, depth, radius = (figure.value for figure in found.figures)
    taken = density / MEGAPIXEL * depth * np.pi * radius**2
    return MOST_LEFT * float(np.nan_to_num(taken))


def _loss(numbers: Array, rows: Array, columns: Array) -> Array:
    row, column, depth, radius, power = numbers
    away = np.hypot(rows - row, columns - column) / radius
    found: Array = depth * np.exp2(-(away**power))
    return found


def _slopes(numbers: Array, rows: Array, columns: Array) -> Array:
    """Return (N, 5) how the loss moves with the numbers."""
    row, column, depth, radius, power = numbers
    down, across = rows - row, columns - column
    away = np.maximum(np.hypot(down, across), 1e-9)
    raised = (away / radius) ** power
    left = np.exp2(-raised)
    by_raised = -np.log(2) * depth * left * raised  # of its logarithm
    inward = -power / away**2
    found: Array = np.column_stack(
        [
            by_raised * inward * down,
            by_raised * inward * across,
            left,
            -by_raised * power / radius,
            by_raised * np.log(away / radius),
        ]
    )
    return found


def _fitted(excess: Excess, place: Array) -> Spot | None:
    """Return a spot by least squares; None of few pixels. place : as of Spots."""
    if len(excess.values) < FEWEST:
        return None
    row, column, reach = place
    root, rows, columns = (
        np.asarray(one, float)
        for one in (np.sqrt(excess.weights), excess.rows, excess.columns)
    )
    near = np.hypot(rows - row, columns - column) < HALF * reach
    middle = -float(excess.values[near].mean()) if near.any() else 0.01
    start = np.array([row, column, np.clip(middle, 1e-3, 0.9), HALF * reach, 3.0])
    found = least_squares(
        lambda x: root * (excess.values + _loss(x, rows, columns)),
        start,
        lambda x: root[:, None] * _slopes(x, rows, columns),
        bounds=(
            [row - reach, column - reach, 0.0, SMALLEST, 1.0],
            [row + reach, column + reach, 1.0, 2 * reach, STEEPEST],
        ),
        x_scale=[reach, reach, 0.1, reach, 1.0],
    )
    inverse = np.linalg.pinv(found.jac.T @ found.jac)
    errors = np.sqrt(np.maximum(np.diagonal(inverse), 0.0))
    freedom = len(root) - len(start)
    chance = CI95 * float(np.sqrt(2 * freedom))
    return Spot(found.x, errors, 2 * float(found.cost) - freedom - chance)


def _figures(spots: list[Spot], shape: tuple[int, int]) -> tuple[Figure, ...]:
    """Return how many spots have their middle in the frame, by a Poisson law, their
    mean depth and their mean radius."""
    inside = [
        spot
        for spot in spots
        if all(
            -0.5 <= at < n - 0.5 for at, n in zip(spot.numbers[:2], shape, strict=True)
        )
    ]
    count, share = len(inside), MEGAPIXEL / (shape[0] * shape[1])
    low = gammaincinv(count, 0.025) if count else 0.0
    ends = low * share, gammaincinv(count + 1, 0.975) * share
    density = Figure("density", "1/MP", count * share, count**0.5 * share, *ends)
    return (
        density,
        *(
            _mean(name, unit, spots, number)
            for number, (name, unit) in enumerate((("depth", "1"), ("radius", "px")), 2)
        ),
    )


def _mean(name: str, unit: str, spots: list[Spot], number: int) -> Figure:
    """Return the mean of a number over the law that spots are drawn of, with Student's
    interval; nan of none."""
    if not spots:
        return Figure(name, unit, np.nan, np.nan, np.nan, np.nan)
    values, errors = np.array([(s.numbers[number], s.errors[number]) for s in spots]).T
    weights = 1 / (errors**2 + (EVEN * np.median(values)) ** 2)
    mean = float(weights @ values / weights.sum())
    freedom = len(spots) - 1
    spread = weights @ (values - mean) ** 2 / max(freedom, 1)
    error = float(np.sqrt(max(spread, 1.0 if freedom < 2 else 0.0) / weights.sum()))
    half = float(stdtrit(max(freedom, 1), 0.975)) * error
    return Figure(name, unit, mean, error, max(mean - half, 0.0), mean + half)
