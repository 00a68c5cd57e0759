# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark current of pixels: its spread and hot pixels, by the law of their rates."""

import math
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.calibration.measured import FLOOR, Measured
from cg2raw.calibration.robust import Array
from cg2raw.model.dark_law import (
    FAR,
    LEAST_HOT,
    LEAST_LOG_SIGMA,
    LEAST_NATS,
    MOST_HOT,
    MOST_LOG_SIGMA,
    DarkLaw,
    fitted,
    median_by,
    nats_of,
    quantile,
)
from cg2raw.model.shapes.hot_pixels import LAW
from cg2raw.statistics.constant import DarkRates

SHARES = (0.9, 0.99, 0.999, 0.9999)  # quantiles that are told
FALL95 = 1.92  # nats by which the likelihood falls to its limit of 95 %
AT_BOUND = 0.01  # relative, to a bound of the search


@dataclass(frozen=True)
class DarkSpread:
    """Rates of pixels above the median, DN/s.

    median : by how much that is above the mean of pixels that are not masked.
    rate, log_sigma : of rate * (exp(log_sigma n) - 1), n normal. fraction, hot_rate :
    share of hot pixels, and the mean of their exponential law.
    quantiles : {share: DN/s}, as measured. noise : DN/s, of a pixel's rate.
    most_hot : share of hot pixels, of a mean rate of 20 times the noise, that there may
    be (95 %)."""

    median: Measured
    rate: Measured
    log_sigma: Measured
    fraction: Measured
    hot_rate: Measured
    quantiles: dict[float, float]
    noise: float
    spread_nats: float
    hot_nats: float
    most_hot: float

    @property
    def has_too_many_hot(self) -> bool:
        """Whether the share of hot pixels is at the end of the search, or the law of
        the others is so wide that it has hot ones, too: no number was measured."""
        is_wide = self.log_sigma.value > (1 - AT_BOUND) * MOST_LOG_SIGMA
        return self.has_most_hot or (is_wide and self.spread_nats >= LEAST_NATS)

    @property
    def has_most_hot(self) -> bool:
        """Whether there are as many hot pixels as are searched for, or more."""
        return self.fraction.value > (1 - AT_BOUND) * MOST_HOT

    @property
    def has_hot(self) -> bool:
        """Whether there are hot pixels beyond chance, as many as are searched for."""
        seen = self.hot_nats >= LEAST_NATS and self.fraction.stands_out
        return seen and not self.has_too_many_hot

    @property
    def is_uneven(self) -> bool:
        """Whether the others' rates differ beyond chance, and not as a normal law's,
        which would be noise that is wider than it was taken for."""
        log_sigma = self.log_sigma.value
        is_wide = (self.rate.value * log_sigma) ** 2 > FLOOR * self.noise**2
        is_skew = log_sigma > LEAST_LOG_SIGMA * (1 + AT_BOUND)
        seen = self.spread_nats >= LEAST_NATS and self.rate.stands_out
        return is_wide and is_skew and seen and not self.has_too_many_hot

    @property
    def hot_words(self) -> str:
        """Say what is known of a share of hot pixels that was not measured."""
        if self.has_hot:
            return ""
        if self.has_most_hot:
            return f"more than {MOST_HOT:.0%}"
        if self.has_too_many_hot:
            return "not told from the others, which are as uneven"
        most = f"{100 * self.most_hot:.2g} % of a mean of {FAR * self.noise:.3g} DN/s"
        return f"not found; below {most}"

    @property
    def uneven_words(self) -> str:
        """Say why rates of the others were not measured."""
        if self.is_uneven:
            return ""
        return "not shown among so many hot" if self.has_too_many_hot else "not found"


def dark_spread(rates: DarkRates, gain: float) -> DarkSpread:
    """Return the law of rates by maximum likelihood.

    gain : DN^2 of noise for each DN of charge, 0 where it is not known."""
    counts, noise = rates.counts.astype(float), rates.noise
    shot = gain * rates.charge / noise
    flat = fitted(counts, shot, uneven=False, hot=True)
    cold = fitted(counts, shot, uneven=True, hot=False)
    both = fitted(counts, shot, uneven=True, hot=True)
    _, *errors = map(float, both.errors)
    rate = Measured(both.rate * noise, errors[0] * noise, "DN/s")
    hot_rate = Measured(both.hot_rate * noise, errors[3] * noise, "DN/s")
    median, error = median_by(counts, shot, flat, both)
    middle = quantile(counts, 0.5)
    return DarkSpread(
        Measured(median * noise, math.hypot(error, LAW * median) * noise, "DN/s"),
        rate,
        Measured(both.log_sigma, errors[1], "1"),
        Measured(both.fraction, errors[2], "1"),
        hot_rate,
        {share: (quantile(counts, share) - middle) * noise for share in SHARES},
        noise,
        both.nats - flat.nats,
        both.nats - cold.nats,
        most_hot(counts, both),
    )


def most_hot(counts: Array, law: DarkLaw) -> float:
    """Return the share of hot pixels, of FAR times the noise, at which the likelihood
    has fallen to its limit of 95 %: the error by its curvature is none at a bound."""
    tried = np.geomspace(LEAST_HOT, MOST_HOT, 60)
    laws = (replace(law, fraction=float(share), hot_rate=FAR) for share in tried)
    nats = np.array([nats_of(counts, one) for one in laws])
    best = int(nats.argmax())
    beyond = np.flatnonzero(nats[best:] < nats[best] - FALL95)
    return float(tried[best + beyond[0]]) if beyond.size else MOST_HOT
