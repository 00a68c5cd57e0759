# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The products of mean images: what repeats, of all planes together.

Coefficients of a part, of all planes and groups, are normal with the covariance

    sum over FIXED of variance * multiplicity * v v'
    + sum over TEMPORAL likewise, within each group, over its frames
    + diag(recorded noise / frames),

v the component's signature over the groups, for planes that share it, so the products
of their mean images are Wishart. What pixels have is of each plane alone."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre
from numpy.typing import NDArray

from cg2raw.model.components import (
    EVEN_ACROSS,
    EVEN_DOWN,
    FIXED,
    ROWS,
    TEMPORAL,
    Component,
)
from cg2raw.model.evaluation import Evaluation
from cg2raw.model.planes import PlaneLikelihood, less_of, neighbours, waves
from cg2raw.model.recorded import Recording, Records, joined
from cg2raw.statistics.constant import (
    FIELD,
    PARTS,
    PIXEL,
    SMOOTH,
    Array,
    ConstantStatistics,
    PlaneStatistics,
    polynomials,
)


@dataclass(frozen=True)
class Block:
    """One part of some planes: N of their mean images.

    products : (N, N) DN^2, mean over its freedom. terms : (K, N, N), what one unit of
    the parameters at places adds to the covariance; the first @fixed are of patterns,
    the others new in each frame. neighbours : (N, N) DN^2, covariance by correlation
    of noise with that of neighbours in other planes. noise_share : (N,) the share of
    a frame's noise that mean images have."""

    part: int
    planes: Sequence[int]
    freedom: float
    products: Array
    terms: Array
    places: NDArray[np.int64]
    fixed: int
    neighbours: Array
    noise_share: Array


class _Term(NamedTuple):
    """What one unit of a component adds to the covariance of all planes: a matrix,
    (N, N), times the size of a part in each, (P, 8)."""

    component: Component
    is_fixed: bool
    matrix: Array
    sizes: Array


class _Covariance(NamedTuple):
    """Of a block at some parameters: the covariance, (N, N), without patterns and what
    moves; what one unit of its parameters adds, (K, N, N); patterns; what moves."""

    rest: Array
    terms: Array
    patterns: Array
    moving: Array

    @property
    def whole(self) -> Array:
        return self.patterns + self.moving + self.rest


class MeanImageLikelihood:
    """The products of the mean images of all planes."""

    def __init__(
        self, planes: Sequence[PlaneLikelihood], statistics: ConstantStatistics
    ) -> None:
        self.planes, self.parameters = planes, planes[0].parameters
        self.statistics = statistics
        everything = list(range(len(planes)))
        terms = self._terms()
        chosen = [(part, everything) for part in range(PIXEL)]
        chosen += [(PIXEL, [site]) for site in everything]
        side = planes[0].side
        coefficients = [
            coefficients_of(plane.plane, site, side)
            for site, plane in enumerate(planes)
        ]
        self.blocks = []
        for part, sites in chosen:
            each = [planes[site].plane for site in sites]
            freedom = float(np.mean([plane.freedom_of_means[part] for plane in each]))
            if freedom <= 0:
                continue
            freedom_left = freedom * self._unlike(part)
            if part == PIXEL:
                products = planes[sites[0]].products[PIXEL]
            else:
                stacked = np.concatenate([coefficients[s][part] for s in sites])
                noises = [plane.count[part] * plane.mean_noise[part] for plane in each]
                products = stacked @ stacked.T / np.mean(noises)
            self.blocks.append(self._block(part, sites, terms, freedom_left, products))

    def _unlike(self, part: int) -> float:
        """Return by how much the freedom of a part is less for waves down the rows."""
        first, flats = self.planes[0], self.planes[0].is_flat & self.planes[0].repeats
        if not flats.any():
            return 1.0
        size, pixel = (
            float(np.mean([plane.scatter[flats, of].mean() for plane in self.planes]))
            for of in (part, PIXEL)
        )
        return less_of(size, pixel, waves(first.plane, part, True))

    def _block(
        self,
        part: int,
        sites: Sequence[int],
        terms: Sequence[_Term],
        freedom: float,
        products: Array,
    ) -> Block:
        used = [term for term in terms if term.component.parts[part]]
        count = len(self.planes[0].frames)
        own = slice(sites[0] * count, (sites[-1] + 1) * count)  # one of them, or all
        each = [term.sizes[sites, part].mean() * term.matrix[own, own] for term in used]
        places = [self.parameters.of(term.component.name) for term in used]
        return Block(
            part,
            tuple(sites),
            freedom,
            products,
            np.array(each).reshape(len(places), *products.shape),
            np.array(places, int),
            sum(term.is_fixed for term in used),
            self._neighbours(part, sites),
            self._noise_share(part, sites),
        )

    def _neighbours(self, part: int, sites: Sequence[int]) -> Array:
        """Return (N, N) DN^2, as measured; a sample has neighbours on both sides. 0 of
        the pixel part, which is of a plane alone."""
        first, count = self.planes[0], len(self.planes[0].frames)
        found, side = np.zeros((len(sites), count, len(sites), count)), first.side
        groups, noise = np.arange(count), [p.scatter[:, PIXEL] for p in self.planes]
        for down, across, even in ((0, 1, EVEN_ACROSS), (1, 0, EVEN_DOWN)):
            near = neighbours(self.statistics, down, across)
            if near is None or side == 1 or not even[part]:
                continue
            for a, (row, column) in enumerate(np.ndindex(side, side)):
                b = (row + down) % side * side + (column + across) % side
                covariance = near * np.sqrt(noise[a] * noise[b]) / first.frames
                found[a, groups, b, groups] += covariance
                found[b, groups, a, groups] += covariance
        return found.reshape(len(sites) * count, -1)

    def _terms(self) -> list[_Term]:
        """Return those of all components, of FIXED first."""
        frames, side = self.planes[0].frames, self.planes[0].side
        count, size = len(self.planes), len(frames)
        again = np.tile(np.eye(size), (count, count)) / np.tile(frames, count)
        found = []
        for number, component in enumerate((*FIXED, *TEMPORAL)):
            vectors = [plane.vectors(component) for plane in self.planes]
            one, two = (np.concatenate([v[at] for v in vectors]) for at in (0, -1))
            matrix = np.outer(one, two)
            if len(vectors[0]) > 1:
                matrix += matrix.T
            matrix *= np.kron(component.shared(side), np.ones((size, size)))
            if number >= len(FIXED):
                matrix *= again
            sizes = np.array([component.in_means(p.plane) for p in self.planes])
            found.append(_Term(component, number < len(FIXED), matrix, sizes))
        return found

    def add_to(
        self,
        found: Evaluation,
        theta: Array,
        recorded: Sequence[Records],
    ) -> None:
        """Add what mean images say. recorded : of each plane, records at theta."""
        for block, one, records in self._each(theta, recorded):
            is_positive = found.add_wishart(
                block.products,
                block.freedom,
                one.whole,
                *_slopes_of(block, one, records),
                block.noise_share[:, None] * records.slopes.variance
                + records.slopes.steps,
            )
            if not is_positive:
                return

    def covariances(
        self, theta: Array, recorded: Sequence[Records]
    ) -> Iterator[tuple[Block, Array]]:
        """Yield each block with its covariance, (N, N) DN^2. recorded : as above."""
        return ((block, one.whole) for block, one, _ in self._each(theta, recorded))

    def _each(
        self, theta: Array, recorded: Sequence[Records]
    ) -> Iterator[tuple[Block, _Covariance, Records]]:
        known: dict[Sequence[int], Records] = {}
        for block in self.blocks:
            if block.planes not in known:
                known[block.planes] = joined([recorded[n] for n in block.planes])
            records = known[block.planes]
            yield block, self._covariance(block, theta, records), records

    def _noise_share(self, part: int, sites: Sequence[int]) -> Array:
        share = [1 + self.planes[site].correlation[:, part] for site in sites]
        return np.concatenate(share) / np.tile(self.planes[0].frames, len(share))

    def _covariance(self, block: Block, theta: Array, records: Records) -> _Covariance:
        noise, steps = records.values.variance, records.values.steps
        response, lines = _responses(block, records.values)
        terms, count, size = block.terms, block.fixed, len(noise)
        if (lines != 1).any() or (response != 1).any():
            scales = np.array([np.outer(one, one) for one in (response, lines)])
            terms = terms * np.repeat(scales, (count, len(terms) - count), axis=0)
        values, flat = theta[block.places], terms.reshape(len(terms), -1)
        return _Covariance(
            np.diag(block.noise_share * noise + steps) + block.neighbours,
            terms,
            (values[:count] @ flat[:count]).reshape(size, size),
            (values[count:] @ flat[count:]).reshape(size, size),
        )


def _slopes_of(
    block: Block, one: _Covariance, records: Records
) -> tuple[Array, NDArray[np.int64]]:
    """Return (K, N, N) slopes of a covariance by parameters, and their places: of its
    terms, and of what responses depend on."""
    values = _responses(block, records.values)
    slopes = _responses(block, records.slopes)
    if not any(by.any() for by in slopes):
        return one.terms, block.places
    moved = np.flatnonzero(sum(by.any(axis=0) for by in slopes))
    places = np.union1d(block.places, moved)
    each = np.zeros((len(places), *one.rest.shape))
    each[np.searchsorted(places, block.places)] = one.terms
    for value, by, of in zip(values, slopes, (one.patterns, one.moving), strict=True):
        relative = by[:, moved] / value[:, None]
        terms = relative.T[:, :, None] * of
        each[np.searchsorted(places, moved)] += terms + terms.swapaxes(1, 2)
    return each, places


def _responses(block: Block, known: Recording[Array]) -> tuple[Array, Array]:
    """Return by how much the patterns of a part are recorded, and what moves it."""
    patterns = known.fixed if block.part == PIXEL else known.places
    return patterns, known.rows if ROWS[block.part] else known.columns


def low_of(plane: PlaneStatistics, site: int, side: int) -> Array:
    """Return (G, degrees down, degrees across), the coefficients of polynomials of mean
    images; none of both, rows and columns, is above FIELD. Their places are those of
    the middle of the CFA's repeat: the first is what that adds to the level.

    site : of the plane in it. side : px."""
    h, w = plane.shape
    down, across = polynomials(h), polynomials(w)
    found: Array = np.zeros((len(plane.rows), len(down), len(across)))
    found[:, 1:, 0] = plane.rows @ down[1:].T * np.sqrt(w)
    found[:, 0, 1:] = plane.columns @ across[1:].T * np.sqrt(h)
    of_field = found[:, 1 : FIELD + 1, 1 : FIELD + 1]
    of_field[:] = plane.field[:, : of_field.shape[1], : of_field.shape[2]]
    moved = _moved(plane.shape, site, side)
    return np.asarray(np.einsum("jk,gkl,ml->gjm", moved[0], found, moved[1]))


def _moved(shape: tuple[int, int], site: int, side: int) -> list[Array]:
    """Return what makes coefficients of a plane those of the middle of the repeat."""
    return [
        moved_by(length, (of - (side - 1) / 2) / side)
        for length, of in zip(shape, divmod(site, side), strict=True)
    ]


def moved_noise(shape: tuple[int, int], site: int, side: int) -> Array:
    """Return (degrees down, degrees across), the variance that coefficients have when
    moved as in low_of, of 1 before: more where planes are of few samples."""
    down, across = _moved(shape, site, side)
    used = np.zeros((len(down), len(across)))
    used[1:, 0] = used[0, 1:] = used[1 : FIELD + 1, 1 : FIELD + 1] = 1.0
    return np.asarray(np.square(down) @ used @ np.square(across).T)


def coefficients_of(plane: PlaneStatistics, site: int, side: int) -> list[Array]:
    """Return (G, n) coefficients of each part but pixel, in the order of PARTS; all
    have the noise of a sample."""
    h, w = plane.shape
    down, across = polynomials(h)[1:], polynomials(w)[1:]
    rows, columns = plane.rows * np.sqrt(w), plane.columns * np.sqrt(h)
    low = low_of(plane, site, side) / np.sqrt(moved_noise(plane.shape, site, side))
    of_rows, of_columns = low[:, 1:, 0], low[:, 0, 1:]
    found = {
        "smooth_rows": of_rows[:, :SMOOTH],
        "smooth_columns": of_columns[:, :SMOOTH],
        "slow_rows": of_rows[:, SMOOTH:],
        "slow_columns": of_columns[:, SMOOTH:],
        "fast_rows": rows - rows @ down.T @ down,
        "fast_columns": columns - columns @ across.T @ across,
        "field": low[:, 1 : FIELD + 1, 1 : FIELD + 1].reshape(len(low), -1),
    }
    return [found[part] for part in PARTS[:PIXEL]]


def middle_of(
    plane: PlaneStatistics, low: Array, degree: int | None
) -> tuple[Array, float]:
    """Return (G,) DN, how far the middle of the frame is above its mean, of what low_of
    returns; and of how many samples its variance is the mean.

    degree : the highest, of rows and of columns alone; None for all that is known."""
    here = []
    for length in plane.shape:
        around = polynomials(length)[:, [(length - 1) // 2, length // 2]]
        here.append(around.mean(axis=1))
    both = np.outer(*here)
    used, end = np.zeros(both.shape, bool), degree and degree + 1
    used[1:end, 0] = used[0, 1:end] = True
    if degree is None:
        used[1 : FIELD + 1, 1 : FIELD + 1] = True
    found: Array = np.einsum("gjk,jk->g", low, both * used)
    return found, 1 / float((both[used] ** 2).sum())


@lru_cache(maxsize=64)  # each likelihood of the same frames asks for the same
def moved_by(length: int, by: float) -> Array:
    """Return (degrees, degrees), what makes coefficients of polynomials over samples
    those of the same curve where the samples lie @by samples farther on."""
    low = polynomials(length)
    degree = len(low) - 1
    along = np.arange(length)
    curves = [Legendre.fit(along, one, degree) for one in low]
    before = [curve(along - by) for curve in curves]
    return np.asarray(low @ np.array(before).T)
