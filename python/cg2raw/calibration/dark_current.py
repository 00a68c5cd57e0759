# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark current: charge that gathers with time, and how it doubles with temperature.

Source: EMVA Standard 1288, release 4.0, section on dark current (a line over exposure
time; doubling temperature)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.measured import Measured
from cg2raw.calibration.robust import Array

MOST_SCATTER = 0.5  # relative, of the charge of one exposure


@dataclass(frozen=True)
class DarkPoint:
    """The middle of a group's pixels above the bias level.

    excess : DN above the first group. set_point : number of its temperature.
    frames : how many. statistical : DN, error of the middle by the pixels' noise."""

    exposure_time: float
    temperature: float | None
    set_point: int
    excess: float
    frames: int
    statistical: float


@dataclass(frozen=True)
class DarkCurrent:
    """Dark current of the median pixel.

    rates : (temperature or None, DN/s) of each set point, that of most frames first.
    intercept : DN, of the line above the first group. doubling : K.
    points : what the line was laid through. scatter : of the groups beyond drift: DN
    of a level that moves from one series to the next; if it grows, relative to the
    charge, as a temperature that is not held brings it."""

    rates: tuple[tuple[float | None, Measured], ...]
    intercept: float
    doubling: Measured | None
    points: tuple[DarkPoint, ...]
    scatter: float
    scatter_grows: bool

    @property
    def rate(self) -> Measured:
        """At the set point of most frames, DN/s."""
        return self.rates[0][1]


def dark_current(points: Sequence[DarkPoint], drift: float) -> DarkCurrent | None:
    """Return the lines over exposure time of all set points through one bias level;
    None if all exposures are the same.

    drift : DN, of one frame's level."""
    times = {point.exposure_time for point in points}
    if len(times) < 2:
        return None
    shortest = min(times)
    charged = [p for p in points if p.exposure_time > shortest]
    order = sorted(
        {p.set_point for p in charged},
        key=lambda s: -sum(p.frames for p in charged if p.set_point == s),
    )
    values, covariance, scatter, grows = _weighed(points, order, drift)
    rates = []
    for index, number in enumerate(order, 1):
        known = [
            p.temperature
            for p in charged
            if p.set_point == number and p.temperature is not None
        ]
        error = math.sqrt(max(float(covariance[index, index]), 0.0))
        mean = float(np.mean(known)) if known else None
        rates.append((mean, Measured(float(values[index]), error, "DN/s")))
    return DarkCurrent(
        tuple(rates), float(values[0]), _doubling(rates), tuple(points), scatter, grows
    )


def _weighed(
    points: Sequence[DarkPoint], order: Sequence[int], drift: float
) -> tuple[Array, Array, float, bool]:
    """Return (values, covariance, scatter, whether it grows with the charge).

    Groups that scatter beyond drift have a variance more, which makes chi-square equal
    its degrees of freedom (J. Mandel, R. Paule, Anal. Chem. 42, 1970): of the level,
    DN, or relative to the charge, whichever makes the points more likely."""
    freedom = len(points) - len(order) - 1
    values, covariance, chi2, _ = _lines(points, order, drift, 0.0, False)
    if freedom <= 0 or chi2 <= freedom:
        return values, covariance, 0.0, False
    largest = max(abs(point.excess) for point in points)
    best = None
    for grows, high in ((False, largest), (True, MOST_SCATTER)):
        low = 0.0
        for _ in range(40):
            scatter = (low + high) / 2
            chi2 = _lines(points, order, drift, scatter, grows)[2]
            low, high = (scatter, high) if chi2 > freedom else (low, scatter)
        fit = _lines(points, order, drift, scatter, grows)
        if best is None or fit[3] > best[0]:
            best = fit[3], fit[0], fit[1], scatter, grows
    assert best is not None
    return best[1:]


def _lines(
    points: Sequence[DarkPoint],
    order: Sequence[int],
    drift: float,
    scatter: float,
    grows: bool,
) -> tuple[Array, Array, float, float]:
    """Return (bias level and rates, covariance, chi-square, log likelihood) by weighted
    least squares.

    A set point without its own long darks has no column: its short ones count for the
    bias level alone."""
    design = np.zeros((len(points), 1 + len(order)))
    design[:, 0] = 1
    excess, variance = np.zeros((2, len(points)))
    for index, point in enumerate(points):
        if point.set_point in order:
            column = 1 + order.index(point.set_point)
        else:
            column = 1
        design[index, column] = point.exposure_time
        excess[index] = point.excess
        of_level = drift**2 / point.frames + point.statistical**2
        more = scatter * (point.excess if grows else 1.0)
        variance[index] = of_level + more**2
    weight = 1 / np.sqrt(np.maximum(variance, 1e-12))
    scaled = design * weight[:, None]
    values = np.linalg.lstsq(scaled, excess * weight, rcond=None)[0]
    covariance = np.linalg.pinv(scaled.T @ scaled)
    chi2 = float((((excess - design @ values) * weight) ** 2).sum())
    likelihood = float(np.log(weight).sum()) - chi2 / 2
    return values, covariance, chi2, likelihood


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
