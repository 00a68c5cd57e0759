# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What one RAW frame looks like, in some numbers that do not grow with its size.

Luminance is of bins of the mosaic, at most 1024 along a side: so small that a change of
contrast, which changes their mean, hardly moves the median; white is where the sensor
clips. Its weights are those of Rec. 709 as the sensor's colour matrix sees them: a
change of saturation that keeps luminance keeps these levels."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import RawImage
from cg2raw.cfa import repeat_of, sites_of
from cg2raw.sensor import Sensor

Array = NDArray[np.float64]

ACROSS = 1024  # bins along the longer side, at most
ROWS = 16  # of bins, that are read at a time
COLOUR_CELL = 8, 1 / 256  # side of a cell of one colour, at least: pixels, of the frame
PROBABILITIES = (0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99)  # of quantiles
MIDDLE = PROBABILITIES.index(0.5)
REC709 = np.array([0.2126, 0.7152, 0.0722])
NEAR_WHITE = 0.99  # of the range, from which on a sample is clipped
CLIPPED_BIN = 0.05  # share of clipped samples from which on a bin is white
FLOOR_DN = 0.5  # a bin's luminance below which the black level's own error counts
LIT = 16  # times the floor: bins whose colour and contrast count
BANDS = 24  # rows of cells in which gradients and noise are measured
FLAT = 0.1  # share of cells, the flattest, in which noise is measured
CELL = 16  # repeats of the CFA along a side of a cell
THUMBNAIL = 16  # cells along a side of the small picture
UNKNOWN = np.nan


@dataclass(frozen=True)
class Frame:
    """What a frame looks like.

    quantiles : of luminance at PROBABILITIES, stops, 0 at white. black_bins, white_bins
    : shares of bins whose luminance is unknown, as they lie at the floor or are
    clipped. black, clipped : shares of samples at or below the black level, and at
    white. red, blue : median of log2 of R/G and B/G after white balance, stops.
    saturation : median of their length. sharpness : rms of gradients from one repeat of
    the CFA to the next over that over eight: 1/8 of ramps, 0.35 of edges, 1 where each
    repeat has its own light. noise : standard deviation where it is flat, of the square
    root of the signal over white: that of photons is the same at all levels. NaN where
    the frame does not show it. thumbnail : luminance of cells, stops, up to a constant;
    NaN where unknown."""

    name: str
    quantiles: Array
    black_bins: float
    white_bins: float
    black: float
    clipped: float
    red: float
    blue: float
    saturation: float
    sharpness: float
    noise: float
    thumbnail: NDArray[np.float16]

    @property
    def level(self) -> float:
        """Median luminance, stops."""
        return float(self.quantiles[MIDDLE])

    @property
    def contrast(self) -> float:
        """Stops between the quarters of luminance; NaN where one is unknown."""
        return self.between(0.25, 0.75)

    def between(self, low: float, high: float) -> float:
        """Return stops between two of PROBABILITIES; NaN if one is unknown."""
        if self.black_bins >= low or self.white_bins >= 1 - high:
            return UNKNOWN
        ends = [self.quantiles[PROBABILITIES.index(p)] for p in (low, high)]
        return float(ends[1] - ends[0])


@dataclass(frozen=True)
class Bins:
    """Means of the samples of each filter in bins, (h, w, 3), 0 at black and 1 at
    white, and shares of the frame's and of each bin's samples."""

    side: int  # pixels along a bin
    means: Array
    white: Array  # (h, w): of each bin
    black: float
    clipped: float


def look(
    name: str, plane: RawImage, sensor: Sensor, light: _core.Illuminant | None
) -> Frame:
    """Return what a frame of this sensor looks like.

    plane : (H, W) DN. light : of whose neutral the white is; None of a sensor without
    filters."""
    bins = binned(plane, sensor)
    balanced, weights = bins.means, np.array([0.0, 1.0, 0.0])
    if light is not None:
        balanced = bins.means / np.array(light.neutral)
        first = sensor.transform(f"neutral:{light.neutral[0]!r}:{light.neutral[2]!r}")
        weights = REC709 @ np.linalg.inv(first.first)
    luminance = balanced @ weights
    floor = floor_of(sensor)
    stops = np.log2(np.maximum(luminance, floor))
    is_white: NDArray[np.bool_] = bins.white > CLIPPED_BIN
    is_black = (luminance <= floor) & ~is_white
    side = bins.side, max(plane.shape)
    red, blue, saturation = colours(
        balanced, ~is_white & (luminance > LIT * floor), side
    )
    sharpness, noise = details(plane, sensor)
    return Frame(
        name,
        np.quantile(stops, PROBABILITIES),
        float(is_black.mean()),
        float(is_white.mean()),
        bins.black,
        bins.clipped,
        red,
        blue,
        saturation,
        sharpness,
        noise,
        thumbnail(np.where(is_white | is_black, UNKNOWN, stops)),
    )


def floor_of(sensor: Sensor) -> float:
    """Return the luminance, white at 1, below which that of a bin is unknown."""
    return FLOOR_DN / sensor.signal_range


def neutral_of_all(plane: RawImage, sensor: Sensor) -> tuple[float, float, float]:
    """Return (R/G, 1, B/G) of the mean of what is not clipped: the grey world."""
    bins = binned(plane, sensor)
    known = bins.means[bins.white <= CLIPPED_BIN]
    mean = known.mean(0) if len(known) else np.zeros(3)
    if not (mean > 0).all():
        return 1.0, 1.0, 1.0
    return float(mean[0] / mean[1]), 1.0, float(mean[2] / mean[1])


def binned(plane: RawImage, sensor: Sensor) -> Bins:
    """Return the Bins of a frame, some rows of them at a time."""
    side, sites = repeat_of(sensor.cfa), sites_of(sensor.cfa)
    count = max(1, math.ceil(max(plane.shape) / ACROSS / side))  # repeats along a bin
    step = count * side
    rows, cols = (length // step for length in plane.shape)
    black = np.resize(np.array(sensor.black_level, float), (side, side))
    span = sensor.white_level - black
    low, high = (
        np.tile(np.floor(level).astype(np.uint16), cols * count)
        for level in (black, black + NEAR_WHITE * span)
    )
    means = np.empty((rows, side, cols, side))
    white = np.zeros((rows, cols))
    total = 0
    for row in range(0, rows, ROWS):
        strip = plane[row * step : min(row + ROWS, rows) * step, : cols * step]
        strip = strip.reshape(-1, count, side, cols * step)
        sums = strip.sum(1, dtype=np.uint32).reshape(-1, side, cols, count, side)
        means[row : row + ROWS] = sum(sums[..., i, :] for i in range(count))
        total += int(np.count_nonzero(strip <= low))
        if strip.max(initial=0) >= high.min():
            above = (strip >= high).sum((1, 2), dtype=np.uint32)
            above = above.reshape(-1, cols, step)
            white[row : row + ROWS] = sum(above[..., i] for i in range(step))
    means = (means / count**2 - black[:, None]) / span[:, None]
    of_filter = np.zeros((rows, cols, 3))
    for index, letter in enumerate("RGB"):
        places = [divmod(i, side) for i, site in enumerate(sites) if site == letter]
        if places:
            of_filter[..., index] = np.mean([means[:, r, :, c] for r, c in places], 0)
    samples = rows * cols * step**2
    return Bins(
        step, of_filter, white / step**2, total / samples, float(white.sum()) / samples
    )


def colours(
    balanced: Array, lit: NDArray[np.bool_], sides: tuple[int, int]
) -> tuple[float, float, float]:
    """Return (red, blue, saturation) of Frame, of cells whose bins are all lit.

    sides : pixels, of a bin and of the frame. In one repeat of the CFA the filters lie
    beside each other, and an edge has a colour."""
    least, share = COLOUR_CELL
    step = math.ceil(max(least, share * sides[1]) / sides[0])
    rows, cols = (length // step for length in lit.shape)
    cut = slice(rows * step), slice(cols * step)
    whole = lit[cut].reshape(rows, step, cols, step).all((1, 3))
    cells = balanced[cut].reshape(rows, step, cols, step, 3).mean((1, 3))
    cells = cells[whole]
    cells = cells[cells.min(1) > 0] if len(cells) else cells
    if not len(cells):
        return UNKNOWN, UNKNOWN, UNKNOWN
    logs = np.log2(cells)
    red, blue = logs[:, 0] - logs[:, 1], logs[:, 2] - logs[:, 1]
    return (
        float(np.median(red)),
        float(np.median(blue)),
        float(np.median(np.hypot(red, blue))),
    )


def details(plane: RawImage, sensor: Sensor) -> tuple[float, float]:
    """Return (sharpness, noise) of Frame, of some rows of cells.

    Both are of the square root of the green signal, in which the noise of photons is
    the same at all levels. Noise is of second differences along the rows."""
    gradients, variances = [], []
    for green in bands(plane, sensor):
        root = np.sqrt(np.maximum(green, 0))
        second = root[:, 2:] - 2 * root[:, 1:-1] + root[:, :-2]
        cells = second.shape[1] // CELL
        if not cells or len(second) < CELL:
            continue
        shape = CELL, cells, CELL
        squares = second[:CELL, : cells * CELL].reshape(shape) ** 2 / 6
        inside = ((green > 0) & (green < NEAR_WHITE))[:CELL, 1:-1]
        clear = inside[:, : cells * CELL].reshape(shape).all((0, 2))
        variances += [squares.mean((0, 2))[clear]]
        fine, coarse = (np.diff(root[:, ::step]) for step in (1, 8))
        gradients += [(np.mean(fine**2), np.mean(coarse**2))]
    measured = np.concatenate(variances) if variances else np.empty(0)
    if measured.size < 1 / FLAT:
        return UNKNOWN, UNKNOWN
    flat = np.sort(measured)[: int(FLAT * measured.size)]
    variance = float(flat.mean())
    fine_square, coarse_square = np.mean(gradients, axis=0) - 2 * variance
    if min(fine_square, coarse_square) <= 0:
        return UNKNOWN, variance**0.5
    return float(np.sqrt(fine_square / coarse_square)), variance**0.5


def bands(plane: RawImage, sensor: Sensor) -> Iterator[NDArray[np.float32]]:
    """Yield rows of the first green site, 0 at black and 1 at white, of bands spread
    over the frame."""
    side, sites = repeat_of(sensor.cfa), sites_of(sensor.cfa)
    row, col = divmod(sites.index("G"), side)
    black = np.float32(np.resize(sensor.black_level, side * side)[row * side + col])
    green = plane[row::side, col::side]
    starts = np.linspace(0, max(len(green) - CELL, 0), BANDS).astype(int)
    for first in np.unique(starts):
        part = green[first : first + CELL].astype(np.float32)
        yield (part - black) / (np.float32(sensor.white_level) - black)


def thumbnail(stops: Array) -> NDArray[np.float16]:
    """Return (THUMBNAIL, THUMBNAIL) means of cells of luminance, stops; NaN where half
    of a cell is unknown."""
    rows, cols = (
        np.linspace(0, length, THUMBNAIL + 1).astype(int) for length in stops.shape
    )
    cells = np.full((THUMBNAIL, THUMBNAIL), UNKNOWN)
    for i in range(THUMBNAIL):
        for j in range(THUMBNAIL):
            cell = stops[rows[i] : rows[i + 1], cols[j] : cols[j + 1]]
            known = cell[np.isfinite(cell)]
            if cell.size and known.size > cell.size / 2:
                cells[i, j] = known.mean()
    return cells.astype(np.float16)
