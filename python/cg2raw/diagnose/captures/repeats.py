# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Repeats: frames of one series against each other, before they are diagnosed.

A series are frames that should differ by noise alone: one kind, light, exposure time,
ISO and temperature."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm, t

from cg2raw.arrays import RawImage
from cg2raw.diagnose.captures.capture import Capture
from cg2raw.diagnose.captures.consistency import SAME_TEMPERATURE
from cg2raw.diagnose.captures.frame import Frame

FALSE_ALARM = 1e-3  # chance that a series without a fault has a remark, of each kind
OUTER = 0.05  # of the pixels at either end that a level leaves out: hot ones, rays
FEWEST_FOR_FIRST = 4  # frames whose spread says how far one may be off
FEWEST_FOR_RAYS = 3  # frames of which two outvote one
# That a pixel lies above all other frames of a series. Of N normal frames the largest
# does by 8 sigma once in 10^8 pixels.
RAY_SIGMAS = 8.0
CUT = 4.0  # sigma; deviations are of what is within
SHRUNK = 0.99946  # standard deviation of a normal variable within CUT
MOST_CUTS = 20  # of cutting, at most
ROUNDED = 12**-0.5  # DN, standard deviation of what rounding adds
LARGEST_DIFFERENCE = 4096  # DN, of two frames; beyond it, it counts as this


@dataclass
class _Extremes:
    """Of every pixel over the frames so far: the two largest values, the two smallest,
    in DN from each frame's level, and which frame has the largest."""

    high: NDArray[np.int32]
    second: NDArray[np.int32]
    low: NDArray[np.int32]
    last: NDArray[np.int32]
    owner: NDArray[np.uint8]

    def add(self, plane: NDArray[np.int32], number: int) -> None:
        above = plane > self.high
        self.second = np.where(above, self.high, np.maximum(self.second, plane))
        self.owner[above] = number
        np.maximum(self.high, plane, out=self.high)
        below = plane < self.low
        self.last = np.where(below, self.low, np.minimum(self.last, plane))
        np.minimum(self.low, plane, out=self.low)


class Series:
    """The frames of a series as they are read, one at a time; of all of them together
    about 20 bytes a pixel are kept.

    dn_per_electron : which makes pixels with more charge noisier."""

    def __init__(self, first: Capture, dn_per_electron: float) -> None:
        self.light = first.shows.light
        self.dn_per_electron = dn_per_electron
        self.names: list[str] = []
        self.levels: list[float] = []
        self.errors: list[float] = []
        self._extremes: _Extremes | None = None
        self._before: NDArray[np.int32] | None = None
        self._differences = np.zeros(2 * LARGEST_DIFFERENCE + 1, np.int64)

    def add(self, capture: Capture, raw: RawImage) -> None:
        """Take in the pixels (H, W) of one frame."""
        values = raw[capture.mask()] if capture.mask else raw
        level, error = trimmed_mean(values)
        self.names.append(capture.name)
        self.levels.append(level)
        self.errors.append(error)
        if self.light:
            return
        plane = raw.astype(np.int32) - round(level)
        if capture.mask:
            plane *= capture.mask()
        if self._extremes is None or self._before is None:
            far = np.int32(1 << 20)
            empty = np.zeros(plane.shape, np.uint8)
            self._extremes = _Extremes(plane, plane - far, plane.copy(), plane + far,
                                       empty)  # fmt: skip
        else:
            away = np.clip(
                plane - self._before, -LARGEST_DIFFERENCE, LARGEST_DIFFERENCE
            )
            self._differences += np.bincount(
                (away + LARGEST_DIFFERENCE).ravel(), minlength=len(self._differences)
            )
            self._extremes.add(plane, min(len(self.names) - 1, 255))
        self._before = plane

    def first_is_off(self) -> str | None:
        """Return a sentence if the first level is away from the others by more than
        their spread allows: a prediction interval of Student's t. None if not."""
        if len(self.levels) < FEWEST_FOR_FIRST:
            return None
        others = np.array(self.levels[1:])
        n = len(others)
        spread = np.hypot(others.std(ddof=1), np.mean(self.errors))
        away = self.levels[0] - others.mean()
        bound = t.isf(FALSE_ALARM / 2, n - 1) * spread * np.sqrt(1 + 1 / n)
        if abs(away) <= bound:
            return None
        return (
            f"{self.names[0]}: the first of {n + 1} repeats is {away:+.2f} DN off the "
            f"others, which differ by {spread:.2f} DN (standard deviation): leave it "
            "out, as many cameras need a first frame to settle"
        )

    def lamp_drift(self, black: float) -> str | None:
        """Return a sentence if the levels of lit frames differ by more than noise."""
        if not self.light or len(self.levels) < 2:
            return None
        light = np.array(self.levels) - black
        noise = float(np.mean(np.square(self.errors)))
        statistic = (len(light) - 1) * light.var(ddof=1) / noise
        if light.mean() <= 0 or chi2.sf(statistic, len(light) - 1) > FALSE_ALARM:
            return None
        drift, most = light.std(ddof=1) / light.mean(), np.ptp(light) / light.mean()
        return (
            f"{self.names[0]} and its {len(light) - 1} repeats: their light differs by "
            f"{drift:.2%} (standard deviation; {most:.2%} at most)"
        )

    def cosmic_rays(self) -> str | None:
        """Return a sentence on pixels that one frame alone has far above the others."""
        if self._extremes is None or len(self.names) < FEWEST_FOR_RAYS:
            return None
        found, sigma = self._extremes, self.noise()
        shot = np.maximum(found.second, 0) * self.dn_per_electron
        bound = RAY_SIGMAS * np.sqrt(sigma**2 + shot)
        up = found.high - found.second > bound
        down = int(np.count_nonzero(found.last - found.low > bound))
        count = int(np.count_nonzero(up))
        if count - down <= norm.isf(FALSE_ALARM) * np.sqrt(count + down) + 1:
            return None
        most = np.bincount(found.owner[up], minlength=len(self.names))
        worst = int(most.argmax())
        return (
            f"{self.names[0]} and its {len(self.names) - 1} repeats: {count} pixels "
            f"lie above all other frames by more than {RAY_SIGMAS:g} sigma (one is "
            f"{sigma:.2f} DN) in one frame alone, {down} below: cosmic rays; most, "
            f"{most[worst]}, in {self.names[worst]}"
        )

    def noise(self) -> float:
        """Return the temporal noise of a pixel, DN: a clipped standard deviation."""
        counts = self._differences
        middle = int(np.searchsorted(np.cumsum(counts), counts.sum() / 2))
        square = (np.arange(len(counts)) - middle) ** 2.0
        deviation = float(np.sqrt((counts * square).sum() / counts.sum()))
        for _ in range(MOST_CUTS):
            weight = counts * (square <= (CUT * deviation) ** 2)
            before = deviation
            deviation = float(np.sqrt((weight * square).sum() / weight.sum())) / SHRUNK
            if deviation >= before:
                break
        return max(deviation / 2**0.5, ROUNDED)


def trimmed_mean(values: RawImage) -> tuple[float, float]:
    """Return the mean of values without OUTER at either end, and its standard error,
    which is that of noise alone where there is no fixed pattern, and larger than it
    where there is. Source: J. W. Tukey, D. H. McLaughlin, Sankhya A 25(3), 1963."""
    counts = np.bincount(values.ravel())
    total = np.cumsum(counts)
    low, high = total[-1] * OUTER, total[-1] * (1 - OUTER)
    weight = np.diff(np.clip(total, low, high), prepend=low)
    code = np.arange(float(len(counts)))
    mean = float((weight * code).sum() / weight.sum())
    bounded = np.clip(code, *np.searchsorted(total, [low, high]))
    variance = float((counts * (bounded - mean) ** 2).sum() / total[-1])
    error = np.sqrt((variance + ROUNDED**2) / total[-1]) / (1 - 2 * OUTER)
    return mean, float(error)


def series_of(frames: Sequence[Frame]) -> list[list[Capture]]:
    """Return the captures that repeat each other, in the manifest's order."""
    alike: dict[object, list[Capture]] = {}
    for frame in frames:
        capture, entry = frame.capture, frame.entry
        if capture.means is not None:
            continue
        light = (entry.scene, entry.gain, entry.patches, entry.corners)
        is_known = isinstance(entry.scene, tuple) or not capture.shows.light
        place = None if is_known else capture.set
        key = (capture.kind, capture.iso, capture.exposure_time, light, place)
        alike.setdefault(key, []).append(capture)
    return [series for every in alike.values() for series in by_temperature(every)]


def by_temperature(captures: Sequence[Capture]) -> list[list[Capture]]:
    """Return captures apart where the sensor's temperature was another."""
    order = sorted(captures, key=lambda capture: capture.temperature or 0.0)
    parts: list[list[Capture]] = []
    for capture in order:
        warm = capture.temperature or 0.0
        if parts and warm - (parts[-1][-1].temperature or 0.0) <= SAME_TEMPERATURE:
            parts[-1].append(capture)
        else:
            parts.append([capture])
    return [sorted(part, key=captures.index) for part in parts]
