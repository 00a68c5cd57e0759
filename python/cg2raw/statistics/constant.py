# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What darks and flats say, as small arrays: no pixel is looked at again after them.

Each plane of the CFA's repeat is split into orthogonal parts (PARTS). Coefficients of a
part are scaled so that their squares sum to those of the samples (Parseval): rows and
columns are means times the root of how many samples they are of.
"""

import json
import math
import os
import zlib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cache, cached_property
from io import BytesIO
from typing import Any, Literal, NamedTuple
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from cg2raw.io.atomic_file import write_atomically
from cg2raw.normal import FEWEST_COUNT
from cg2raw.statistics.patterns import Lattice, Spots

Array = NDArray[np.float64]

VERSION = 7  # of saved files
DAMAGED = (AttributeError, EOFError, KeyError, TypeError, ValueError)  # what they raise
WHOLE = ("frames", "pairs", "lags", "transients", "overlaps")  # of no plane

# Of a plane, in DN and in DN^2.
OF_LEVELS = ("rows", "columns", "field", "places", "outliers")
OF_SQUARES = ("whole", "scatter", "power", "noise", "outlier_noise")

SMOOTH, SLOW, FIELD = 3, 11, 5  # highest degrees of polynomials
PARTS = (
    "smooth_rows",  # polynomials of degree 1 to SMOOTH down the columns
    "smooth_columns",
    "slow_rows",  # SMOOTH + 1 to SLOW
    "slow_columns",
    "fast_rows",  # the rest of the row means
    "fast_columns",
    "field",  # products of polynomials down and across, 1 to FIELD each
    "pixel",  # all that is left
)
PIXEL = PARTS.index("pixel")
# Rows and columns to a neighbour.
LAGS = ((0, 1), (1, 0), (0, 2), (2, 0), (1, 1), (2, 2))
BINS_PER_SIGMA = 32  # of the histogram of residuals, which has 512 bins
BLOCKS = 8  # along each side of a plane
POINT_SIGMAS = 8.0  # beyond which a sample is masked: of a million, none is by chance
PLACES = np.linspace(0.02, 0.98, 25)  # quantiles of the smooth part of a mean image
MOST_LINES = 256  # along each side, of which the quantiles are taken
# Bins of dark rates over their noise; as fine as their laws, out to all that can be.
RATE_SIDE = np.geomspace(0.25, 1e5, 121)
RATE_EDGES = np.concatenate([-RATE_SIDE[::-2], RATE_SIDE])


@dataclass(frozen=True)
class GroupInfo:
    """Frames of one kind, exposure time, temperature and light that repeat each other.

    split : "training", "validation", "test", or "" where there are none.
    exposure_time : s. temperature : degrees Celsius. frames : names. warmth : of each,
    how much faster charge gathers in it than at the temperature of all, () where no
    frame differs. warmth_error : standard deviation of each."""

    kind: Literal["dark", "flat"]
    frames: tuple[str, ...]
    exposure_time: float | None = None
    temperature: float | None = None
    split: str = ""
    warmth: tuple[float, ...] = ()
    warmth_error: float = 0.0

    @property
    def charge_time(self) -> float:
        """Mean of frames, s at the temperature of all in which as much charge gathers;
        0 where the exposure time is not known."""
        return (self.exposure_time or 0.0) * float(np.mean(self.warmth or 1.0))


@dataclass(frozen=True)
class PlaneStatistics:
    """Of one plane of the CFA's repeat, h x w samples, in G groups.

    freedom : (8,) degrees of freedom of each part, masked samples taken off.
    level : (G,) DN, of the mean images. levels : of each group, (frames,) DN.
    rows, columns : (G, h), (G, w) DN, means of the mean images less their level.
    field : (G, 5, 5) coefficients. whole : (G, G) DN^2, inner products of the mean
    images less their levels. scatter : (G, 8) DN^2, sums of squares of the frames'
    coefficients about those of their mean: freedom * (frames - 1) of them.
    power : (G,) DN^2, variance of a frame by the pixel part of (a - b) / sqrt(2) over
    disjoint pairs of frames; nan without pairs. fourth : (G,) mean fourth power of the
    pairs' residuals over the square of their mean square. residuals : (G, 512) how many
    there are, by their size in 1 / BINS_PER_SIGMA of the root of their pair's power;
    the last of them are all above.
    places : (G, 25) DN, quantiles (PLACES) of what all parts but pixel say of the mean
    image, less its level, on a grid of at most MOST_LINES lines.
    low, high : (G,) shares of samples at 0 and at white or above.
    noise : (G, 64) DN^2, sums of the squares of pairs' residuals, by BLOCKS x BLOCKS
    blocks. codes : (G, codes) how many samples have each. masked : (h, w) bool.
    outliers : (G, masked) DN, what masked samples of the mean images are beyond those
    around, in raster order. outlier_noise : (G, masked) DN^2, mean squares of their
    pairs' residuals; nan without pairs."""

    freedom: Array
    level: Array
    levels: tuple[Array, ...]
    rows: Array
    columns: Array
    field: Array
    whole: Array
    scatter: Array
    power: Array
    fourth: Array
    residuals: NDArray[np.int64]
    places: Array
    low: Array
    high: Array
    noise: Array
    codes: NDArray[np.uint32]
    masked: NDArray[np.bool_]
    outliers: NDArray[np.float32]
    outlier_noise: NDArray[np.float32]

    @property
    def shape(self) -> tuple[int, int]:
        return self.rows.shape[1], self.columns.shape[1]

    @cached_property
    def unmasked(self) -> int:
        """How many samples are not masked."""
        return int(np.count_nonzero(~self.masked))

    @cached_property
    def in_lines(self) -> NDArray[np.bool_]:
        """(h, w) which samples are in a row or column that is masked as a whole."""
        rows = np.asarray(self.masked.all(axis=1))
        return rows[:, None] | np.asarray(self.masked.all(axis=0))

    @cached_property
    def left(self) -> float:
        """The share of samples, in no masked line, that are not masked. Mean images are
        filled in by what the others say: in all parts but pixel, noise grows by its
        reciprocal, structure is as it was."""
        return 1 - float(self.masked[~self.in_lines].mean())

    def left_in(self, part: int) -> float:
        """Return the share of what a coefficient of one of PARTS is of: means of lines
        lack the samples in masked lines that run across them, too."""
        axis = {"rows": 1, "columns": 0}.get(PARTS[part].rpartition("_")[2])
        return self.left * (1.0 if axis is None else self.copies.open_lines[axis])

    @cached_property
    def copies(self) -> "Copies":
        """What masked lines are in mean images."""
        return Copies.of(*(np.asarray(self.masked.all(axis=n)) for n in (1, 0)))

    @cached_property
    def count(self) -> Array:
        """(8,) coefficients of each part but pixel."""
        return np.asarray(self.freedom * self.masked.size / max(self.unmasked, 1))

    @cached_property
    def freedom_of_means(self) -> Array:
        """(8,) degrees of freedom of coefficients of mean images."""
        found = self.count * self.left * self.copies.freedom
        found[PIXEL] = self.freedom[PIXEL]
        return np.asarray(found)

    @cached_property
    def mean_noise(self) -> Array:
        """(8,) how many times a sample's noise coefficients of mean images have."""
        found = self.copies.noise / [self.left_in(part) for part in range(len(PARTS))]
        found[PIXEL] = 1.0
        return np.asarray(found)

    def smooth(self, number: int) -> Array:
        """Return (h, w) DN, what all parts but pixel say of a group's mean image:
        masked samples and lines have no part in it."""
        one = slice(number, number + 1)
        smooth = smooth_images(self.rows[one], self.columns[one], self.field[one])
        found: Array = smooth[0] + self.level[number]
        return found

    @cached_property
    def products(self) -> Array:
        """(8, G, G) DN^2: inner products of the mean images, part by part."""
        h, w = self.shape
        down, across = polynomials(h)[1:], polynomials(w)[1:]
        rows, columns = self.rows * np.sqrt(w), self.columns * np.sqrt(h)
        smooth, slow, fast = zip(
            of_profiles(rows, down), of_profiles(columns, across), strict=True
        )
        field = self.field.reshape(len(self.field), -1)
        low = np.array([*smooth, *slow, *fast, field @ field.T])
        found: Array = np.concatenate([low, self.whole[None] - low.sum(axis=0)])
        return found


@dataclass(frozen=True)
class DarkRates:
    """Of a split's darks: how many samples have which slope over exposure time, beyond
    what the parts say of those around.

    counts : (bins,) by RATE_EDGES, in units of noise. noise : DN/s, of one
    sample, temporal and of what the parts say. charge : 1/s, by which the square of
    the noise grows with gain * rate, (DN/s)^2."""

    split: str
    counts: NDArray[np.int64]
    noise: float
    charge: float

    def shot(self, gain: float) -> float:
        """Return by how much the square of the noise grows with the rate, both in units
        of noise. gain : DN^2 of noise for each DN of charge."""
        return gain * self.charge / self.noise


@dataclass(frozen=True)
class ConstantStatistics:
    """Of groups of frames: planes in raster order of the CFA's square repeat.

    frames, pairs : (G,) counts. lags : (G, 6) correlations of the residuals of pairs
    with those of neighbours in the mosaic (LAGS), 0 without pairs. white : DN.
    transients : (G, F, 2) of the F frames of the largest group: how many samples each
    has alone, more than POINT_SIGMAS above the mean of the others or below it, where
    that is as in the surroundings; a hot pixel's noise is none.
    overlaps : (G, G) how many samples, not masked, are beyond 4 sigma in some pair of
    the one group and in some of the other. mean_of : gives the (H, W) DN mean image of
    a group by its number, without transients, each time a new one. excluded : (H, W)
    samples that count in nothing; None where all count. rates : of splits whose darks
    have several exposure times. lattice, spots : whose samples are masked as well; of
    all flats."""

    groups: tuple[GroupInfo, ...]
    planes: tuple[PlaneStatistics, ...]
    frames: NDArray[np.int64]
    pairs: NDArray[np.int64]
    lags: Array
    white: int
    transients: NDArray[np.int64]
    overlaps: NDArray[np.int64]
    mean_of: Callable[[int], NDArray[np.float32]] = field(repr=False)
    excluded: NDArray[np.bool_] | None = field(default=None, repr=False)
    rates: tuple[DarkRates, ...] = ()
    lattice: Lattice | None = None
    spots: Spots | None = None

    @property
    def side(self) -> int:
        """Samples along the CFA's repeat."""
        return math.isqrt(len(self.planes))

    @property
    def unmasked(self) -> int:
        """How many samples are not masked, of all planes."""
        return sum(plane.unmasked for plane in self.planes)

    @cached_property
    def is_flat(self) -> NDArray[np.bool_]:
        """(G,) which groups are of light."""
        return np.array([group.kind == "flat" for group in self.groups], bool)

    @cached_property
    def splits(self) -> NDArray[np.str_]:
        """(G,) of each group."""
        return np.array([group.split for group in self.groups], str)

    @cached_property
    def dark_codes(self) -> int:
        """How many codes darks have, of enough samples that their number tells, in the
        plane of a split that has fewest."""
        counts = [
            plane.codes[~self.is_flat & (self.splits == split)].sum(axis=0)
            for split in np.unique(self.splits[~self.is_flat])
            for plane in self.planes
        ]
        return min((int((n >= FEWEST_COUNT).sum()) for n in counts), default=0)

    def darks_by_time(self, split: str | None = None) -> list[NDArray[np.intp]]:
        """Return the numbers of darks that repeat each other, of each exposure time,
        the shortest first. split : of whose groups; None for all."""
        used = ~self.is_flat & (self.pairs > 0)
        if split is not None:
            used &= self.splits == split
        darks = np.flatnonzero(used)
        times = np.array([self.groups[n].exposure_time or 0.0 for n in darks], float)
        return [darks[times == time] for time in np.unique(times)]

    def shortest_darks(self, split: str | None = None) -> NDArray[np.intp]:
        """Return those of the shortest exposure time, none without any."""
        return next(iter(self.darks_by_time(split)), np.zeros(0, np.intp))

    def masked(self, shape: tuple[int, int]) -> NDArray[np.bool_]:
        """Return (H, W), which samples are masked, of frames of a shape, whose last
        lines may be in none of the planes."""
        side, found = self.side, np.zeros(shape, bool)
        for site, plane in enumerate(self.planes):
            row, column = divmod(site, side)
            h, w = plane.masked.shape
            found[row : side * h : side, column : side * w : side] = plane.masked
        return found

    def of_splits(self, splits: Collection[str]) -> "ConstantStatistics":
        """Return the statistics of the groups of splits."""
        groups = enumerate(self.groups)
        return self.only([n for n, group in groups if group.split in splits])

    def only(self, numbers: Sequence[int]) -> "ConstantStatistics":
        """Return the statistics of some of the groups."""
        at = list(numbers)
        planes = []
        for plane in self.planes:
            given = {one.name: getattr(plane, one.name) for one in fields(plane)}
            for name in given.keys() - {"freedom", "masked", "levels", "whole"}:
                given[name] = given[name][at]
            given["levels"] = tuple(plane.levels[n] for n in at)
            given["whole"] = plane.whole[np.ix_(at, at)]
            planes.append(PlaneStatistics(**given))
        whole = {name: getattr(self, name)[at] for name in WHOLE}
        whole["overlaps"] = whole["overlaps"][:, at]
        groups = tuple(self.groups[n] for n in at)
        splits = {group.split for group in groups}
        return ConstantStatistics(
            groups=groups,
            planes=tuple(planes),
            white=self.white,
            mean_of=lambda number: self.mean_of(at[number]),
            excluded=self.excluded,
            rates=tuple(one for one in self.rates if one.split in splits),
            lattice=self.lattice,
            spots=self.spots,
            **whole,
        )

    def variance(self, number: int, part: str = "pixel") -> Array:
        """Return (planes,) DN^2, of a group: what a coefficient of one of PARTS varies
        by from frame to frame; of a single frame what its coefficients do, patterns
        included. nan where no sample is left to tell."""
        at, again = PARTS.index(part), int(self.frames[number]) - 1
        freedom = np.array([plane.freedom[at] or np.nan for plane in self.planes])
        if again:
            squares = [plane.scatter[number, at] / again for plane in self.planes]
        else:
            squares = [plane.products[at, number, number] for plane in self.planes]
        found: Array = np.array(squares) / freedom
        return found

    def block_levels(self, number: int) -> Array:
        """Return (planes, 64) DN, means of a group's mean image in BLOCKS x BLOCKS
        blocks, row by row, without what single pixels have."""
        found = []
        for plane in self.planes:
            down, across = (_blocks(length) for length in plane.shape)
            down, across = (
                each / np.maximum(each.sum(axis=1, keepdims=True), 1)
                for each in (down, across)
            )
            rows = down @ plane.rows[number]
            columns = across @ plane.columns[number]
            low = [
                polynomials(length)[1 : FIELD + 1] @ each.T
                for length, each in zip(plane.shape, (down, across), strict=True)
            ]
            field = plane.field[number, : len(low[0]), : len(low[1])]
            level = plane.level[number] + low[0].T @ field @ low[1]
            found.append((level + rows[:, None] + columns).ravel())
        return np.array(found)

    def block_noise(self, number: int) -> tuple[Array, Array]:
        """Return (planes, 64) DN^2, variances of a frame by pairs of a group without
        rows' and columns' own noise, and the relative error of each, far above 1 where
        all is masked."""
        pairs, left, pixels = int(self.pairs[number]), [], []
        for plane in self.planes:
            down, across = (_blocks(length) for length in plane.shape)
            pixels.append((down @ ~plane.masked @ across.T).ravel())
            # Row and column means and the field took their part of the squares along.
            left.append(pixels[-1] * plane.freedom[PIXEL] / max(pixels[-1].sum(), 1))
        variances = np.array([plane.noise[number] for plane in self.planes])
        errors = np.sqrt(2 / (np.maximum(pixels, 1e-3) * pairs))
        return variances / np.maximum(np.array(left) * pairs, 1e-9), errors

    def in_steps(self, step: int, offset: int) -> "ConstantStatistics":
        """Return the same in units of steps from the lowest code: where codes are
        @offset and steps of @step DN above it. Rates of dark current go."""
        planes = []
        for plane in self.planes:
            scaled = {name: getattr(plane, name) / step for name in OF_LEVELS}
            scaled |= {name: getattr(plane, name) / step**2 for name in OF_SQUARES}
            codes = plane.codes[:, offset::step]
            scaled["low"] = codes[:, 0] / codes.sum(axis=1)
            levels = tuple((levels - offset) / step for levels in plane.levels)
            level = (plane.level - offset) / step
            one = replace(plane, level=level, levels=levels, codes=codes, **scaled)
            planes.append(one)
        return replace(
            self,
            planes=tuple(planes),
            white=(self.white - offset) // step,
            mean_of=lambda n: (self.mean_of(n) - np.float32(offset)) / np.float32(step),
            rates=(),
        )

    def save(
        self, path: str | os.PathLike[str], facts: Mapping[str, str] | None = None
    ) -> None:
        """Write all of it to an .npz file, whole or not at all: four bytes a pixel and
        group, and up to half as many more. Raises OSError.

        facts : of what it is measured, in any words, by names of frames."""
        arrays = {name: getattr(self, name) for name in WHOLE}
        about = {
            "version": VERSION,
            "white": self.white,
            "groups": [asdict(group) for group in self.groups],
            "facts": dict(facts or {}),
        }
        for number in range(len(self.groups)):
            arrays[f"mean {number}"] = self.mean_of(number)
        if self.excluded is not None:
            arrays["excluded"] = self.excluded
        about["rates"] = [[one.split, one.noise, one.charge] for one in self.rates]
        about["lattice"] = asdict(self.lattice) if self.lattice else None
        about["tried"] = self.spots.tried if self.spots else None
        if self.spots:
            arrays["spots"] = self.spots.places
        if self.rates:
            arrays["rates"] = np.array([one.counts for one in self.rates])
        arrays["about"] = np.array(json.dumps(about))
        for p, plane in enumerate(self.planes):
            for one in fields(plane):
                value = getattr(plane, one.name)
                if one.name == "levels":
                    value = np.concatenate(value)
                arrays[f"{p}.{one.name}"] = value
        room = BytesIO()
        np.savez(room, allow_pickle=False, **arrays)
        write_atomically(path, room.getvalue())

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], facts: Mapping[str, str] | None = None
    ) -> "ConstantStatistics":
        """Return what save wrote. Raises OSError, and ValueError for another file, or
        other facts than it was saved with, where they are given."""
        try:
            with np.load(path, allow_pickle=False) as file:
                found = {name: file[name] for name in file.files}
            about = json.loads(str(found.pop("about")))
            if (version := about["version"]) == VERSION:
                whole = cls._of(found, about)
        except (*DAMAGED, BadZipFile, zlib.error):
            raise ValueError(
                f"{path}: no statistics of frames, or a damaged file: name another"
            ) from None
        if version != VERSION:
            raise ValueError(
                f"{path}: statistics of version {version}; must be {VERSION}: remove "
                "the file, and measure the frames again"
            )
        kept: Mapping[str, str] = about["facts"]
        facts = kept if facts is None else facts
        for name in {**kept, **facts}:
            if kept.get(name) != facts.get(name):
                raise ValueError(
                    f"{path}: statistics of other frames: {name} has changed; remove "
                    "the file, or name another"
                )
        return whole

    @classmethod
    def _of(cls, found: dict[str, Any], about: dict[str, Any]) -> "ConstantStatistics":
        """Return what arrays of a file say."""
        lists = ("frames", "warmth")
        groups = tuple(
            GroupInfo(**{**one, **{name: tuple(one[name]) for name in lists}})
            for one in about["groups"]
        )
        whole = {name: found.pop(name) for name in WHOLE}
        whole["excluded"] = found.pop("excluded", None)
        means = [found.pop(f"mean {number}") for number in range(len(groups))]
        counts = found.pop("rates", ())
        places = found.pop("spots", None)
        rates = tuple(
            DarkRates(split, of_split, noise, charge)
            for (split, noise, charge), of_split in zip(
                about["rates"], counts, strict=True
            )
        )
        ends = np.cumsum(whole["frames"])[:-1]
        planes: dict[str, dict[str, Any]] = {}
        for name, value in found.items():
            plane, field = name.split(".")
            is_levels = field == "levels"
            planes.setdefault(plane, {})[field] = (
                tuple(np.split(value, ends)) if is_levels else value
            )
        parts = tuple(PlaneStatistics(**planes[str(p)]) for p in range(len(planes)))
        return cls(
            groups=groups,
            planes=parts,
            white=int(about["white"]),
            mean_of=lambda number: means[number].copy(),
            rates=rates,
            lattice=Lattice(**about["lattice"]) if about["lattice"] else None,
            spots=None if places is None else Spots(places, about["tried"]),
            **whole,
        )


def _blocks(length: int) -> Array:
    """Return (BLOCKS, length), 1 where a sample along a side is in a block."""
    block = ((np.arange(length) + 1) * BLOCKS - 1) // length
    return np.equal.outer(np.arange(BLOCKS), block).astype(float)


def lines_of_mosaic(profiles: Sequence[Array], across: bool) -> Array:
    """Return (..., side * N), profiles of the mosaic: a line of it runs through as many
    planes as its repeat has sites along it. profiles : of each plane, (..., N), its
    columns if across, else its rows."""
    side = math.isqrt(len(profiles))
    *shape, count = profiles[0].shape
    found = np.zeros((*shape, side * count))
    for site, own in enumerate(profiles):
        first = site % side if across else site // side
        found[..., first::side] += own / side
    return found


def smooth_images(
    rows: Array,
    columns: Array,
    field: Array,
    y: slice = slice(None),
    x: slice = slice(None),
) -> Array:
    """Return (G, h, w) DN, what all parts but pixel say of mean images less levels.

    rows, columns, field : as of PlaneStatistics. y, x : the lines that are wanted."""
    down, across = (
        polynomials(profiles.shape[1])[1 : FIELD + 1] for profiles in (rows, columns)
    )
    field = field[:, : len(down), : len(across)]
    found: Array = down[:, y].T @ field @ across[:, x]
    found += rows[:, y, None]
    found += columns[:, None, x]
    return found


@cache
def polynomials(length: int) -> Array:
    """Return (degrees + 1, length) orthonormal polynomials; fewer than SLOW of a short
    side, which keeps half of its freedom."""
    degree = min(SLOW, (length - 1) // 2)
    along = np.linspace(-1, 1, length) if length > 1 else np.zeros(1)
    found, _ = np.linalg.qr(np.polynomial.legendre.legvander(along, degree))
    found = np.asarray((found * np.sign(found[-1])).T)
    found.flags.writeable = False
    return found


def of_profiles(profiles: Array, low: Array) -> tuple[Array, Array, Array]:
    """Return (G, G) inner products of (G, N) profiles: smooth, slow and fast.

    low : (degrees, N) polynomials without the constant."""
    found = profiles @ low.T
    smooth = found[:, :SMOOTH] @ found[:, :SMOOTH].T
    slow = found[:, SMOOTH:] @ found[:, SMOOTH:].T
    return smooth, slow, profiles @ profiles.T - smooth - slow


class Copies(NamedTuple):
    """Of mean images, whose masked lines are copies of the nearest that is not masked,
    the first of two: by how much noise of the parts grows, (8,), and the share of their
    freedom that is left, (8,), both 1 without; by how much that of the level grows; the
    shares of rows and of columns that are no copies. Fields go on over masked lines."""

    noise: Array
    freedom: Array
    level: float
    open_lines: tuple[float, float]

    @classmethod
    def of(cls, rows: NDArray[np.bool_], columns: NDArray[np.bool_]) -> "Copies":
        """Return those of a plane. rows, columns : which are masked."""
        down, across = _copied(rows), _copied(columns)
        each = {f"{part}_rows": sums for part, sums in down.items()}
        each |= {f"{part}_columns": sums for part, sums in across.items()}
        open_lines = float(1 - rows.mean()), float(1 - columns.mean())
        others = np.array([1.0, 1.0 / math.prod(open_lines), 1.0])
        sums = np.array([each.get(part, others) for part in PARTS])
        trace, squares, count = np.where(sums[:, 2:], sums, 1.0).T
        level = float((down["level"] * across["level"])[0])
        return cls(trace / count, trace**2 / squares / count, level, open_lines)


def _copied(masked: NDArray[np.bool_]) -> dict[str, Array]:
    """Return (3,) of coefficients of a profile: the trace of their covariance in units
    of a line's noise, that of its square, and how many they are.

    masked : (N,) which lines are copies."""
    lines, low = np.arange(len(masked)), polynomials(len(masked))
    others = np.flatnonzero(~masked)
    after = np.searchsorted(others, lines).clip(max=len(others) - 1)
    before = (after - 1).clip(min=0)
    is_before = lines - others[before] <= others[after] - lines
    nearest = others[np.where(is_before, before, after)]
    times = np.bincount(nearest, minlength=len(masked))
    summed = np.zeros_like(low)
    np.add.at(summed.T, nearest, low.T)
    whole = summed @ summed.T
    parts = {
        "level": slice(1),
        "smooth": slice(1, SMOOTH + 1),
        "slow": slice(SMOOTH + 1, None),
    }
    found = {}
    for name, part in parts.items():
        own = whole[part, part]
        found[name] = np.array([own.trace(), (own**2).sum(), len(own)])
    squares = (times**2).sum() - 2 * ((summed * times) * summed).sum()
    fast = len(masked) - whole.trace(), squares + (whole**2).sum()
    found["fast"] = np.array([*fast, len(masked) - len(low)])
    return found
