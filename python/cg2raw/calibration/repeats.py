# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Repeats: the frames of a group, read once: their noise, their mean, cosmic rays."""

from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.calibration.frames import Group, UniformFrame
from cg2raw.calibration.pair_noise import PairNoise, pair_noise, pooled
from cg2raw.calibration.robust import Array
from cg2raw.calibration.sites import Sites
from cg2raw.sensor import Sensor

TRANSIENT = 8.0  # sigma above its repeats beyond which one frame's pixel is a transient
FEWEST_KEPT = 64  # pixels of a site that are not saturated, of a pair of frames


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
class Repeats:
    """What the frames of one group say together.

    mean : (H, W) float32 DN, without transients. known : (H, W) bool, where a pixel
    counts and is clipped in no frame. clipped : share of the pixels that count and are,
    at white, or of flats at 0 DN.
    noise : None of a single frame. pairs : how many differences it is of.
    transients : pixels of one frame far above the others; None of a single frame."""

    group: Group
    mean: NDArray[np.float32]
    known: NDArray[np.bool_]
    clipped: float
    noise: PairNoise | None
    pairs: int
    transients: int | None
    single: Sequence[PairNoise] = field(default=(), repr=False)

    @property
    def count(self) -> int:
        return len(self.group.frames)


def repeats_of(
    group: Group,
    todo: Todo,
    black: Array,
    system_gain: float | None,
) -> Repeats:
    """Return what a group's frames say; each is read once, two are held at a time.

    black : (sites,) DN; flats are scaled to one light above it. system_gain : DN per
    electron, which tells how noisy a bright pixel is; None: it is taken of the
    differences."""
    sites, white = todo.sites, todo.white
    frames = [scanned.frame for scanned in group.frames]
    above = np.array([scanned.level for scanned in group.frames]) - black
    lit = frames[0].kind == "flat"
    total = highest = lowest = previous = None
    pairs: list[PairNoise] = []
    for index, raw in enumerate(read_ahead(frames, todo.threads)):
        if total is None or highest is None or lowest is None or previous is None:
            total, highest, lowest = raw.astype(np.uint32), raw.copy(), raw.copy()
            previous = raw
            continue
        total += raw
        np.maximum(highest, raw, out=highest)
        np.minimum(lowest, raw, out=lowest)
        scale = above[index] / above[index - 1] if lit else np.ones(sites.count)
        between = noise_between(previous, raw, todo, scale, black)
        if between is not None:
            pairs.append(between)
        previous = raw
    if total is None or highest is None or lowest is None:
        raise ValueError("a group of no frames: give at least one")
    noise = pooled(pairs) if pairs else None
    clipped = (highest >= white) | (lit & (lowest == 0))
    counting = np.ones_like(clipped) if todo.counting is None else todo.counting
    share = float(clipped[counting].mean()) if counting.any() else 1.0
    variance, gain, level = _variance(noise, group, black, system_gain)
    least = max(variance, sites.rounding)  # a pixel that goes to the next code is none
    mean, transients = _without_transients(
        total, highest, lowest, len(frames), (least, gain, level)
    )
    seen = transients if pairs else None
    known = counting & ~clipped
    return Repeats(group, mean, known, share, noise, len(pairs), seen, pairs)


def noise_between(
    first: RawImage,
    second: RawImage,
    todo: Todo,
    scale: Array,
    black: Array,
) -> PairNoise | None:
    """Return the noise of two frames, the second brighter by the factor @scale; None if
    nearly all pixels of a site are saturated.

    scale, black : (sites,) DN; both frames are brought to their geometric mean."""
    sites, white = todo.sites, todo.white
    difference = second.astype(np.float32)
    other = first.astype(np.float32)
    if not np.allclose(scale, 1, atol=1e-7):
        level = sites.spread(black, difference.shape)
        root = sites.spread(np.sqrt(scale), difference.shape)
        difference -= level
        difference /= root
        other -= level
        other *= root
    difference -= other
    keep = (first < white) & (second < white)
    if todo.counting is not None:
        keep &= todo.counting
    if min(int(np.count_nonzero(site)) for site in sites.of(keep)) < FEWEST_KEPT:
        return None
    return pair_noise(difference, None if keep.all() else keep, sites)


def _variance(
    noise: PairNoise | None, group: Group, black: Array, system_gain: float | None
) -> tuple[float, float, float]:
    """Return (variance, system gain, level at which it holds) of one frame's pixels."""
    if noise is None:
        return 0.0, 0.0, 0.0
    level = float(group.level.mean())
    variance = float(noise.site_variance.max())
    above = max(level - float(np.mean(black)), 1.0)
    lit = group.frames[0].frame.kind == "flat"
    gain = system_gain
    if gain is None:
        gain = variance / above if lit else 0.0
    return variance, gain, level


def _without_transients(
    total: Array,
    highest: RawImage,
    lowest: RawImage,
    count: int,
    noise: tuple[float, float, float],
) -> tuple[NDArray[np.float32], int]:
    """Return (mean, transients): a pixel of one frame that lies 8 sigma above the mean
    of the others does not count. A brighter pixel is noisier, by its charge."""
    mean = total.astype(np.float32)
    mean /= count
    if count < 2:
        return mean, 0
    variance, system_gain, level = noise
    others = (total - highest.astype(np.uint32)).astype(np.float32)
    others /= count - 1
    excess = highest - others
    spread = np.maximum(others - level, 0) * np.float32(system_gain)
    spread += np.float32(variance)
    found = excess * excess > TRANSIENT**2 * (1 + 1 / (count - 1)) * spread
    mean[found] = others[found]
    return mean, int(np.count_nonzero(found))


def read_ahead(frames: Sequence[UniformFrame], threads: int) -> Iterator[RawImage]:
    """Yield the pixels of frames in order, the next being read meanwhile."""
    if threads < 2:
        for frame in frames:
            yield frame.pixels()
        return
    with ThreadPoolExecutor(1) as pool:
        waiting: deque[Future[RawImage]] = deque()
        for frame in frames:
            waiting.append(pool.submit(frame.pixels))
            if len(waiting) == 2:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
