# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Seen: what the frames of each group say, by the statistics of all groups."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.frames import Group
from cg2raw.calibration.measured import Array
from cg2raw.calibration.sites import Sites
from cg2raw.sensor import Sensor
from cg2raw.statistics.codes import cut_share
from cg2raw.statistics.constant import ConstantStatistics, GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics
from cg2raw.statistics.temperature import set_points

FEWEST_KEPT = 0.002  # share of a site's pixels below white, of which noise is taken


@dataclass(frozen=True)
class Seen:
    """All frames, after the pass over them: darks, shortest first, then flats."""

    sensor: Sensor
    sites: Sites
    groups: Sequence[Group]
    statistics: ConstantStatistics

    @property
    def white(self) -> int:
        """DN from which a pixel is at white, whose code may be the last below it."""
        return self.sensor.white_level - self.sites.step + 1

    @property
    def darks(self) -> list[int]:
        """Numbers of the groups without light."""
        groups = enumerate(self.statistics.groups)
        return [number for number, info in groups if info.kind == "dark"]

    @property
    def shortest(self) -> list[int]:
        """Numbers of the darks of the shortest exposure."""
        return [n for n in self.darks if self.time(n) == self.time(self.darks[0])]

    def time(self, number: int) -> float:
        """Return the exposure time of a group, s; 0 where it is not known."""
        return self.statistics.groups[number].exposure_time or 0.0

    def levels(self, number: int) -> Array:
        """Return (frames,) DN, of each frame of a group."""
        each = [plane.levels[number] for plane in self.statistics.planes]
        return np.asarray(np.mean(each, axis=0))

    def repeats(self, number: int) -> bool:
        """Whether the noise of a group shows: its frames are several, and not all at
        white."""
        high = max(float(plane.high[number]) for plane in self.statistics.planes)
        return bool(self.statistics.frames[number] > 1 and high <= 1 - FEWEST_KEPT)

    def cut(self, number: int) -> float:
        """Return the share of a dark's pixels at the lowest code if their noise is cut
        there, else 0; the most of all sites."""
        each = [plane.codes[number] for plane in self.statistics.planes]
        return max(cut_share(counts, self.sites.step) for counts in each)

    def clipped(self, number: int) -> float:
        """Return the share of a flat's pixels at white or at 0 DN."""
        ends = [(p.high[number], p.low[number]) for p in self.statistics.planes]
        return float(np.max(ends, axis=0).sum())

    def mean_over(self, numbers: Sequence[int]) -> NDArray[np.float32]:
        """Return (H, W) DN, the mean image of the frames of groups."""
        weights = np.zeros(len(self.statistics.groups))
        weights[numbers] = self.statistics.frames[numbers]
        return self.sum_of(weights / weights.sum())

    def sum_of(self, weights: Array) -> NDArray[np.float32]:
        """Return (H, W), the sum of mean images times (groups,) weights."""
        first, *rest = map(int, np.flatnonzero(weights))
        found = np.float32(weights[first]) * self.statistics.mean_of(first)
        for number in rest:
            found += np.float32(weights[number]) * self.statistics.mean_of(number)
        return found

    def is_coarse(self, number: int) -> bool:
        """Whether rounding hides the noise of a dark. Source: EMVA 1288, R4.0."""
        return bool(self.statistics.variance(number).min() < self.sites.coarse)


def seen_all(
    sensor: Sensor,
    sites: Sites,
    groups: Sequence[Group],
    excluded: NDArray[np.bool_] | None,
    threads: int,
    tell: Callable[[float], None],
) -> Seen:
    """Return what all groups say; each frame is read twice, or once if all fit.

    Darks of other temperatures than the one of most frames with charge are a split of
    their own, but for the shortest. tell : called with the share done."""
    listed = []
    for group, split in zip(groups, splits_of(groups), strict=True):
        frames = [scanned.frame for scanned in group.frames]
        at = group.exposure_time, group.temperature, split
        info = GroupInfo(group.kind, tuple(frame.name for frame in frames), *at)
        listed.append((info, [frame.pixels for frame in frames]))
    found = frame_statistics(
        listed,
        sites.side,
        sensor.white_level - sites.step + 1,
        step=sites.step,
        excluded=excluded,
        threads=threads,
        progress=tell,
    )
    return Seen(sensor, sites, groups, found)


def splits_of(groups: Sequence[Group]) -> list[str]:
    """Return "" of flats, of the shortest darks and of the set point of most frames
    with charge; of other darks their set point. groups : as of Seen."""
    times = [group.exposure_time or 0.0 for group in groups if group.kind == "dark"]
    points = set_points([group.temperature for group in groups[: len(times)]])
    charged = Counter[int]()
    for group, time, point in zip(groups, times, points, strict=False):
        charged[point] += (time > times[0]) * len(group.frames)
    main = charged.most_common(1)[0][0] if charged else 0
    splits = [
        "" if point == main or time == times[0] else f"set point {point}"
        for time, point in zip(times, points, strict=True)
    ]
    return splits + [""] * (len(groups) - len(times))
