# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How much charge each pixel gathers without light: a histogram of their rates."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.statistics.constant import (
    PIXEL,
    RATE_EDGES,
    Array,
    ConstantStatistics,
    DarkRates,
    PlaneStatistics,
)


@dataclass(frozen=True)
class Slope:
    """weights : (G,) by which mean images add up to their slope over time, 1/s; 0 of
    other groups. noise : (P,) DN/s, sd of what comes out, of each plane. charge : as of
    DarkRates."""

    weights: Array
    noise: Array
    charge: float


def dark_rates(statistics: ConstantStatistics) -> tuple[DarkRates, ...]:
    """Return the rates of each split whose darks have several exposure times."""
    found, side = [], statistics.side
    for split in dict.fromkeys(group.split for group in statistics.groups):
        slope = slope_of(statistics, split)
        if slope is None:
            continue
        h, w = statistics.planes[0].shape
        rates = [np.zeros(plane.shape, np.float32) for plane in statistics.planes]
        for g in np.flatnonzero(slope.weights):
            mean = statistics.mean_of(int(g))
            for p, plane in enumerate(statistics.planes):
                smooth = plane.smooth(int(g)).astype(np.float32)
                rest = mean[p // side :: side, p % side :: side] - smooth
                rates[p] += np.float32(slope.weights[g]) * rest
        counts, noises = np.zeros(len(RATE_EDGES) - 1, np.int64), []
        for p, plane in enumerate(statistics.planes):
            noises.append(noise_beside(plane, rates[p], float(slope.noise[p])))
            used = ~plane.in_lines
            if statistics.excluded is not None:
                used &= ~statistics.excluded[p // side :: side, p % side :: side]
            scaled = np.clip(rates[p][used] / noises[p], *RATE_EDGES[[0, -1]])
            counts += np.histogram(scaled, RATE_EDGES)[0]
        noise = float(np.sqrt(np.mean(np.square(noises))))
        found.append(DarkRates(split, counts, noise, slope.charge))
    return tuple(found)


def slope_of(statistics: ConstantStatistics, split: str) -> Slope | None:
    """Return the least-squares slope of a split's darks; None of one exposure time,
    and where no two frames repeat each other."""
    used = ~statistics.is_flat & (statistics.splits == split)
    time = np.array([g.charge_time for g in statistics.groups])
    known = used & (statistics.pairs > 0)
    if not known.any() or not np.ptp(time[used]):
        return None
    frames = np.where(used, statistics.frames, 0)
    away = time - frames @ time / frames.sum()
    weights = frames * away / (frames @ away**2)
    power = np.array([plane.power for plane in statistics.planes])
    usual = power[:, known].mean(axis=1, keepdims=True)
    each = np.where(known, np.where(known, power, 0.0), usual) / statistics.frames
    noise = np.sqrt(each @ weights**2)
    charge = float(weights**2 @ (time / statistics.frames))
    return Slope(weights, noise, charge) if (noise > 0).all() else None


def noise_beside(
    plane: PlaneStatistics, rates: NDArray[np.float32], temporal: float
) -> float:
    """Return the noise of a plane's rates with that of the means of lines, which have
    been taken off: they are of few samples whose rates differ."""
    known = rates[~plane.masked]
    lost = 1 - plane.freedom[PIXEL] / max(known.size, 1)
    spread = max(float(known.var()) - temporal**2, 0.0) if known.size else 0.0
    return float(np.sqrt(temporal**2 + lost * spread))
