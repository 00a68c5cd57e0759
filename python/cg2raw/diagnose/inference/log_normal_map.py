# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Log-normal map: how fast the charge of each pixel gathers, by empirical Bayes.

A pixel's value is rate (e^(log_sigma n) - 1), n normal. That law is taken as a sum of
narrow normals, so that its likelihood and its posterior are closed; its numbers are
those of maximum likelihood over all pixels. Source: M. Stephens, Biostatistics 18(2),
2017 (empirical Bayes by a mixture of normals).
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.special import expit

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import NORMAL_95, SensorMap, Values
from cg2raw.diagnose.effects.sensor_map import BeyondLaw
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.log_normal_law import LogNormal, Rates
from cg2raw.diagnose.inference.map_prior import Stated
from cg2raw.diagnose.inference.rate_mixture import (
    FIRST_STEPS,
    NEXT_STEPS,
    Mixture,
    best,
    hot_start,
    most_likely,
)

CLASSES = 400  # of pixels alike that the law is fitted to; the outermost are single


@dataclass(frozen=True)
class LogNormalMap:
    """What a law says of pixels whose rates (T, h, w) are known.

    classes : of pixels alike, and how many they are. lost, lost_by_hot : nats, by what
    a profile says of the law and of the hot pixels, where these are not of that."""

    mixture: Mixture
    rates: Rates
    known: Mask
    classes: tuple[Rates, Values]
    lost: float = 0.0
    lost_by_hot: float = 0.0

    @property
    def shift(self) -> float:
        """Of all estimates, that is not the map's."""
        return self.mixture.law.shift

    @cached_property
    def of_all(self) -> tuple[float, float]:
        """Mean and variance of the law."""
        weights, means, variances = self.mixture.law.normals()
        middle = float(weights @ means)
        return middle, float(weights @ (variances + means**2)) - middle**2

    @cached_property
    def law(self) -> dict[str, Estimate]:
        """The law's numbers."""
        return _estimates(self.mixture, *self.classes)

    @cached_property
    def hot(self) -> Array:
        """The probability that a pixel is hot."""
        cold, hot = zip(*map(self.mixture.logs, self._tiles), strict=True)
        return np.where(self.known, expit(np.stack(hot) - np.stack(cold)), 0)

    @cached_property
    def posterior(self) -> tuple[Array, Array]:
        """Mean and variance of the value of each pixel, hot or not."""
        parts = [self.mixture.posterior(tile) for tile in self._tiles]
        mean, variance, _ = (np.stack(part) for part in zip(*parts, strict=True))
        middle, whole = self.of_all
        known = self.known
        return np.where(known, mean, middle), np.where(known, variance, whole)

    def of_law(self, sensor_map: SensorMap, unseen: Mask) -> SensorMap:
        """Return the map without what is hot of pixels, which is of an effect of its
        own, and with its law.

        The shot noise of a pixel's charge, that only the law knows of, makes it less
        sure. unseen : pixels that no frame was given."""
        seen = ~unseen
        hot = seen * self.hot
        cold, mean = seen - hot, seen * sensor_map.mean
        unsure = seen * np.maximum(sensor_map.variance, self.posterior[1])
        doubt = (1 - cold**2) * unsure
        beyond = BeyondLaw(hot, hot * mean, doubt, self.lost_by_hot)
        return replace(
            sensor_map,
            mean=cold * mean,
            variance=cold**2 * unsure + hot * cold * mean**2,
            covariance={k: cold * one for k, one in sensor_map.covariance.items()},
            law=self.law,
            chance=1 - self.hot,
            unknown=unseen,
            rate_law=self.mixture.law.rate_law,
            beyond_law=beyond if self.mixture.hot_share else None,
        )

    @property
    def _tiles(self) -> list[Rates]:
        return [self.rates.at(tile) for tile in range(len(self.rates.estimate))]


def fit_log_normal_map(
    rates: Rates,
    known: Mask,
    start: Mixture | None = None,
    stated: Stated | None = None,
) -> LogNormalMap | None:
    """Return the map of rates (T, h, w); None if pixels do not differ.

    What is not known of a pixel is as wide as the law. start : where the search for it
    begins, if one is known. stated : what a profile says of it, which holds if it is
    nearly as likely."""
    if not known.any():
        return None
    classes, count = _classes(rates.at(known))
    mixture = most_likely(classes, count, start)
    if mixture is None:
        return None
    lost = lost_by_hot = 0.0
    if stated is not None:
        mixture, lost = _nearly_stated(mixture, stated, classes, count)
        if stated.hot is not None:
            is_stated = bool(stated.numbers) and not lost
            mixture, lost_by_hot = _nearly_stated_hot(
                mixture, stated.hot, is_stated, classes, count
            )
    both = (classes, count)
    return LogNormalMap(mixture, rates, known, both, lost, lost_by_hot)


def _classes(rates: Rates) -> tuple[Rates, Values]:
    """Return (means, number) of classes of pixels alike."""
    order = np.argsort(rates.estimate, kind="stable")
    ends = expit(np.linspace(-1, 1, CLASSES + 1) * np.log(max(order.size, 2)))
    starts = np.unique([0, *(ends[1:-1] * order.size).astype(int)])
    count = np.diff([*starts, order.size])
    ordered = rates.at(order)
    means = (np.add.reduceat(column, starts) / count for column in ordered.columns)
    return Rates(*means), count.astype(float)


def _nearly_stated(
    found: Mixture, stated: Stated, classes: Rates, count: Values
) -> tuple[Mixture, float]:
    """Return (the most likely law that has a profile's numbers, and as many hot pixels
    as it leaves, 0) if that law holds; else (the law that was found, nats that are lost
    by the profile's).

    A law without any may be wide by hot pixels: it is less likely then."""
    numbers = stated.numbers
    if not (numbers and numbers["rate"] > 0 and numbers["log_sigma"] > 0):
        return found, 0.0
    law = LogNormal(found.law.shift, numbers["rate"], numbers["log_sigma"])
    unit = max(found.law.sigma, law.sigma)
    _, log_rate, log_log_sigma, *_ = Mixture(law).numbers(unit)

    def of(free: Values) -> Mixture:
        """free : shift and, where pixels may be hot, the numbers of these."""
        free = np.array([free[0], log_rate, log_log_sigma, *free[1:]])
        found = Mixture.of(free, unit)
        return replace(found, law=replace(law, shift=found.law.shift))

    shift = law.shift / unit
    moved, height = best(of, [[shift]], FIRST_STEPS, classes, count)
    likeliest = found.height(classes, count)
    hot = hot_start(classes, count, unit, found)
    if hot is not None:
        mixed, with_hot = best(of, [[shift, *hot]], FIRST_STEPS, classes, count)
        least = height + np.log(count.sum())
        if with_hot > (least if found.hot_share else max(least, likeliest)):
            moved, height = mixed, with_hot
    lost = likeliest - height
    return (moved, 0.0) if stated.holds(lost, count.sum()) else (found, lost)


def _nearly_stated_hot(
    found: Mixture, stated: Stated, is_law_stated: bool, classes: Rates, count: Values
) -> tuple[Mixture, float]:
    """Return the same of what a profile says of hot pixels.

    is_law_stated : of the others; their law moves a little along if it is not."""
    share, rate = (stated.numbers[name] for name in ("fraction", "rate"))
    if not (share > 0 and rate > 0):
        return found, 0.0
    unit = found.law.sigma
    shape = Mixture(found.law).numbers(unit)

    def of(free: Values) -> Mixture:
        law = Mixture.of(np.array([*free, *shape[len(free) :]]), unit).law
        if is_law_stated:
            law = replace(found.law, shift=law.shift)
        return Mixture(law, share, rate)

    free = shape[: 1 if is_law_stated else 3]
    moved, height = best(of, [free], NEXT_STEPS, classes, count)
    lost = max(found.height(classes, count) - height, 0.0)
    return (moved, 0.0) if stated.holds(lost, count.sum()) else (found, lost)


def _estimates(mixture: Mixture, classes: Rates, count: Values) -> dict[str, Estimate]:
    """Return the law's numbers with intervals from the bend of its likelihood."""
    law = mixture.law
    top = np.array([law.shift, np.log(law.rate), np.log(law.log_sigma)])
    steps = np.array([0.05 * law.sigma, 0.05, 0.05])
    axes = np.diag(steps)

    def height(numbers: Values) -> float:
        moved = Mixture.of(numbers, 1.0).law
        return replace(mixture, law=moved).height(classes, count)

    def bend(a: Values, b: Values) -> float:
        corners = ((a + b, 1), (a - b, -1), (b - a, -1), (-a - b, 1))
        return sum(sign * height(top + move) for move, sign in corners) / 4

    information = -np.array([[bend(a, b) for b in axes] for a in axes])
    covariance = np.linalg.pinv(information / np.outer(steps, steps), hermitian=True)
    of_sigma = np.array([0, 1, law.log_sigma / np.tanh(law.log_sigma)])
    slopes = {"rate": np.eye(3)[1], "log_sigma": np.eye(3)[2], "sigma": of_sigma}
    units = {"rate": "1/s", "log_sigma": "1", "sigma": "1/s"}
    result = {}
    for name, slope in slopes.items():
        value = float(getattr(law, name))
        error = np.sqrt(max(float(slope @ covariance @ slope), 0.0))
        ends = value * np.exp(np.array([-1, 1]) * min(NORMAL_95 * error, 50.0))
        result[name] = Estimate(value, units[name], (float(ends[0]), float(ends[1])))
    return result
