# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Darks and flats with planted pixels, in DN."""

import numpy as np

from cg2raw.model.fit import fit
from cg2raw.model.shapes import shapes
from cg2raw.statistics.constant import GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics

SHAPE, SIDE, WHITE = (96, 120), 2, 4095
BLACK, NOISE, GAIN = 200.0, 3.0, 0.25  # DN, DN, DN per electron
TIMES = (0.0, 4.0)  # s


def normal(rng, shape):
    return NOISE * rng.standard_normal(shape)


def darks(seed, split, per_second, times=TIMES, frames=4, singles=False, noise=normal):
    """Return [(GroupInfo, frames), ...]. per_second : (H, W) DN. singles : the longest
    is of one frame. noise : (rng, shape) -> DN."""
    rng = np.random.default_rng((seed, 99))
    groups = []
    for time in times:
        count = 1 if singles and time == max(times) else max(frames, 2)
        made = []
        for _ in range(count):
            charge = rng.poisson(per_second * time / GAIN) * GAIN
            frame = BLACK + charge + noise(rng, SHAPE)
            made.append(np.clip(np.rint(frame), 0, WHITE).astype(np.uint16))
        names = tuple(f"{split} {time} {n}" for n in range(count))
        groups.append((GroupInfo("dark", names, time, None, split), made))
    return groups


def statistics_of(groups):
    """Return the statistics of groups."""
    readers = [(info, [lambda f=f: f for f in frames]) for info, frames in groups]
    return frame_statistics(readers, SIDE, WHITE)


def shown(make):
    """Return the shapes of both splits. make : (seed, split) -> groups."""
    splits = ("training", "validation")
    statistics = statistics_of(
        [g for n, one in enumerate(splits) for g in make(n, one)]
    )
    halves = [
        statistics.only([n for n, g in enumerate(statistics.groups) if g.split == one])
        for one in splits
    ]
    return shapes(statistics, splits, tuple(map(fit, halves)))
