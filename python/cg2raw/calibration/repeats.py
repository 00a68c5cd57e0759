# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Repeats: what the frames of each group say, by the statistics of all groups."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.frames import Group
from cg2raw.calibration.robust import Array
from cg2raw.calibration.sites import BLOCKS, Sites, blocks_of
from cg2raw.sensor import Sensor
from cg2raw.statistics.constant import PIXEL, ConstantStatistics, GroupInfo
from cg2raw.statistics.frame_statistics import statistics_and_means

FEWEST_KEPT = 0.002  # share of a site's pixels below white, of which noise is taken


@dataclass(frozen=True)
class Todo:
    """Whose frames are read, and on how many threads.

    counting : (H, W) bool, False in defects; None where all pixels count."""

    sensor: Sensor
    sites: Sites
    threads: int
    counting: NDArray[np.bool_] | None = None

    @property
    def white(self) -> int:
        """DN from which a pixel is at white, whose code may be the last below it."""
        return self.sensor.white_level - self.sites.step + 1


@dataclass(frozen=True)
class Noise:
    """Temporal noise of one frame, DN, without rows' and columns' own.

    site_variance : (sites,) DN^2. freedom : of each of them.
    variance, pixels : (sites, blocks) DN^2, by pairs, and of how many pixels each."""

    site_variance: Array
    freedom: float
    variance: Array
    pixels: Array


@dataclass(frozen=True)
class Repeats:
    """What the frames of one group say together.

    number : of the group in the statistics. mean : (H, W) float32 DN, without
    transients. known : (H, W) bool, where a pixel counts and is below white.
    clipped : share of the pixels that count and are at white, or of flats at 0 DN.
    noise : None of a single frame. pairs : of frames, disjoint.
    transients : pixels of one frame far off the others; None of a single frame."""

    group: Group
    number: int
    mean: NDArray[np.float32]
    known: NDArray[np.bool_]
    clipped: float
    noise: Noise | None
    pairs: int
    transients: int | None

    @property
    def count(self) -> int:
        return len(self.group.frames)


@dataclass(frozen=True)
class Seen:
    """All frames, after the pass over them."""

    todo: Todo
    groups: Sequence[Group]
    statistics: ConstantStatistics
    mean_of: Callable[[int], NDArray[np.float32]]

    def repeats(self, number: int) -> Repeats:
        """Return what the frames of a group say."""
        group, found = self.groups[number], self.statistics
        mean = self.mean_of(number)
        lit = group.frames[0].frame.kind == "flat"
        planes = found.planes
        high = max(float(plane.high[number]) for plane in planes)
        low = max(float(plane.low[number]) for plane in planes) if lit else 0.0
        known = mean < self.todo.white
        if self.todo.counting is not None:
            known &= self.todo.counting
        is_single = found.frames[number] < 2
        return Repeats(
            group,
            number,
            mean,
            known,
            high + low,
            None if is_single or high > 1 - FEWEST_KEPT else self.noise(number),
            int(found.pairs[number]),
            None if is_single else int(found.transients[number].sum()),
        )

    def noise(self, number: int) -> Noise:
        """Return the noise of a group of several frames."""
        again = int(self.statistics.frames[number]) - 1
        pairs = int(self.statistics.pairs[number])
        planes = self.statistics.planes
        freedom = [plane.freedom[PIXEL] * again for plane in planes]
        pixels = np.array([counts_of(plane.masked) for plane in planes])
        squares = np.array([plane.noise[number] for plane in planes])
        # Row and column means and the field took their part of the squares with them.
        left = [plane.freedom[PIXEL] / (~plane.masked).sum() for plane in planes]
        each = pixels * np.array(left)[:, None] * pairs
        return Noise(
            self.statistics.variance(number),
            float(min(freedom)),
            squares / np.maximum(each, 1e-9),
            pixels,
        )


def seen_all(
    todo: Todo, groups: Sequence[Group], tell: Callable[[float], None]
) -> Seen:
    """Return what all groups say; each frame is read twice, or once if all fit.

    tell : called with the share done."""
    listed = []
    for group in groups:
        first = group.frames[0].frame
        names = tuple(scanned.frame.name for scanned in group.frames)
        info = GroupInfo(first.kind, names, group.exposure_time, group.temperature)
        listed.append((info, [scanned.frame.pixels for scanned in group.frames]))
    found, mean_of = statistics_and_means(
        listed,
        todo.sites.side,
        todo.white,
        step=todo.sites.step,
        excluded=None if todo.counting is None else ~todo.counting,
        threads=todo.threads,
        progress=tell,
    )
    return Seen(todo, groups, found, mean_of)


def counts_of(masked: NDArray[np.bool_]) -> Array:
    """Return (blocks,) how many pixels of a plane count."""
    blocks = blocks_of(~masked, BLOCKS)
    return np.array([float(np.count_nonzero(block)) for block in blocks])
