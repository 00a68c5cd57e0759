# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Heavy-tailed read noise: a share of the draws is wider, of other pixels each time. By
the differences of two frames, of the shortest darks of both splits."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import minimize
from scipy.special import erf, erfc, erfinv, expit, logit

from cg2raw.model.figures import Figure
from cg2raw.model.recorded import FEW_CODES, differences
from cg2raw.model.shapes.base import Shape, Shown, points_of
from cg2raw.model.shapes.random_telegraph_noise import nats_beside_jumps
from cg2raw.normal import CI95
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import BINS_PER_SIGMA, PIXEL, Array

NAME = "heavy_tailed_noise"
EDGES = np.arange(0.0, 12.1, 0.5)  # sigma; the last bin has all that is beyond
CORE, FAR = 1.5, 3.0  # sigma: within, draws are most's; beyond, few of them are
PLACES = np.arange(16) / 16  # within a code
# DN^2. Below, tails of codes depend on where within a code a sample is; above, by less
# than 1e-4: the first term of Sheppard's series, exp(-2 pi^2 variance).
LEAST_POWER = 0.5 + ROUNDING
STARTS = ((0.01, 9.0), (0.1, 4.0))  # share and ratio of variances
UNEVEN = 2.0  # variances of normal noise differ by it from place to place: no tails
MOST_SHARE, MOST_RATIO = 0.5, 80.0  # as the registry bounds them
LEAST_SHARE = 1e-12  # of a bin
STEP = 0.02  # of the numbers, of which the curvature is taken


@dataclass(frozen=True)
class Tails:
    """Residuals of pairs, by size. counts : (bins,). power : DN^2, their variance; what
    is rounded to whole codes, if that is small."""

    counts: Array
    power: float

    @cached_property
    def is_coarse(self) -> bool:
        return self.power < FEW_CODES + ROUNDING

    def shares(
        self, scale: float, share: float, ratio: float, lasting: bool = False
    ) -> Array:
        """Return (bins,) what is expected. scale : of the variance of most draws, over
        that by which all have the power. share, ratio : of draws that are wider, and
        their variance over that of the others. lasting : of both frames of a pair, as
        of a part of the sensor."""
        total = 1 + share * (ratio - 1)
        if self.is_coarse:
            narrow = scale * (self.power - ROUNDING) / total
            law = differences(PLACES, narrow, share, ratio).mean(axis=0)
            bins = len(self.counts)
            law = np.pad(law, (0, max(bins - len(law), 0)))
            found = np.append(law[: bins - 1], law[bins - 1 :].sum())
        else:
            narrow = scale / total
            weights = (1 - share) ** 2, 2 * share * (1 - share), share**2
            if lasting:
                weights = 1 - share, 0.0, share
            widths = 1.0, (1 + ratio) / 2, ratio
            below = sum(
                w * erf(EDGES / np.sqrt(2 * narrow * v))
                for w, v in zip(weights, widths, strict=True)
            )
            found = np.diff(below, append=1.0)
        return np.asarray(np.maximum(found, LEAST_SHARE))

    def nats(self, numbers: Array, lasting: bool = False) -> float:
        """Return the log likelihood. numbers : logarithm of scale, logit of share,
        logarithm of ratio; of the first alone, all are alike."""
        scale, *more = numbers
        share, ratio = (expit(more[0]), np.exp(more[1])) if more else (0.0, 1.0)
        return float(
            self.counts @ np.log(self.shares(np.exp(scale), share, ratio, lasting))
        )

    def covariance(self, best: Array) -> Array:
        """Return that of the likeliest numbers, by the curvature of the likelihood."""

        def bent(one: Array, other: Array) -> float:
            ends = [(a, b) for a in (-1, 1) for b in (-1, 1)]
            return sum(a * b * self.nats(best + a * one + b * other) for a, b in ends)

        steps = STEP * np.eye(len(best))
        curvature = np.array([[bent(one, other) for other in steps] for one in steps])
        return np.asarray(np.linalg.pinv(-curvature / (4 * STEP**2)), np.float64)

    def of_most(self, best: Array) -> tuple[float, float]:
        """Return the variance of most draws and its standard error, DN^2."""
        slopes = np.array(
            [
                (log_of_most(best + step) - log_of_most(best - step)) / (2 * STEP)
                for step in STEP * np.eye(len(best))
            ]
        )
        square = max(float(slopes @ self.covariance(best) @ slopes), 0.0)
        value = float(np.exp(log_of_most(best))) * (self.power - ROUNDING)
        return value, square**0.5 * value

    def fitted(
        self, start: Array, most: float = MOST_RATIO, lasting: bool = False
    ) -> Array:
        """Return the numbers of most likelihood, of a ratio up to @most."""
        bounds = [(-1.0, 1.0), (-12.0, logit(MOST_SHARE)), (0.01, np.log(most))]
        found = minimize(
            lambda x: -self.nats(x, lasting),
            start,
            method="Nelder-Mead",
            bounds=bounds[: len(start)],
            options={"maxfev": 200, "xatol": 1e-3, "fatol": 1e-2},
        )
        best: Array = found.x
        return best


def log_of_most(numbers: Array) -> float:
    """Return the logarithm of the variance of most draws, over that of all."""
    scale, share, ratio = numbers[0], expit(numbers[1]), np.exp(numbers[2])
    return float(scale - np.log1p(share * (ratio - 1)))


def heavy_tailed_noise(shown: Shown) -> Shape | None:
    """Return the evidence of tails, or of noisy samples beyond those that telegraph
    noise has, whichever is less; None without pairs of darks, where codes are few and
    where noise is cut at 0."""
    first, second = (tails_of(shown, split) for split in shown.splits)
    if first is None or second is None or shown.is_cut:
        return None
    if min(first.power, second.power) < LEAST_POWER:
        return None
    trained = fitted_tails(first)
    even = np.array([0.0, logit(0.1), np.log(UNEVEN) / 2])
    without = max(
        second.nats(second.fitted(start, UNEVEN, lasting), lasting)
        for start, lasting in ((np.zeros(1), False), (even, False), (even, True))
    )
    nats = second.nats(trained) - without
    nats = min(nats, nats_beside_jumps(shown))
    numbers, variances = trained, np.diagonal(first.covariance(trained))
    errors = np.sqrt(np.where(variances > 0, variances, np.nan))
    three = numbers - CI95 * errors, numbers, numbers + CI95 * errors
    figures = []
    for n, name, value_of in ((1, "fraction", expit), (2, "variance_ratio", np.exp)):
        with np.errstate(over="ignore"):  # an end that is not known is infinite
            low, value, high = (float(value_of(x[n])) for x in three)
        error = (high - low) / 2 / CI95
        figures.append(Figure(name, "1", value, error, low, high))
    return Shape(NAME, nats, tuple(figures))


def fitted_tails(found: Tails) -> Array:
    """Return the likeliest numbers of residuals."""
    ends = [found.fitted(np.array([0.0, logit(s), np.log(r)])) for s, r in STARTS]
    return max(ends, key=found.nats)


def most_of(shown: Shown, split: str) -> tuple[float, float] | None:
    """Return the variance of most draws, of which a few are wider by the law of tails,
    and its standard error, DN^2; None where codes are few."""
    found = tails_of(shown, split)
    if found is None or found.is_coarse:
        return None
    value, error = found.of_most(fitted_tails(found))
    return value * lost_of(shown), error * lost_of(shown)


def whole_of(shown: Shown, split: str) -> tuple[float, float]:
    """Return the variance of all samples over that of those that are not masked, in the
    shortest darks, and its standard error: the widest of tails are masked as points,
    and few. 1, 0 without pairs."""
    darks = shown.statistics.shortest_darks(split)
    planes = shown.statistics.planes
    points = points_of(shown.statistics)
    count = np.array([p.unmasked for p in planes])
    if not len(darks) or not count.sum():
        return 1.0, 0.0
    kept = float(count @ [p.power[darks].mean() for p in planes]) / count.sum()
    masked = np.concatenate(
        [
            p.outlier_noise[darks][:, own].mean(axis=0)
            for p, own in zip(planes, points, strict=True)
        ]
    )
    share = count.sum() / (count.sum() + masked.size)
    error = np.hypot(np.linalg.norm(masked) / kept, np.sqrt(2 * count.sum()))
    more = float(masked.sum()) / kept / count.sum()
    return float(share * (1 + more)), float(share * error / count.sum())


def lost_of(shown: Shown) -> float:
    """Return by how much noise is more than residuals, which have lost what their lines
    have."""
    freedom = sum(float(p.freedom[PIXEL]) for p in shown.statistics.planes)
    return shown.statistics.unmasked / freedom


def core_of(shown: Shown, split: str) -> tuple[float, float] | None:
    """Return the variance of most draws and its standard error, DN^2, by how many are
    within CORE; None where codes are few."""
    found = tails_of(shown, split)
    if found is None or found.is_coarse:
        return None
    count = found.counts.sum()
    far = found.counts[EDGES >= FAR].sum() - count * erfc(FAR / np.sqrt(2))
    left = count - max(far, 0.0)
    share = float(found.counts[EDGES < CORE].sum() / left)
    sigma = CORE / np.sqrt(2) / float(erfinv(share))
    density = np.exp(-((CORE / sigma) ** 2) / 2) / np.sqrt(2 * np.pi)
    error = sigma**3 / (CORE * density) * np.sqrt(share * (1 - share) / left)
    power = found.power * lost_of(shown)
    return sigma**2 * power - ROUNDING, float(error) * power


def tails_of(shown: Shown, split: str) -> Tails | None:
    """Return the residuals of the shortest darks that repeat each other."""
    darks = shown.statistics.shortest_darks(split)
    if not len(darks):
        return None
    planes = shown.statistics.planes
    power = float(np.mean([plane.power[darks].mean() for plane in planes]))
    found = Tails(np.zeros(1, float), power)
    fine = sum(plane.residuals[darks].sum(axis=0) for plane in planes)
    middles = (np.arange(len(fine)) + 0.5) / BINS_PER_SIGMA
    if found.is_coarse:
        at = np.rint(middles * np.sqrt(2 * power)).astype(int)
    else:
        at = np.searchsorted(EDGES, middles, side="right") - 1
    return Tails(np.bincount(at, weights=fine).astype(float), power)
