# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Log-normal map: how fast the charge of each pixel gathers, by empirical Bayes.

A pixel's value is rate (e^(log_sigma n) - 1), n normal. That law is taken as a sum of
narrow normals, so that its likelihood and its posterior are closed; its numbers are
those of maximum likelihood over all pixels. Source: M. Stephens, Biostatistics 18(2),
2017 (empirical Bayes by a mixture of normals).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, logit

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import NORMAL_95, SensorMap, Values
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference import exponential_rates
from cg2raw.diagnose.inference.log_normal_law import LogNormal, Rates
from cg2raw.diagnose.inference.map_prior import NEARLY, Stated

CLASSES = 400  # of pixels alike that the law is fitted to; the outermost are single
LOG_SIGMAS = (0.2, 0.7, 1.5)  # that the fit starts from
# log_sigma; a wider law is one of few pixels that are hot, and says nothing of most.
NARROWEST, WIDEST = 0.02, 2.0
MIDDLE_SHARES = (
    0.159,
    0.5,
    0.841,
)  # of the pixels, one standard deviation to either side
HOT_SHARES = (1e-7, 0.2)
HOT = 6.0  # such deviations above the median, from which on pixels may be hot
FIRST_STEPS, NEXT_STEPS = 0.3, 0.03  # of all numbers of the law, in units or logs
SEARCH = {"maxiter": 500, "xatol": 1e-3, "fatol": 0.01}


@dataclass(frozen=True)
class LogNormalMap:
    """What a law says of pixels whose rates (T, h, w) are known. classes : of pixels
    alike, and how many they are."""

    mixture: "Mixture"
    rates: Rates
    known: Mask
    classes: tuple[Rates, Values]

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
        beyond = hot, hot * mean, (1 - cold**2) * unsure
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
    start: "Mixture | None" = None,
    stated: Stated = None,
) -> LogNormalMap | None:
    """Return the map of rates (T, h, w); None if pixels do not differ.

    What is not known of a pixel is as wide as the law. start : where the search for it
    begins, if one is known. stated : numbers of a law, which holds if it is nearly as
    likely."""
    if not known.any():
        return None
    classes, count = _classes(rates.at(known))
    mixture = _most_likely(classes, count, start)
    if mixture is None:
        return None
    if stated is not None:
        mixture = _nearly_stated(mixture, stated, classes, count)
    return LogNormalMap(mixture, rates, known, (classes, count))


def _classes(rates: Rates) -> tuple[Rates, Values]:
    """Return (means, number) of classes of pixels alike."""
    order = np.argsort(rates.estimate, kind="stable")
    ends = expit(np.linspace(-1, 1, CLASSES + 1) * np.log(max(order.size, 2)))
    starts = np.unique([0, *(ends[1:-1] * order.size).astype(int)])
    count = np.diff([*starts, order.size])
    ordered = rates.at(order)
    means = (np.add.reduceat(column, starts) / count for column in ordered.columns)
    return Rates(*means), count.astype(float)


@dataclass(frozen=True)
class Mixture:
    """The law of most pixels, and an exponential one of the few that are hot: beyond
    what a log-normal law says, they are for the effect hot_pixels to explain."""

    law: LogNormal
    hot_share: float = 0.0
    hot_rate: float = 1.0

    @staticmethod
    def of(numbers: Values, unit: float) -> "Mixture":
        """numbers : shift, log rate, log log_sigma and, where pixels may be hot, the
        log of odds and of their mean rate; rates in a unit."""
        shift, log_rate, log_log_sigma = numbers[:3]
        log_sigma = np.clip(np.exp(log_log_sigma), NARROWEST, WIDEST)
        law = LogNormal(shift * unit, np.exp(log_rate) * unit, float(log_sigma))
        if len(numbers) == 3:
            return Mixture(law)
        share = float(np.clip(expit(numbers[3]), *HOT_SHARES))
        return Mixture(law, share, max(float(np.exp(numbers[4])), HOT / 2) * unit)

    def numbers(self, unit: float) -> list[float]:
        """Return the numbers that it is of."""
        law = self.law
        shape = [law.shift / unit, np.log(law.rate / unit), np.log(law.log_sigma)]
        if not self.hot_share:
            return [float(number) for number in shape]
        hot = [logit(self.hot_share), np.log(self.hot_rate / unit)]
        return [float(number) for number in (*shape, *hot)]

    def logs(self, rates: Rates) -> tuple[Array, Array]:
        """Return log densities of estimates, of pixels that are not hot and that
        are."""
        cold = np.log1p(-self.hot_share) + self.law.log_density(rates)
        if self.hot_share == 0:
            return cold, np.full_like(cold, -np.inf)
        away, spread = rates.estimate - self.law.shift, np.sqrt(rates.error)
        hot = exponential_rates.log_density(away, spread, self.hot_rate)
        return cold, np.log(self.hot_share) + hot

    def height(self, classes: Rates, count: Values) -> float:
        return float(count @ np.logaddexp(*self.logs(classes)))

    def posterior(self, rates: Rates) -> tuple[Array, Array, Array]:
        """Return (mean, variance, probability to be hot) of each pixel."""
        cold, hot = self.logs(rates)
        share = expit(hot - cold)
        mean, variance = self.law.posterior(rates)
        if self.hot_share == 0:
            return mean, variance, share
        away = rates.estimate - self.law.shift
        spread = np.sqrt(rates.error_at(np.maximum(away, 0)))
        of_hot = exponential_rates.posterior(away, spread, self.hot_rate)
        both = (1 - share) * mean + share * of_hot[0]
        squares = (1 - share) * (variance + mean**2)
        squares = squares + share * (of_hot[1] + of_hot[0] ** 2)
        return both, np.maximum(squares - both**2, 0), share


def _most_likely(
    classes: Rates, count: Values, start: Mixture | None
) -> Mixture | None:
    """Return the law of maximum likelihood; None if noise alone is as likely: hot
    pixels, which other maps would take, have a law too where no others differ.

    That pixels are hot besides has to gain what two numbers cost. Source: G. Schwarz,
    Ann. Stat. 6(2), 1978."""
    estimate, error = classes.estimate, classes.error
    low, middle, high = (_quantile(classes, count, q) for q in MIDDLE_SHARES)
    unit = max((high - low) / 2, 1e-12)
    spread = np.sqrt(max(unit**2 - np.median(error), (0.1 * unit) ** 2)) / unit
    if start is None:
        shapes = [
            [middle / unit, np.log(spread / np.sinh(shape)), np.log(shape)]
            for shape in LOG_SIGMAS
        ]
        steps = FIRST_STEPS
    else:
        shapes, steps = [start.numbers(unit)[:3]], NEXT_STEPS

    def of(numbers: Values) -> Mixture:
        return Mixture.of(numbers, unit)

    plain, height = _best(of, shapes, steps, classes, count)
    level = (count / error) @ estimate / (count / error).sum()
    noise = -0.5 * (estimate - level) ** 2 / error - 0.5 * np.log(2 * np.pi * error)
    least = float(count @ noise) + len(shapes[0]) / 2
    found, height = (plain, height) if height >= least else (None, least)
    hot = _hot_start(classes, count, unit, start)
    if hot is None:
        return found
    mixed_shapes = [[*shape, *hot] for shape in shapes]
    mixed, with_hot = _best(of, mixed_shapes, steps, classes, count)
    return mixed if with_hot - height > np.log(count.sum()) else found


def _nearly_stated(
    found: Mixture, stated: Mapping[str, float], classes: Rates, count: Values
) -> Mixture:
    """Return the most likely law that has a profile's numbers, and as many hot pixels
    as it leaves, if that is nearly as likely as the one that was found; else that one.
    A law without any may be wide by these pixels: it is less likely then."""
    if stated["rate"] <= 0 or stated["log_sigma"] <= 0:
        return found
    law = LogNormal(found.law.shift, stated["rate"], stated["log_sigma"])
    unit = max(found.law.sigma, law.sigma)
    _, log_rate, log_log_sigma, *_ = Mixture(law).numbers(unit)

    def of(free: Values) -> Mixture:
        """free : shift and, where pixels may be hot, the numbers of these."""
        free = np.array([free[0], log_rate, log_log_sigma, *free[1:]])
        found = Mixture.of(free, unit)
        return replace(found, law=replace(law, shift=found.law.shift))

    shift = law.shift / unit
    moved, height = _best(of, [[shift]], FIRST_STEPS, classes, count)
    likeliest = found.height(classes, count)
    hot = _hot_start(classes, count, unit, found)
    if hot is not None:
        mixed, with_hot = _best(of, [[shift, *hot]], FIRST_STEPS, classes, count)
        least = height + np.log(count.sum())
        if with_hot > (least if found.hot_share else max(least, likeliest)):
            moved, height = mixed, with_hot
    lost = likeliest - height
    return moved if lost < NEARLY * count.sum() else found


def _best(
    law_of: Callable[[Values], Mixture],
    starts: Sequence[Sequence[float]],
    steps: float,
    classes: Rates,
    count: Values,
) -> tuple[Mixture, float]:
    """Return (most likely law of some numbers, its log-likelihood): from the best of
    all starts."""

    def cost(numbers: Values) -> float:
        return -law_of(numbers).height(classes, count)

    first = min((np.array(one, float) for one in starts), key=cost)
    simplex = first + steps * np.eye(first.size + 1, first.size, -1)
    how = {**SEARCH, "initial_simplex": simplex}
    found = minimize(cost, first, method="Nelder-Mead", options=how)
    return law_of(found.x), -float(found.fun)


def _hot_start(
    classes: Rates, count: Values, unit: float, start: Mixture | None
) -> Sequence[float] | None:
    """Return where a search begins for the share and the rate of those that are hot;
    None if no pixel is far out."""
    if start is not None and start.hot_share > 0:
        return start.numbers(unit)[3:]
    middle = _quantile(classes, count, 0.5)
    far = classes.estimate > middle + HOT * unit
    if not far.any():
        return None
    mean = count[far] @ (classes.estimate[far] - middle) / count[far].sum()
    share = count[far].sum() / count.sum()
    return [float(logit(min(share, HOT_SHARES[1]))), float(np.log(mean / unit))]


def _quantile(classes: Rates, count: Values, share: float) -> float:
    return float(np.interp(share, count.cumsum() / count.sum(), classes.estimate))


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
