# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Rate mixture: the law of most pixels' rates, and that of the few that are hot.

Its numbers are those of maximum likelihood over all pixels."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, logit

from cg2raw.diagnose.effects.base import Values
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference import exponential_rates
from cg2raw.diagnose.inference.log_normal_law import LogNormal, Rates

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


def most_likely(classes: Rates, count: Values, start: Mixture | None) -> Mixture | None:
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

    plain, height = best(of, shapes, steps, classes, count)
    level = (count / error) @ estimate / (count / error).sum()
    noise = -0.5 * (estimate - level) ** 2 / error - 0.5 * np.log(2 * np.pi * error)
    least = float(count @ noise) + len(shapes[0]) / 2
    found, height = (plain, height) if height >= least else (None, least)
    hot = hot_start(classes, count, unit, start)
    if hot is None:
        return found
    mixed_shapes = [[*shape, *hot] for shape in shapes]
    mixed, with_hot = best(of, mixed_shapes, steps, classes, count)
    return mixed if with_hot - height > np.log(count.sum()) else found


def best(
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


def hot_start(
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
