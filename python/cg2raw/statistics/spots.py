# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Round spots that are darker or brighter than their surroundings, of any size: those
of a mean flat are dust on the cover glass.

Source: T. Lindeberg, Int. J. Computer Vision 30(2), 1998 (scale selection)."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from cg2raw.normal import robust_deviation
from cg2raw.statistics.constant import SLOW, Array, polynomials
from cg2raw.statistics.patterns import Spots, disc

Image = NDArray[np.float32]

CHANCE = 0.1  # of a spot that is set apart where none is; no name follows from it
MOST_CELLS = 2**16  # that the frame is divided into
SCALES = 2 ** np.arange(0, 4.1, 0.5)  # cells, sd of Gaussians
SIZES = SCALES[:-2]  # of spots; the next but one is AROUND as wide
FARTHEST = 6.0  # times its scale, that a spot may reach
AROUND = 2  # the sd of what it is compared with, over its own
ROUND = 8  # degree of polynomials of the place, where spots are not known yet
SHARP = 3.0  # power of the radius by which a spot falls: between a Gaussian and a disc
HALF = 0.6  # of a spot's reach, to where half of it is left
LEFT = 0.25  # of an amplitude, that a joint fit with slow polynomials must leave
SINGULAR = 1e-9  # relative: of what is alike only one is measured
MOST_FITTED = 2**12  # cells, by which what is smooth is fitted
CLIP = 8.0  # times the noise of a cell
ROUNDS = 6  # of finding spots without those found before
OF_LARGEST = 0.5  # of the largest deviation: less may be a ring around another


class Found(NamedTuple):
    """A spot. row, column : of its middle, cells. size : the number of its scale.
    strength : over the noise. rings : (radii,) cells, how far the mean around its
    middle is above the surroundings, over white noise."""

    row: int
    column: int
    size: int
    strength: float
    rings: Array

    def radius(self, noise: float = 1.0) -> float:
        """Return how far it reaches, in cells: to the last ring around its middle that
        is beyond the noise, times that of white noise, and one more."""
        far = int(np.ceil(SCALES[self.size]))
        while far < FARTHEST * SCALES[self.size] and self.rings[far] > noise:
            far += 1
        return float(far + 1)


def spots_of(light: Image, side: int, left_out: NDArray[np.bool_]) -> Spots:
    """Return the spots of a mean flat.

    light : (H, W) DN, less the level of each plane of the CFA's repeat. side : samples
    along the repeat. left_out : (H, W), pixels that do not count."""
    size = side
    while light.size / size**2 > MOST_CELLS:
        size += side
    values, weights = _cells(light, left_out, size)
    tried = max(values.size * len(SIZES), 1)
    if not weights.any():
        return Spots(np.zeros((0, 3)), tried)
    least = _least(tried)
    white, all_of_it = np.array([_noise_of(float(one)) for one in SIZES]), weights
    spots: list[Found] = []
    slow = _slow_terms(values.shape, ROUND)
    for number in range(ROUNDS + 1):
        rest = _without_slow(values, weights, slow)
        deviations = list(_deviations(rest, weights))
        more = list(_new_spots(rest, weights, deviations, white, least))
        if not more or number == ROUNDS:
            break
        spots += more
        weights = all_of_it * ~_covered(spots, np.ones_like(white), values.shape)
    # Where the rest of the frame is no white noise, spots must stand out of what it is.
    noises = np.array(
        [
            max(1.0, robust_deviation(away[enough], 0.0) / of_white)
            if enough.any()
            else np.inf
            for (away, enough), of_white in zip(deviations, white, strict=True)
        ]
    )
    strong = [one for one in spots if one.strength > least * noises[one.size]]
    if not strong:
        return Spots(np.zeros((0, 3)), tried)
    slow = _slow_terms(values.shape, SLOW)
    bent = _without_slow(values, all_of_it, slow, weights)
    found = _places(_needed(strong, rest, bent, all_of_it, slow, noises), noises)
    found[:, :2] = found[:, :2] * size + (size - 1) / 2
    found[:, 2] *= size
    return Spots(found, tried)


def _least(tried: int) -> float:
    """Return the deviations that one of so many that are tried has by CHANCE."""
    return float(np.sqrt(2 * np.log(max(tried, 1) / CHANCE)))


def _cells(light: Image, left_out: NDArray[np.bool_], size: int) -> tuple[Array, Array]:
    """Return the means of cells of size x size pixels, and the share that counts."""
    h, w = (length // size * size for length in light.shape)
    used = ~left_out[:h, :w]
    cells = (h // size, size, w // size, size)
    counts = used.reshape(cells).sum(axis=(1, 3))
    sums = np.where(used, light[:h, :w], 0).reshape(cells).sum(axis=(1, 3), dtype=float)
    return sums / np.maximum(counts, 1), counts / size**2


def _smoothed(values: Array, weights: Array, scale: float) -> tuple[Array, Array]:
    """Return the weighted mean around each cell and the sum of weights."""
    total = gaussian_filter(weights, scale, mode="constant", truncate=3.0)
    mean = gaussian_filter(values * weights, scale, mode="constant", truncate=3.0)
    return mean / np.maximum(total, 1e-9), total


def _without_slow(
    values: Array, weights: Array, slow: Array, of_noise: Array | None = None
) -> Array:
    """Return what is neither slow nor of whole rows or columns, over the noise of a
    cell, up to CLIP. weights : of cells by which that is known. slow : as of
    _slow_terms. of_noise : of the cells by which the noise is known; None for the same
    as weights."""
    at = np.flatnonzero(weights > 0)[:: max(values.size // MOST_FITTED, 1)]
    fitted, *_ = np.linalg.lstsq(slow[at], values.flat[at], rcond=None)
    rest = values - (slow @ fitted).reshape(values.shape)
    unknown = weights == 0
    for axis in (0, 1):
        # Of lines all of which is masked, nothing is taken off.
        some = np.where(unknown & ~unknown.all(axis=axis, keepdims=True), np.nan, rest)
        rest = rest - np.nanmedian(some, axis=axis, keepdims=True)
    plain = (weights if of_noise is None else of_noise) > 0
    noise = robust_deviation(rest[plain], 0.0) or 1.0
    found: Array = np.clip(rest / noise, -CLIP, CLIP)
    return found


def _slow_terms(shape: tuple[int, int], degree: int) -> Array:
    """Return (cells, n) polynomials of the place, of a degree in all, and those of rows
    and of columns alone."""
    down, across = (polynomials(length) for length in shape)
    degrees = np.add.outer(np.arange(len(down)), np.arange(len(across)))
    used = degrees <= degree
    used[:, 0] = used[0] = True
    y, x = np.nonzero(used)
    return (down.T[:, None, y] * across.T[None, :, x]).reshape(-1, len(y))


def _needed(
    spots: Sequence[Found],
    rest: Array,
    bent: Array,
    weights: Array,
    slow: Array,
    noises: Array,
) -> list[Found]:
    """Return the spots that a joint fit with all others and slow polynomials needs.

    The least significant amplitude is dropped until all are beyond chance, and have at
    least LEFT of what they have in a fit of the spots alone. rest, bent : residuals of
    slow polynomials that were fitted without the spots, and with them. slow : as of
    _slow_terms, of the degree of bent. noises : of each size."""
    found, least = list(spots), _least(len(spots))
    root = np.sqrt(weights.ravel())
    rows, columns = np.indices(rest.shape)
    shapes = np.empty((rest.size, len(found)))
    for n, one in enumerate(found):
        away = np.hypot(rows - one.row, columns - one.column) / (HALF * one.radius())
        shapes[:, n] = root * np.exp2(-(away**SHARP)).ravel()
    whole, *_ = np.linalg.lstsq(shapes, root * rest.ravel(), rcond=None)
    slow = root[:, None] * slow
    known = slow.T @ slow + SINGULAR * np.eye(slow.shape[1])
    shapes -= slow @ np.linalg.solve(known, slow.T @ shapes)
    while found:
        own = shapes.T @ shapes
        inverse = np.linalg.inv(own + SINGULAR * np.diag(np.diagonal(own)))
        left = inverse @ (shapes.T @ (root * bent.ravel()))
        errors = np.sqrt(np.diagonal(inverse)) * noises[[one.size for one in found]]
        sure = np.where(left / whole > LEFT, np.abs(left) / errors, 0.0)
        worst = int(np.argmin(sure))
        if sure[worst] > least:
            break
        del found[worst]
        shapes, whole = np.delete(shapes, worst, axis=1), np.delete(whole, worst)
    return found


def _places(spots: Sequence[Found], noises: Array) -> Array:
    """Return (N, 3) row, column and radius, in cells. noises : of each size."""
    each = [(one.row, one.column, one.radius(noises[one.size])) for one in spots]
    return np.array(each, float).reshape(-1, 3)


def _covered(
    spots: Sequence[Found], noises: Array, shape: tuple[int, int]
) -> NDArray[np.bool_]:
    return Spots(_places(spots, noises), 1).samples(shape)


def _deviations(
    rest: Array, weights: Array
) -> Iterator[tuple[Array, NDArray[np.bool_]]]:
    """Yield, for each size of spots, how far each place is above its surroundings, and
    where enough of it is known."""
    means = [_smoothed(rest, weights, float(scale)) for scale in SCALES]
    for n in range(len(SIZES)):
        (inner, known), (outer, _) = means[n], means[n + 2]
        yield inner - outer, known > 1 / 2


def _new_spots(
    rest: Array,
    weights: Array,
    deviations: Sequence[tuple[Array, NDArray[np.bool_]]],
    noises: Array,
    least: float,
) -> Iterator[Found]:
    """Yield what stands out most at any size, each for itself: none that may be a ring
    around a stronger one, or what is left between many. deviations, noises : of
    each size, those of _deviations and of white noise."""
    strength = np.array(
        [
            np.where(enough, away / noise, 0.0)
            for (away, enough), noise in zip(deviations, noises, strict=True)
        ]
    )
    sign = 1 if strength.max() > -strength.min() else -1
    rest, strength = sign * rest, sign * strength
    most = max(OF_LARGEST * float(strength.max()), least)
    taken = np.zeros(rest.shape, bool)
    places = np.flatnonzero(strength > most)
    for place in places[np.argsort(-strength.flat[places], kind="stable")]:
        n, row, column = (int(at) for at in np.unravel_index(place, strength.shape))
        if taken[row, column] or weights[row, column] == 0:
            continue
        rings = _rings(rest, weights, row, column, FARTHEST * float(SCALES[n]))
        found = Found(row, column, n, float(strength.flat[place]), rings)
        around = found.radius() + AROUND * float(SCALES[n])
        window, away = disc(row, column, around, rest.shape)
        taken[window] |= away <= around
        yield found


def _noise_of(scale: float) -> float:
    """Return the sd of the difference of two Gaussian means of white noise."""
    inner, outer = scale**2, (AROUND * scale) ** 2
    return float(np.sqrt((1 / inner + 1 / outer - 4 / (inner + outer)) / (4 * np.pi)))


def _rings(rest: Array, weights: Array, row: int, column: int, reach: float) -> Array:
    """Return the sums over rings, a cell wide, around a place, out to @reach and a cell
    more, over their noise; 0 where nothing is known."""
    window, away = disc(row, column, reach + 2, rest.shape)
    ring, used = np.rint(away).astype(int), weights[window] > 0
    counts = np.bincount(ring[used], minlength=int(reach) + 3)
    sums = np.bincount(ring[used], rest[window][used], len(counts))
    found: Array = sums / np.sqrt(np.maximum(counts, 1))
    return found
