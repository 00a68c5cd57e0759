# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Log-normal map: how fast the charge of each pixel gathers, by empirical Bayes.

A pixel's value is rate (e^(log_sigma n) - 1), n normal. That law is taken as a sum of
narrow normals, so that its likelihood and its posterior are closed; its numbers are
those of maximum likelihood over all pixels. Source: M. Stephens, Biostatistics 18(2),
2017 (empirical Bayes by a mixture of normals).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, logit

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import NORMAL_95, Values
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference import exponential_rates

STEP = 0.25  # of n, between the narrow normals and of each
LARGEST_N = 5.5  # n beyond which no pixel is
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
LEAST_ERROR = 0.05  # of a variance, that is left where a rate is below the median


def log_sum(logs: Array) -> Array:
    """Return the log of sums over the first axis, of finite logs."""
    top = logs.max(0)
    return np.asarray(top + np.log(np.exp(logs - top).sum(0)))


@dataclass(frozen=True)
class LogNormal:
    """The law of rate (e^(log_sigma n) - 1), beside a common shift of all estimates."""

    shift: float
    rate: float
    log_sigma: float

    @property
    def sigma(self) -> float:
        """Half of the range that the middle 68.3 % of the pixels have."""
        return float(self.rate * np.sinh(self.log_sigma))

    def normals(self) -> tuple[Values, Values, Values]:
        """Return (log weights, means, variances) of the sum of normals, without the
        shift; each has the moments of its part of the law."""
        n = np.arange(-LARGEST_N, LARGEST_N + STEP / 2, STEP)
        weights = -0.5 * n**2 / (1 - STEP**2)
        part = (self.log_sigma * STEP) ** 2
        size = self.rate * np.exp(self.log_sigma * n + part / 2)
        return weights - log_sum(weights), size - self.rate, size**2 * np.expm1(part)

    def log_parts(self, rates: "Rates") -> Array:
        """Return (k, ...) log density of estimates by each normal."""
        weights, means, variances = (
            part.reshape(-1, *[1] * rates.estimate.ndim) for part in self.normals()
        )
        total = variances + rates.error_at(means)
        away = rates.estimate - self.shift - means
        return np.asarray(weights - 0.5 * (away**2 / total + np.log(2 * np.pi * total)))

    def posterior(self, rates: "Rates") -> tuple[Array, Array]:
        """Return (mean, variance) of each pixel's value, given its estimate."""
        mean, square = np.zeros((2, *rates.estimate.shape))
        logs = self.log_parts(rates)
        share = np.exp(logs - log_sum(logs))
        for part, middle, variance in zip(share, *self.normals()[1:], strict=True):
            error = rates.error_at(middle)
            kept = variance / (variance + error)
            value = middle + kept * (rates.estimate - self.shift - middle)
            mean += part * value
            square += part * (value**2 + kept * error)
        return mean, np.maximum(square - mean**2, 0)


@dataclass(frozen=True)
class Rates:
    """Estimates of pixels, with their variance where the rate is 0, and what a rate
    adds to it by the shot noise of its charge."""

    estimate: Array
    error: Array
    per_rate: Array

    def error_at(self, rate: Array | float) -> Array:
        """Return the variance of estimates of a rate."""
        least = LEAST_ERROR * self.error
        return np.asarray(np.maximum(self.error + self.per_rate * rate, least))

    @property
    def columns(self) -> tuple[Array, Array, Array]:
        return self.estimate, self.error, self.per_rate

    def at(self, places: Any) -> "Rates":
        return Rates(*(column[places] for column in self.columns))


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
        middle = float(np.exp(weights) @ means)
        return middle, float(np.exp(weights) @ (variances + means**2)) - middle**2

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

    @property
    def _tiles(self) -> list[Rates]:
        return [self.rates.at(tile) for tile in range(len(self.rates.estimate))]


def fit_log_normal_map(
    rates: Rates, known: Mask, start: "Mixture | None" = None
) -> LogNormalMap | None:
    """Return the map of rates (T, h, w); None if pixels do not differ.

    What is not known of a pixel is as wide as the law. start : where the search for it
    begins, if one is known."""
    if not known.any():
        return None
    classes, count = _classes(rates.at(known))
    mixture = _most_likely(classes, count, start)
    if mixture is None:
        return None
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
        cold = np.log1p(-self.hot_share) + log_sum(self.law.log_parts(rates))
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
    """Return the law of maximum likelihood; None if noise alone is as likely.

    That pixels are hot besides has to gain what two numbers cost. Source: G. Schwarz,
    Ann. Stat. 6(2), 1978."""
    estimate, error = classes.estimate, classes.error
    low, middle, high = np.interp(MIDDLE_SHARES, count.cumsum() / count.sum(), estimate)
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

    def best(starts: Sequence[Sequence[float]]) -> tuple[Mixture, float]:
        def cost(numbers: Values) -> float:
            return -Mixture.of(numbers, unit).height(classes, count)

        first = min((np.array(one, float) for one in starts), key=cost)
        simplex = first + steps * np.eye(first.size + 1, first.size, -1)
        how = {**SEARCH, "initial_simplex": simplex}
        found = minimize(cost, first, method="Nelder-Mead", options=how)
        return Mixture.of(found.x, unit), -float(found.fun)

    plain, height = best(shapes)
    level = (count / error) @ estimate / (count / error).sum()
    noise = -0.5 * (estimate - level) ** 2 / error - 0.5 * np.log(2 * np.pi * error)
    if height < float(count @ noise) + len(shapes[0]) / 2:
        return None
    hot = _hot_start(classes, count, middle, unit, start)
    if hot is None:
        return plain
    mixed, with_hot = best([[*shape, *hot] for shape in shapes])
    return mixed if with_hot - height > np.log(count.sum()) else plain


def _hot_start(
    classes: Rates, count: Values, middle: float, unit: float, start: Mixture | None
) -> Sequence[float] | None:
    """Return where a search begins for the share and the rate of those that are hot;
    None if no pixel is far out."""
    if start is not None and start.hot_share > 0:
        return start.numbers(unit)[3:]
    far = classes.estimate > middle + HOT * unit
    if not far.any():
        return None
    mean = count[far] @ (classes.estimate[far] - middle) / count[far].sum()
    share = count[far].sum() / count.sum()
    return [float(logit(min(share, HOT_SHARES[1]))), float(np.log(mean / unit))]


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
