# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""From frames to ConstantStatistics: each frame is read twice, or once if all fit."""

import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import RawImage
from cg2raw.statistics.constant import (
    MOST_LINES,
    PLACES,
    Array,
    ConstantStatistics,
    GroupInfo,
    PlaneStatistics,
    smooth_images,
)
from cg2raw.statistics.dark_rates import dark_rates
from cg2raw.statistics.kept import Kept, Reader
from cg2raw.statistics.lattice import lattice_of
from cg2raw.statistics.patterns import Lattice, Spots
from cg2raw.statistics.spots import spots_of

MOST_CUT = 0.01  # of the samples of a plane, at 0 and at white


def frame_statistics(
    groups: Sequence[tuple[GroupInfo, Sequence[Reader]]],
    side: int,
    white: int,
    *,
    step: int = 1,
    excluded: NDArray[np.bool_] | None = None,
    threads: int = 2,
    progress: Callable[[float], None] | None = None,
    looked: Callable[[int, NDArray[np.uint32]], None] | None = None,
) -> ConstantStatistics:
    """Return what groups of frames say.

    groups : frames that repeat each other, and what reads each of them.
    side : samples along the CFA's repeat, 1 of a camera without a CFA. white : DN.
    step : DN between codes. excluded : (H, W) bool, samples that count in nothing.
    threads : the result is the same. progress : called with the share done, 0 to 1.
    looked : called with the number of each frame, in order, and how many of its samples
    of each plane have each code, (planes, codes).

    At most a few frames, and of each group one image of four bytes a sample, are held
    at a time; frames are read twice, or once if they can be Kept.
    Raises ValueError for a group without frames and for frames of several sizes."""
    if not groups or any(not readers for _, readers in groups):
        raise ValueError("frames: a group has none; give darks or flats")
    for name, value in (("side", side), ("white", white)):
        if value < 1:
            raise ValueError(f"{name}: {value}; must be at least 1")
    kept = Kept()
    readers = [kept.reader(read) for _, members in groups for read in members]
    numbers = [g for g, (_, members) in enumerate(groups) for _ in members]
    tell = progress or (lambda share: None)
    seen: _core.FrameStatistics | None = None
    counts: list[NDArray[np.uint32]] = []
    for index, frame in enumerate(read_ahead(readers, threads)):
        if seen is None:
            height, width = frame.shape
            seen = _core.FrameStatistics(height, width, side, len(groups), step)
            if excluded is not None:
                seen.exclude(excluded)
        found = seen.look(numbers[index], frame, threads)
        if looked:
            looked(index, found)
        if numbers[index] == len(counts):
            counts.append(found)
        else:
            counts[-1] = added(counts[-1], found)
        tell((index + 1) / len(readers) / 2)
    assert seen is not None
    most = max(found.shape[1] for found in counts)
    codes = np.array([np.pad(c, ((0, 0), (0, most - c.shape[1]))) for c in counts])
    lattice, spots = _set_apart(groups, seen, codes, white, excluded)
    seen.mask(threads)
    frames = read_ahead(readers, threads)
    done = len(readers)
    for group, (_, members) in enumerate(groups):
        for first in range(0, len(members), 2):
            pair = [next(frames) for _ in members[first : first + 2]]
            seen.measure(group, pair[0], pair[1] if len(pair) == 2 else None, threads)
            done += len(pair)
            tell(done / len(readers) / 2)
    planes, lags, transients, overlaps = seen.result(threads)
    number = np.array([len(members) for _, members in groups])
    statistics = ConstantStatistics(
        groups=tuple(info for info, _ in groups),
        planes=tuple(
            PlaneStatistics(
                places=places_of(plane["rows"], plane["columns"], plane["field"]),
                low=share_of(codes[:, p, :1], codes[:, p]),
                high=share_of(codes[:, p, white:], codes[:, p]),
                codes=codes[:, p],
                **plane,
            )
            for p, plane in enumerate(planes)
        ),
        frames=number,
        pairs=number // 2,
        lags=lags,
        white=white,
        transients=transients,
        overlaps=overlaps,
        mean_of=seen.mean,
        excluded=excluded,
        lattice=lattice,
        spots=spots,
    )
    return replace(statistics, rates=dark_rates(statistics))


def _set_apart(
    groups: Sequence[tuple[GroupInfo, Sequence[Reader]]],
    seen: _core.FrameStatistics,
    codes: NDArray[np.uint32],
    white: int,
    excluded: NDArray[np.bool_] | None,
) -> tuple[Lattice | None, Spots | None]:
    """Find what the flats show to be patterns of light, and have it masked; None where
    there is none.

    codes : (G, planes, codes) counts. Flats that are cut at 0 or white say nothing."""
    light: NDArray[np.float32] | None = None
    side = math.isqrt(codes.shape[1])
    for g, (info, members) in enumerate(groups):
        cut = codes[g, :, 0] + codes[g, :, white:].sum(axis=1)
        if info.kind != "flat" or (cut > MOST_CUT * codes[g].sum(axis=1)).any():
            continue
        mean = seen.mean(g) * np.float32(len(members))
        for row, column in np.ndindex(side, side):
            plane = mean[row::side, column::side]
            plane -= plane.mean(dtype=np.float64)
        light = mean if light is None else light + mean
    if light is None:
        return None, None
    left_out = np.zeros(light.shape, bool) if excluded is None else excluded.copy()
    lattice = lattice_of(np.where(left_out, np.float32(0), light), side)
    if lattice is not None and not lattice.is_sure:
        lattice = None
    if lattice is not None:
        left_out |= lattice.samples(light.shape)
    spots = spots_of(light, side, left_out)
    left_out |= spots.samples(light.shape)
    seen.exclude(left_out)
    return lattice, spots if len(spots.places) else None


def share_of(some: NDArray[np.uint32], codes: NDArray[np.uint32]) -> Array:
    """Return (G,) the share of samples with some codes among all of them."""
    found: Array = some.sum(axis=1, dtype=np.float64) / codes.sum(axis=1)
    return found


def places_of(rows: Array, columns: Array, field: Array) -> Array:
    """Return (G, 25) PLACES of the smooth part of mean images, less their level, DN."""
    h, w = rows.shape[1], columns.shape[1]
    y, x = (slice(None, None, -(-length // MOST_LINES)) for length in (h, w))
    smooth = smooth_images(rows, columns, field, y, x)
    found: Array = np.quantile(smooth.reshape(len(rows), -1), PLACES, axis=1).T
    return found


def added(a: NDArray[np.uint32], b: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Return the sum of two tables, of which one may have fewer columns."""
    short, long = sorted((a, b), key=lambda table: table.shape[1])
    found = long.copy()
    found[:, : short.shape[1]] += short
    return found


def read_ahead(readers: Sequence[Reader], threads: int) -> Iterator[RawImage]:
    """Yield frames in order, others being read meanwhile."""
    with ThreadPoolExecutor(max(threads, 1)) as pool:
        waiting: deque[Future[RawImage]] = deque()
        for reader in readers:
            waiting.append(pool.submit(reader))
            if len(waiting) > threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
