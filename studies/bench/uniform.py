# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Statistics of darks: frame_statistics, and the same frames in plain NumPy."""

from functools import partial

import numpy as np

COUNT, SHAPE, SIDE, WHITE = 10, (1500, 2000), 2, 4095


def darks():
    """Return COUNT frames, (H, W) uint16 DN."""
    rng = np.random.default_rng(1)
    return [np.rint(rng.normal(256, 5, SHAPE)).astype(np.uint16) for _ in range(COUNT)]


def in_numpy(frames):
    """Return of each plane, without parts, masks or outliers: mean image, its rows and
    columns, levels, variance about the mean and of pairs, largest and smallest values,
    how often each code occurs."""
    found = []
    for place in np.ndindex(SIDE, SIDE):
        planes = [frame[place[0] :: SIDE, place[1] :: SIDE] for frame in frames]
        sums = np.zeros(planes[0].shape)
        squares, high, low = sums.copy(), planes[0].copy(), planes[0].copy()
        codes = np.zeros(2**16, np.int64)
        for plane in planes:
            sums += plane
            squares += plane.astype(np.float64) ** 2
            np.maximum(high, plane, out=high)
            np.minimum(low, plane, out=low)
            codes += np.bincount(plane.ravel(), minlength=len(codes))
        mean = sums / len(planes)
        pairs = zip(planes[::2], planes[1::2], strict=True)
        power = [np.var(a.astype(np.float32) - b) / 2 for a, b in pairs]
        lines = mean.mean(0), mean.mean(1)
        levels = [plane.mean() for plane in planes]
        spread = squares - sums * mean, power, high, low
        found.append((mean, lines, levels, spread, codes))
    return found


def actions():
    """Return ({name: action}, megapixels of all frames, the peer's name)."""
    from cg2raw.statistics import GroupInfo, frame_statistics

    frames = darks()
    info = GroupInfo("dark", tuple(map(str, range(COUNT))))
    readers = [partial(np.asarray, frame) for frame in frames]
    peer = "NumPy, no parts (peer)"
    found = {
        peer: partial(in_numpy, frames),
        "frame_statistics": lambda: frame_statistics(
            [(info, readers)], SIDE, WHITE, threads=1
        ),
    }
    return found, COUNT * SHAPE[0] * SHAPE[1] / 1e6, peer
