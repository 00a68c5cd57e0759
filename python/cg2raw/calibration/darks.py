# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Darks: what they show besides the figures of the fit.

Source: EMVA Standard 1288, release 4.0, section on dark current (doubling temperature).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.dark_spread import DarkSpread, dark_spread
from cg2raw.calibration.fitting import Fitted, of_all
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.structure import BiasStructure, Glow, bias_structure, glow
from cg2raw.calibration.tails import Tails, tails_of
from cg2raw.statistics.dark_rates import slope_of

Map = NDArray[np.float32]


@dataclass(frozen=True)
class DarkCurrent:
    """Dark current of the median pixel.

    rates : (temperature or None, DN/s) of each set point, that of most frames first.
    doubling : K. points : (exposure time, s, DN above black, place in rates)."""

    rates: tuple[tuple[float | None, Measured], ...]
    doubling: Measured | None
    points: tuple[tuple[float, float, int], ...]

    @property
    def rate(self) -> Measured:
        """At the set point of most frames, DN/s."""
        return self.rates[0][1]


@dataclass(frozen=True, kw_only=True)
class DarkResults:
    """What darks show. offset, rate : (H, W) of each pixel, DN above black, and DN/s
    but for a constant."""

    tails: Tails | None = None
    structure: BiasStructure | None = None
    dark: DarkCurrent | None = None
    spread: DarkSpread | None = None
    glow: Glow | None = None
    offset: Map | None = field(default=None, repr=False)
    rate: Map | None = field(default=None, repr=False)


def read_darks(seen: Seen, fit: Fitted, black: NDArray[np.float64]) -> DarkResults:
    """Return what darks show. black : (sites,) DN."""
    if not seen.darks:
        return DarkResults()
    repeated = [number for number in seen.darks if seen.repeats(number)]
    gain = of_all(fit.figures, "gain")
    spread, shine, rate = None, None, None
    if fit.lost != "cut":
        per_electron = 1 / gain.value if gain else 0.0
        for rates in seen.statistics.rates:
            if not rates.split:
                spread = dark_spread(rates, per_electron)
        rate = rate_map(seen)
        if rate is not None:
            unknown = False if seen.counting is None else ~seen.counting
            shine = glow(np.where(unknown, np.nan, rate))
    offset = seen.mean_of(seen.shortest[0])
    offset -= seen.sites.spread(black, offset.shape)
    return DarkResults(
        tails=tails_of(seen, repeated[0]) if repeated and not fit.lost else None,
        structure=None if fit.lost else bias_structure(seen),
        dark=dark_current(seen, fit, spread, float(black.mean())),
        spread=spread,
        glow=shine,
        offset=offset,
        rate=rate,
    )


def rate_map(seen: Seen) -> Map | None:
    """Return (H, W) DN/s, the slope of pixels over exposure time but for a constant;
    None where the law of rates is not known either."""
    slope = slope_of(seen.statistics, "")
    if slope is None:
        return None
    used = np.flatnonzero(slope.weights)
    return sum(
        (np.float32(slope.weights[g]) * seen.mean_of(int(g)) for g in used[1:]),
        np.float32(slope.weights[used[0]]) * seen.mean_of(int(used[0])),
    )


def dark_current(
    seen: Seen, fit: Fitted, spread: DarkSpread | None, black: float
) -> DarkCurrent | None:
    """Return the dark current of each set point; None of one exposure time.

    The law of rates tells how far the median pixel's is off the mean; it is in
    proportion at other temperatures. black : DN."""
    mean = of_all(fit.figures, "dark current")
    if mean is None:
        return None
    shift = spread.median if spread is not None else Measured(0.0, 0.0, "DN/s")
    error = math.hypot(mean.standard_error, shift.standard_error)
    median = Measured(mean.value + shift.value, error, "DN/s")
    ratio = median.value / mean.value if mean.stands_out else 1.0
    splits = ["", *fit.others]
    groups = seen.statistics.groups
    rates = [median, *(one.scaled(ratio, "DN/s") for one in fit.others.values())]
    temperatures = []
    for split in splits:
        own = [n for n in seen.darks if groups[n].split == split]
        longer = [n for n in own if n not in seen.shortest] or own
        known = [t for n in longer if (t := groups[n].temperature) is not None]
        temperatures.append(float(np.mean(known)) if known else None)
    listed = tuple(zip(temperatures, rates, strict=True))
    points = tuple(
        (
            seen.time(n),
            ratio * (float(seen.levels(n).mean()) - black),
            splits.index(groups[n].split),
        )
        for n in seen.darks
        if groups[n].split in splits
    )
    return DarkCurrent(listed, _doubling(listed), points)


def _doubling(rates: Sequence[tuple[float | None, Measured]]) -> Measured | None:
    """Return by how many kelvin the rate doubles, of the two farthest set points whose
    rates stand out."""
    known = [(t, r) for t, r in rates if t is not None and r.stands_out and r.value > 0]
    if len(known) < 2:
        return None
    known.sort(key=lambda item: item[0])
    (cold, a), (warm, b) = known[0], known[-1]
    rise = math.log(b.value / a.value)
    if rise <= 0:
        return None
    value = (warm - cold) * math.log(2) / rise
    error = math.hypot(a.standard_error / a.value, b.standard_error / b.value)
    return Measured(value, value * error / rise, "K")
