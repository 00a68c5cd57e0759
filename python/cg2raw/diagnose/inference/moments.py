# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Moments of darks and flats: noise and pedestal without a model of anything else.

In the difference of two frames that repeat each other every fixed pattern cancels, and
what is left is temporal noise. Source: EMVA Standard 1288, release 4.0, sections 6.6
and 6.7.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.stats import norm

from cg2raw.diagnose.effects.base import Moments
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.repeats import repeats
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

CLIPPED_AT = 4.0  # standard deviations
CLIPPINGS = 4  # until the deviation stays
# Of a normal's variance, what is left of it within that.
LEFT_INSIDE = 1 - 2 * CLIPPED_AT * norm.pdf(CLIPPED_AT) / (1 - 2 * norm.sf(CLIPPED_AT))
ALIKE = 0.2  # relative difference of two flats' levels
FEWEST = 200  # pixels of a pair


@dataclass(frozen=True)
class _Pair:
    """Of one CFA site of two frames: variance that the noise model says, by light and
    of the read noise, and what was measured. dark : no light fell on them."""

    dark: bool
    light: float
    read: float
    measured: float


def clipped_variance(values: Array) -> float:
    """Return the variance of (n,) values without what lies far out.

    The median deviation, from which it starts, is coarse where values are whole DN."""
    centred = values - np.median(values)
    deviation = 1.4826 * float(np.median(np.abs(centred))) or float(centred.std())
    for _ in range(CLIPPINGS):
        inside = np.abs(centred) < CLIPPED_AT * deviation
        deviation = float(np.sqrt((centred[inside] ** 2).mean() / LEFT_INSIDE))
    return deviation**2


def moments_of(model: Model, likelihood: Likelihood) -> Moments:
    """Return what uniform frames say beside a model."""
    means = [p.mean for p in likelihood.predictions(model)]
    offset, rate = _pedestal(likelihood.frames, means)
    light, read = _noise(likelihood.frames, max(rate, 0.0))
    return Moments(light, read, offset, rate)


def _noise(frames: Sequence[Frame], rate: float) -> tuple[float | None, float | None]:
    """Return (light, read): measured over predicted variance of each.

    rate : of charge in the dark, per second, which has shot noise."""
    pairs = [
        pair
        for members in repeats(frames)
        for both in zip(members, members[1:], strict=False)
        for pair in _of_sites(*both, rate)
    ]
    dark = [pair for pair in pairs if pair.dark]
    if not dark:
        return None, None
    measured = np.array([pair.measured for pair in pairs])
    design = np.array([(pair.light, pair.read) for pair in pairs]) / measured[:, None]
    if len(dark) == len(pairs):
        # Little charge says nothing of its noise, which is taken as predicted.
        left = [pair.measured - pair.light for pair in pairs]
        return None, max(float(np.median(left / design[:, 1] / measured)), 0.0) or None
    light, read = nnls(design, np.ones(len(pairs)))[0]
    return float(light) or None, float(read) or None


def _of_sites(first: Frame, second: Frame, rate: float) -> Iterator[_Pair]:
    dark = not first.capture.shows.light
    used = first.keep & second.keep & ~first.censored & ~second.censored
    for site in range(int(first.site.max()) + 1):
        here = used & (first.site == site)
        if here.sum() < FEWEST:
            continue
        a, b = first.signal[here], second.signal[here]
        beta1, beta2, rounding = (
            float(plane[first.site == site].mean())
            for plane in (first.beta1, first.beta2, first.rounding / first.range**2)
        )
        level = rate * first.seconds
        if not dark:
            levels = float(np.median(a)), float(np.median(b))
            level = float(np.sqrt(max(levels[0] * levels[1], 0)))
            if not abs(levels[0] - levels[1]) < ALIKE * level:
                continue
            a, b = a * level / levels[0], b * level / levels[1]
        measured = clipped_variance(a - b) / 2 - rounding
        if measured > 0:
            yield _Pair(dark, beta1 * level, beta2, measured)


def _pedestal(frames: Sequence[Frame], means: Sequence[Array]) -> tuple[float, float]:
    """Return (offset, rate per second) of what darks have above their predictions.

    Medians, which few hot pixels do not move. The rate is 0 without two exposure
    times."""
    darks = [
        (frame, mean)
        for frame, mean in zip(frames, means, strict=True)
        if not (frame.capture.shows.light or frame.is_cut)
    ]
    if not darks:
        return 0.0, 0.0
    level = np.array([np.median((f.signal - mean)[f.keep]) for f, mean in darks])
    seconds = np.array([frame.seconds for frame, _ in darks])
    known = all(frame.capture.exposure_time is not None for frame, _ in darks)
    if not known or np.ptp(seconds) <= 0:
        return float(np.median(level)), 0.0
    return _line(seconds, level)


def _line(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Return (offset, slope): the median of all slopes, then of what is left.

    Source: P. K. Sen, J. Am. Stat. Assoc. 63(324), 1968."""
    first, second = np.triu_indices(len(x), 1)
    apart = x[second] != x[first]
    rise, run = (y[second] - y[first])[apart], (x[second] - x[first])[apart]
    # Long ways tell more, and count so often.
    order = np.argsort(rise / run)
    weight = np.cumsum(np.abs(run)[order])
    slope = float((rise / run)[order][np.searchsorted(weight, weight[-1] / 2)])
    return float(np.median(y - slope * x)), slope
