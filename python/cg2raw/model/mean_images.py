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
    TEMPORAL,
    Component,
)
from cg2raw.model.correlation import neighbours
from cg2raw.model.evaluation import Evaluation, Parameters
from cg2raw.model.planes import PlaneLikelihood, less_of, waves
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

    products : (N, N) DN^2, mean over its freedom. fixed, temporal : (K, N, N), what one
    unit of the parameters at fixed_places, temporal_places adds to the covariance;
    temporal for one frame of each. neighbours : (N, N) DN^2, covariance by correlation
    of noise with that of neighbours in other planes."""

    part: int
    planes: Sequence[int]
    freedom: float
    products: Array
    fixed: Array
    fixed_places: NDArray[np.int64]
    temporal: Array
    temporal_places: NDArray[np.int64]
    neighbours: Array


class _Covariance(NamedTuple):
    """Of a block at some parameters: the covariance, (N, N), what one unit of its fixed
    and temporal parameters adds, the slopes of its diagonal by all, and its records."""

    covariance: Array
    fixed: Array
    temporal: Array
    diagonal: Array
    records: Array
    slopes: Array


class MeanImageLikelihood:
    """The products of the mean images of all planes."""

    def __init__(
        self,
        planes: Sequence[PlaneLikelihood],
        parameters: Parameters,
        statistics: ConstantStatistics,
    ) -> None:
        self.planes, self.parameters = planes, parameters
        self.statistics = statistics
        everything = list(range(len(planes)))
        chosen = [(part, everything) for part in range(PIXEL)]
        chosen += [(PIXEL, [site]) for site in everything]
        side = planes[0].side
        coefficients = [
            coefficients_of(plane.plane, divmod(site, side), side)
            for site, plane in enumerate(planes)
        ]
        self.blocks = []
        for part, sites in chosen:
            freedom = float(np.mean([planes[s].plane.freedom[part] for s in sites]))
            if freedom <= 0:
                continue
            freedom_left = freedom * self._unlike(part)
            if part == PIXEL:
                products = planes[sites[0]].products[PIXEL]
            else:
                stacked = np.concatenate([coefficients[s][part] for s in sites])
                products = stacked @ stacked.T / freedom * self._left(part, sites) ** 2
            self.blocks.append(self._block(part, sites, freedom_left, products))

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

    def _left(self, part: int, sites: Sequence[int]) -> float:
        each = [self.planes[site].plane.left_in(part) for site in sites]
        return float(np.mean(each))

    def _block(
        self, part: int, sites: Sequence[int], freedom: float, products: Array
    ) -> Block:
        terms = []
        for components in (FIXED, TEMPORAL):
            used = [c for c in components if c.parts[part]]
            each = [self._term(c, part, sites) for c in used]
            places = np.array([self.parameters.of(c.name) for c in used], int)
            terms += [np.array(each).reshape(len(used), *products.shape), places]
        frames = np.tile(np.arange(len(self.planes[0].frames)), len(sites))
        terms[2] *= np.equal.outer(frames, frames)
        near = self._neighbours(part, sites)
        return Block(
            part, sites, freedom, products, terms[0], terms[1], terms[2], terms[3], near
        )

    def _neighbours(self, part: int, sites: Sequence[int]) -> Array:
        """Return (N, N) DN^2, as measured; a sample has neighbours on both sides."""
        first, count = self.planes[0], len(self.planes[0].frames)
        found = np.zeros((len(sites), count, len(sites), count))
        groups, places = np.arange(count), np.divmod(sites, first.side)
        for down, across, even in ((0, 1, EVEN_ACROSS), (1, 0, EVEN_DOWN)):
            near = neighbours(self.statistics, down, across)
            if near is None or first.side == 1 or not even[part]:
                continue
            for a, one in enumerate(zip(*places, strict=True)):
                other = (one[0] + down) % first.side, (one[1] + across) % first.side
                b = [*zip(*places, strict=True)].index(other)
                noise = [self.planes[sites[n]].scatter[:, PIXEL] for n in (a, b)]
                covariance = near * np.sqrt(noise[0] * noise[1]) / first.frames
                found[a, groups, b, groups] += covariance
                found[b, groups, a, groups] += covariance
        return found.reshape(len(sites) * count, -1)

    def _term(self, component: Component, part: int, sites: Sequence[int]) -> Array:
        """Return (N, N), what one unit of a component adds to the covariance."""
        first = self.planes[0]
        of_part = float(component.multiplicity(*first.plane.shape)[part])
        if part != PIXEL and not component.parts.all():  # structure has no noise
            of_part *= self._left(part, sites)
        shared = component.shared(first.side)[np.ix_(sites, sites)]
        found = [
            [
                shared[i, j] * self._signature(component, a, b)
                for j, b in enumerate(sites)
            ]
            for i, a in enumerate(sites)
        ]
        return of_part * np.block(found)

    def _signature(self, component: Component, a: int, b: int) -> Array:
        """Return (G, G), a component's share between the groups of two planes."""
        one, two = self.planes[a].vectors(component), self.planes[b].vectors(component)
        pairs = zip(one, two[::-1], strict=True)
        return np.asarray(sum(np.outer(x, y) for x, y in pairs))

    def add_to(
        self,
        found: Evaluation,
        theta: Array,
        recorded: Sequence[tuple[Array, Array]],
    ) -> None:
        """Add what mean images say. recorded : of each plane, records at theta."""
        for block in self.blocks:
            one = self._covariance(block, theta, recorded)
            misfit = found.add_wishart(
                block.products,
                block.freedom,
                one.covariance,
                np.concatenate([one.fixed, one.temporal]),
                np.concatenate([block.fixed_places, block.temporal_places]),
                one.diagonal,
            )
            if misfit is None:
                return
            # Responses move them, too: by too little for the information.
            patterns = np.tensordot(theta[block.fixed_places], one.fixed, 1)
            moving = np.tensordot(theta[block.temporal_places], one.temporal, 1)
            for by, of in ((3, patterns), (2, moving)):
                size, slopes = one.records[by], one.slopes[by]
                found.score += 2 * (misfit * of).sum(axis=0) / size @ slopes

    def covariances(
        self, theta: Array, recorded: Sequence[tuple[Array, Array]]
    ) -> Iterator[tuple[Block, Array]]:
        """Yield each block with its covariance, (N, N) DN^2. recorded : as above."""
        for block in self.blocks:
            yield block, self._covariance(block, theta, recorded).covariance

    def _covariance(
        self, block: Block, theta: Array, recorded: Sequence[tuple[Array, Array]]
    ) -> _Covariance:
        records = np.concatenate([recorded[s][0] for s in block.planes], axis=1)
        slopes = np.concatenate([recorded[s][1] for s in block.planes], axis=1)
        share = np.concatenate(
            [1 + self.planes[s].correlation[:, block.part] for s in block.planes]
        )
        over = np.tile(1.0 / self.planes[0].frames, len(block.planes))
        _, noise, lines, response, steps = records[:5]
        fixed = block.fixed * np.outer(response, response)
        temporal = block.temporal * np.outer(lines, lines) * over
        covariance = (
            np.tensordot(theta[block.fixed_places], fixed, 1)
            + np.tensordot(theta[block.temporal_places], temporal, 1)
            + np.diag(share * over * noise + steps)
            + block.neighbours
        )
        diagonal = (share * over)[:, None] * slopes[1] + slopes[4]
        return _Covariance(covariance, fixed, temporal, diagonal, records, slopes)


def low_of(plane: PlaneStatistics, site: tuple[int, int], side: int) -> Array:
    """Return (G, degrees down, degrees across), the coefficients of polynomials of mean
    images; none of both, rows and columns, is above FIELD. Their places are those of
    the middle of the CFA's repeat: the first is what that adds to the level.

    site : row and column of the plane's samples in it. side : px."""
    h, w = plane.shape
    down, across = polynomials(h), polynomials(w)
    found: Array = np.zeros((len(plane.rows), len(down), len(across)))
    found[:, 1:, 0] = plane.rows @ down[1:].T * np.sqrt(w)
    found[:, 0, 1:] = plane.columns @ across[1:].T * np.sqrt(h)
    of_field = found[:, 1 : FIELD + 1, 1 : FIELD + 1]
    of_field[:] = plane.field[:, : of_field.shape[1], : of_field.shape[2]]
    moved = [
        moved_by(length, (of - (side - 1) / 2) / side)
        for length, of in zip((h, w), site, strict=True)
    ]
    return np.asarray(np.einsum("jk,gkl,ml->gjm", moved[0], found, moved[1]))


def coefficients_of(
    plane: PlaneStatistics, site: tuple[int, int], side: int
) -> list[Array]:
    """Return (G, n) coefficients of each part but pixel, in the order of PARTS."""
    h, w = plane.shape
    down, across = polynomials(h)[1:], polynomials(w)[1:]
    rows, columns = plane.rows * np.sqrt(w), plane.columns * np.sqrt(h)
    low = low_of(plane, site, side)
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


def middle_of(plane: PlaneStatistics, low: Array) -> tuple[Array, float]:
    """Return (G,) DN, how far the middle of the frame is above its mean, of what low_of
    returns; and of how many samples its variance is the mean."""
    here = []
    for length in plane.shape:
        around = polynomials(length)[:, [(length - 1) // 2, length // 2]]
        here.append(around.mean(axis=1))
    both = np.outer(*here)
    used = np.zeros(both.shape, bool)
    used[1:, 0] = used[0, 1:] = True
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
