# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Repeats: what frames that should differ by noise alone say of each other."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, ndtri, stdtrit

from cg2raw.diagnose.captures.capture import Capture
from cg2raw.diagnose.captures.manifest import Frame
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import POINT_SIGMAS, ConstantStatistics
from cg2raw.statistics.temperature import set_points

FALSE_ALARM = 1e-3  # chance that a series without a fault has a remark, of each kind
FEWEST_FOR_FIRST = 4  # frames whose spread says how far one may be off
FEWEST_FOR_RAYS = 3  # frames of which two outvote one


@dataclass(frozen=True)
class Repeats:
    """Frames of one kind, light, exposure time, ISO and temperature.

    names, levels : (frames,) of each, DN. error : DN, a level's standard error by noise
    alone. noise : DN, of a pixel from frame to frame. transients : (frames, 2) pixels
    that each has alone, above and below; None of pictures."""

    names: Sequence[str]
    levels: NDArray[np.float64]
    error: float
    noise: float = 0.0
    transients: NDArray[np.int64] | None = None

    def first_is_off(self) -> str | None:
        """Return a sentence if the first level is away from the others by more than
        their spread allows: a prediction interval of Student's t. None if not."""
        if len(self.levels) < FEWEST_FOR_FIRST:
            return None
        others = self.levels[1:]
        n = len(others)
        spread = float(np.hypot(others.std(ddof=1), self.error))
        away = float(self.levels[0] - others.mean())
        bound = stdtrit(n - 1, 1 - FALSE_ALARM / 2) * spread * math.sqrt(1 + 1 / n)
        if abs(away) <= bound:
            return None
        return (
            f"{self.names[0]}: the first of {n + 1} repeats is {away:+.2f} DN off the "
            f"others, which differ by {spread:.2f} DN (standard deviation): leave it "
            "out, as many cameras need a first frame to settle"
        )

    def lamp_drift(self, black: float) -> str | None:
        """Return a sentence if levels of light above black, DN, differ by more than
        noise; None if not."""
        light = self.levels - black
        again = len(light) - 1
        if again < 1 or light.mean() <= 0:
            return None
        drift, most = light.std(ddof=1) / light.mean(), np.ptp(light) / light.mean()
        if chdtrc(again, again * light.var(ddof=1) / self.error**2) > FALSE_ALARM:
            return None
        return (
            f"{self.names[0]} and its {again} repeats: their light differs by "
            f"{drift:.2%} (standard deviation; {most:.2%} at most)"
        )

    def cosmic_rays(self) -> str | None:
        """Return a sentence on pixels that one frame alone has far above the others, if
        they are more than those below."""
        if self.transients is None or len(self.names) < FEWEST_FOR_RAYS:
            return None
        up, down = map(int, self.transients.sum(axis=0))
        if up - down <= ndtri(1 - FALSE_ALARM) * math.sqrt(up + down) + 1:
            return None
        worst = int(self.transients[:, 0].argmax())
        return (
            f"{self.names[0]} and its {len(self.names) - 1} repeats: {up} pixels lie "
            f"above all other frames by more than {POINT_SIGMAS:g} sigma (one is "
            f"{self.noise:.2f} DN) in one frame alone, {down} below: cosmic rays; "
            f"most, {self.transients[worst, 0]}, in {self.names[worst]}"
        )


def repeats_of(found: ConstantStatistics, step: int) -> Repeats:
    """Return what the first group says, whose codes are step DN apart.

    A level varies by a share of the noise of pixels, and of that of whole rows and
    columns, which all planes of these rows and columns have together."""
    samples = sum(plane.masked.size for plane in found.planes)
    pixel, *lines = (
        np.nan_to_num(found.variance(0, part)).mean()
        for part in ("pixel", "fast_rows", "fast_columns")
    )
    pixel = max(pixel, ROUNDING * step**2)
    own = sum(max(line - pixel, 0.0) for line in lines)
    return Repeats(
        found.groups[0].frames,
        np.mean([plane.levels[0] for plane in found.planes], axis=0),
        math.sqrt((pixel + found.side * own) / samples),
        math.sqrt(pixel),
        found.transients[0],
    )


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
        seen = (light, place, entry.mask)
        key = (capture.kind, capture.iso, capture.exposure_time, seen)
        alike.setdefault(key, []).append(capture)
    series = []
    for every in alike.values():
        points = set_points([capture.temperature for capture in every])
        for point in sorted(set(points)):
            here = zip(every, points, strict=True)
            series.append([capture for capture, its in here if its == point])
    return series
