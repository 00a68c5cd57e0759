# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Effects of light that no derivative shows: the full well, and photons that are
counted. Each is judged by the density of single samples, on frames that did not fit it.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter
from scipy.optimize import minimize_scalar
from scipy.special import log_ndtr

from cg2raw.diagnose.effects.poisson_shot_noise import EFFECT
from cg2raw.diagnose.frames.noise_model import LEAST_VARIANCE
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.scenes.gram import Array
from cg2raw.diagnose.scenes.point import Point

BRIGHT_ENOUGH = 0.25  # of white, from which on wells are looked for
FAR_BELOW = 4.0  # standard deviations, of samples that a well cuts
NEAR = 8.0  # likewise; a sample farther below a well gains less than 1e-14
LEAST_PILE = 4  # samples of training frames that say where it is
PILES = 40  # piles that are compared before the best is made finer
LEAST_LOG = -20.0  # of a sample: one that is broken decides nothing
OF_ONE_COLOR = np.kron(np.ones((3, 3), bool), [[True, False], [False, False]])[:-1, :-1]
TAIL = 4.0  # standard deviations; farther samples say nothing of photons' law


def full_well(
    train: Sequence[Point], validation: Sequence[Point], are_blended: bool = False
) -> tuple[float, float, float]:
    """Return (level of the full well, 1 at white; its standard error; nats that
    validation frames gain by it); (1, 0, 0) where no sample says so.

    train, validation : of a model without one. are_blended : without samples next
    to one of their colour that is expected below the well: blended with it, those at
    white would be below it."""
    parts = [_bright(points, are_blended) for points in (train, validation)]
    y, x, photon, *_ = parts[0]
    short = y[(x - y > FAR_BELOW * np.sqrt(photon)) & (y > BRIGHT_ENOUGH)]
    if short.size < LEAST_PILE:
        return 1.0, 0.0, 0.0

    def cost(level: float) -> float:
        return -_gain(parts[0], level)

    piles = np.unique(np.quantile(short, np.linspace(0, 1, PILES)))
    best = min(piles, key=cost)
    width = float(np.sqrt(np.median(parts[0][3])))
    found = minimize_scalar(
        cost, bounds=(best - 3 * width, best + 3 * width), method="bounded"
    )
    level = float(found.x if found.fun < cost(best) else best)
    if level >= 1:
        return 1.0, 0.0, 0.0
    step = width / 10
    bend = cost(level + step) + cost(level - step) - 2 * cost(level)
    error = step / math.sqrt(bend) if bend > 0 else width
    return level, error, _gain(parts[1], level)


def _bright(points: Sequence[Point], are_blended: bool) -> tuple[Array, ...]:
    """Return (signals, expected light, variance by photons, by the read-out, whether at
    white, the least light that is blended into them, the highest full well that shows)
    of samples that are expected bright, (n,) each."""
    parts: list[list[Array]] = [[] for _ in range(6)]
    for point in points:
        p = point.prediction
        offset = p.mean - p.exposed
        least = p.exposed
        if are_blended:
            least = minimum_filter(least, footprint=OF_ONE_COLOR[None], mode="nearest")
        for frame in point.view.frames:
            used = frame.keep & ~frame.at_zero & (p.exposed > BRIGHT_ENOUGH)
            rest = np.maximum(p.variance - p.photon_variance, LEAST_VARIANCE)
            each = (
                frame.signal - offset,
                p.exposed,
                p.photon_variance,
                rest,
                frame.at_white,
                least,
            )
            for part, one in zip(parts, each, strict=True):
                part.append(np.broadcast_to(one, used.shape)[used])
    y, x, s2, rest, at_white, least = (
        np.concatenate([np.zeros(0), *part]) for part in parts
    )
    highest = np.maximum(x, (x * rest + y * s2) / (s2 + rest)) + NEAR * np.sqrt(s2)
    return y, x, s2, rest, at_white, least, np.where(at_white > 0, np.inf, highest)


def _gain(samples: tuple[Array, ...], level: float) -> float:
    """Return nats that samples gain by a full well at a level."""
    *measured, least, highest = samples
    shown = (highest > level) & ((least > level) | (measured[1] <= level))
    y, x, s2, rest, at_white = (one[shown] for one in measured)
    both = s2 + rest
    plain = -0.5 * (y - x) ** 2 / both - 0.5 * np.log(both)
    split = np.sqrt(s2 * rest / both)
    is_open = plain + log_ndtr((level - (x * rest + y * s2) / both) / split)
    chance = log_ndtr((x - level) / np.sqrt(s2))
    shut = chance - 0.5 * (y - level) ** 2 / rest - 0.5 * np.log(rest)
    cut = np.logaddexp(is_open, shut)
    white = at_white > 0
    plain[white] = log_ndtr((x - 1) / np.sqrt(both))[white]
    cut[white] = (chance + log_ndtr((level - 1) / np.sqrt(rest)))[white]
    scale = -0.5 * np.log(both)  # density at its top, of what is not cut
    broken = np.where(white, LEAST_LOG, scale + LEAST_LOG)
    return float((np.maximum(cut, broken) - np.maximum(plain, broken)).sum())


def photons(points: Sequence[Point], left: Sequence[Array]) -> float:
    """Return nats that frames gain if their light is counted, by Poisson's law.

    What pixels have of their own is skewed as well, by a law that is known to its size:
    which of it the frames have is estimated, whether light is counted or not.
    left : (T, h, w), residuals of mean images without what nuisances take."""
    gained = 0.0
    by_law: dict[float, list[tuple[Point, Array]]] = {}
    for point, mean in zip(points, left, strict=True):
        law = point.prediction.pattern_third_cumulant
        by_law.setdefault(law, []).append((point, mean))
    for law, some in by_law.items():
        counted, normal = _own_skews(some, law) if law else (0.0, 0.0)
        if law:
            gained += ((normal / law - 1) ** 2 - (counted / law - 1) ** 2) / 2
        for z, near, p in _deviations(some):
            white, slope = EFFECT.whitened(z, p, True, counted)
            plain, other = EFFECT.whitened(z, p, False, normal)
            nats = slope - other - 0.5 * (white**2 - plain**2)
            gained += float(nats[near].sum())
    return gained


def _own_skews(some: Sequence[tuple[Point, Array]], law: float) -> tuple[float, float]:
    """Return the likeliest third cumulants of what pixels have of their own, if light
    is counted, and if not. law : of the law, from which it may be off by as much; the
    likelihood is that of small skewness, to its square."""
    of_all = of_light = squares = 0.0
    for z, near, p in _deviations(some):
        each = (p.variance**-1.5)[near]
        of_all += float(each @ (z**3 - 3 * z)[near])
        of_light += float(each @ (each * EFFECT.third_cumulant(p)[near]))
        squares += float(each @ each)
    known = squares / 6 + law**-2
    return (
        ((of_all - of_light) / 6 + 1 / law) / known,
        (of_all / 6 + 1 / law) / known,
    )


def _deviations(
    some: Sequence[tuple[Point, Array]],
) -> Iterator[tuple[Array, NDArray[np.bool_], Prediction]]:
    """Yield, of each frame, how far its samples are off in standard deviations, which
    of them count, and what is predicted."""
    for point, mean in some:
        p, used = point.prediction, point.root > 0
        spread = np.sqrt(p.variance)
        for frame in point.view.frames:
            z = (frame.signal - point.view.signal + mean) / spread
            yield z, used & (np.abs(z) < TAIL), p
