# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Residual tests: whether structure is left in the residuals, and where.

Every test asks the standardised residuals of held-out frames one question; without a
gap they are independent N(0, 1), and each statistic has a known distribution.
"""

import numpy as np
from scipy.stats import chi2, norm, poisson

from cg2raw.diagnose.assessment.residual_statistics import (
    Statistics,
    TestSums,
    statistics_of,
)
from cg2raw.diagnose.diagnosis import ResidualTest
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

FEWEST_PIXELS = 20.0  # pixels of a group
MOST_NATS = 200.0  # that one pixel counts

WHERE = {
    "channel": "differs between the sites of the CFA",
    "radius by channel": "changes from the centre to the corners, by site of the CFA",
    "level by channel": "depends on the level of the signal, by site of the CFA",
    "tile by channel": "differs between places of the frame, by site of the CFA",
    "radius": "changes from the centre to the corners",
    "level": "depends on the level of the signal",
    "tile": "differs between places of the frame",
    "row": "differs from row to row",
    "column": "differs from column to column",
    "frame": "differs from frame to frame",
    "autocorrelation": "neighbouring pixels share their noise",
    "skewness": "the noise is lopsided",
    "kurtosis": "the noise has heavier or lighter tails than a normal",
    "edge": "lies along edges",
    "fixed": "the same pixels differ in all frames",
    "white": "pixels are below white that are predicted far above it",
    "outliers": "pixels stand out that stood out in other frames",
}


def residual_tests(
    model: Model, likelihood: Likelihood, others: Likelihood
) -> list[ResidualTest]:
    """Return all tests, those that explain most nats first.

    others : frames of another split, which only say which pixels may stand out."""
    collected = statistics_of(model, likelihood, others)
    names = dict.fromkeys(name for name, _ in collected.sums)
    tests = [_tested(n, collected.of_test(n), collected.pixels) for n in names]
    tests.append(_fixed(collected))
    if any(part.size for part in collected.below_white):
        tests.append(_below_white(collected))
    if collected.outliers.suspects:
        tests.append(_outliers(collected))
    return sorted(tests, key=lambda test: -test.nats_per_pixel)


def _where(name: str) -> str:
    key = name.split(":")[0].removesuffix(" mean").split(" (")[0]
    text = WHERE.get(key) or WHERE.get(key.split()[0], name)
    if name.endswith("variance"):
        return f"the size of the residuals {text}"
    return f"the residual {text}" if "mean" in name else text


def _tested(name: str, sums: TestSums, pixels: int) -> ResidualTest:
    if sums.squared:
        statistic, freedom = float(sums.score), float(sums.variance)
        p_value = float(chi2.sf(statistic, freedom))
        size, nats = statistic / max(freedom, 1) - 1, 0.5 * (statistic - freedom)
    elif np.ndim(sums.score):
        score, variance = np.asarray(sums.score), np.asarray(sums.whole_variance)
        enough = variance > FEWEST_PIXELS
        statistic = float((score[enough] ** 2 / variance[enough]).sum())
        freedom = int(enough.sum())
        p_value = float(chi2.sf(statistic, freedom)) if freedom else 1.0
        size, nats = statistic / max(freedom, 1) - 1, 0.5 * (statistic - freedom)
    else:
        size = float(sums.score / np.sqrt(max(float(sums.variance), 1.0)))
        p_value, nats = float(2 * norm.sf(abs(size))), 0.5 * (size**2 - 1)
    return ResidualTest(name, size, p_value, nats / max(pixels, 1), _where(name))


def _fixed(c: Statistics) -> ResidualTest:
    """The product of a pixel's residuals over frames, without what a map explains."""
    excess, variance = 0.0, 0.0
    for one in c.fixed.values():
        counts = np.asarray(one.counts, float)
        used = counts > 1
        excess += float((one.residuals**2 - one.squares - one.of_patterns)[used].sum())
        variance += float((2 * counts[used] * (counts[used] - 1)).sum())
    size = excess / np.sqrt(max(variance, 1.0))
    p_value, nats = float(2 * norm.sf(abs(size))), 0.5 * (size**2 - 1)
    name = "fixed pattern: the same pixel in all frames"
    return ResidualTest(name, size, p_value, nats / max(c.pixels, 1), WHERE["fixed"])


def _below_white(c: Statistics) -> ResidualTest:
    """Pixels that should have reached white by far, and did not: none by chance."""
    away = np.concatenate(c.below_white)
    nats = float(np.minimum(0.5 * away**2, MOST_NATS).sum())
    name = "white: pixels that should have reached it"
    p_value = float(2 * norm.sf(np.abs(away).max()))
    per_pixel = nats / max(c.pixels, 1)
    return ResidualTest(name, float(away.size), p_value, per_pixel, WHERE["white"])


def _outliers(c: Statistics) -> ResidualTest:
    """Pixels that stand out in two groups of frames, against as many anywhere: Poisson
    by chance."""
    seen = c.outliers
    chance = (seen.elsewhere + 1) / max(seen.rest, 1) * seen.suspects
    p_value = float(poisson.sf(seen.again - 1, chance)) if seen.again else 1.0
    size = (seen.again - chance) / np.sqrt(max(chance, 1.0))
    nats = seen.again * np.log(max(seen.again, 1) / max(chance, 1e-9))
    nats = float(nats) - (seen.again - chance) if seen.again > chance else 0.0
    per_pixel = nats / max(c.pixels, 1)
    name = "outliers: the same pixels in other frames"
    return ResidualTest(name, float(size), p_value, per_pixel, WHERE["outliers"])
