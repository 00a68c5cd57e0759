# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Full well: charge clips below white."""

import numpy as np
from scipy.special import log_ndtr, ndtr, ndtri, owens_t

from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Gain,
    Predicted,
    Values,
    Whitened,
    WhiteningStage,
)
from cg2raw.diagnose.effects.families import LIGHT, RESPONSE
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.frames.well import Well

LEAST_TAIL = 1e-15
LEAST_READ = 0.2  # of the read noise's variance, that a full pixel has
LEAST_PILE = 2  # pixels at one level that may be a well's
BRIGHT = 0.2  # of white, from which on pixels may be clipped


class FullWell(Effect):
    name = "full_well"
    title = "full well below white"
    where = "levels pile up below white"
    bounds = {"below_white": (-0.7, 0.7)}  # on top of what a profile has
    families = frozenset({RESPONSE})
    signature = frozenset({"gain"})
    needs = LIGHT
    from_means = True
    whitening = WhiteningStage.CLIPPING
    starts_from_data = True

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """The exact density of min(photons, well) + read noise near the well, and the
        normal score of what was measured. Of a full pixel all noise is read noise: its
        tails are here."""
        extra = np.zeros_like(z)
        if values[0] <= 0:
            return z, extra
        full = p.well
        charge, shown = (p.exposed, 0.0) if full is None else (full.charge, full.light)
        light = np.broadcast_to(p.light_variance, z.shape)
        near = Well(1 - values[0], charge, p.photon_variance).is_near(
            p.photon_variance + light
        )
        if not near.any():
            return z, extra
        read, light = np.broadcast_to(read, z.shape)[near], light[near]
        well = Well(1 - values[0], charge[near], p.photon_variance[near] + 1e-14)
        lost, less_varied = well.cut
        known = p.variance[near] - light
        rest = np.maximum(known - (well.variance - less_varied), LEAST_READ * read)
        spread = np.sqrt(p.variance[near])
        # Light that whitening has yet to take out.
        shared = np.broadcast_to(shown, z.shape)[near] / spread
        y = (z[near] - shared) * spread + well.charge - lost  # before offsets
        # Light that nobody measured is clipped too.
        well = Well(well.level, well.charge, well.variance + light)
        density, below, above = _with_tails(y, well, rest, p.tails)
        tail = ndtri(np.maximum(np.minimum(below, above), LEAST_TAIL))
        white = z.copy()
        score = np.where(below < above, tail, -tail)
        white[near] = score + shared
        extra[near] = density + 0.5 * score**2 + np.log(spread)
        return white, extra

    def first_values(self, predicted: Predicted) -> Values | None:
        """Return where bright pixels pile up; None if none lie far below what is
        predicted of them."""
        values = np.concatenate([_low_pixels(frame, p) for frame, p in predicted])
        if not values.size:
            return None
        widest = max(frame.beta2.mean() for frame, _ in predicted)
        width = max(4 * np.sqrt(widest), 2e-4)
        bins = (values / width).astype(int)
        pile = values[bins == np.argmax(np.bincount(bins))]
        if pile.size < LEAST_PILE:
            return None
        return np.array([max(1 - float(np.median(pile)), 1e-3)])

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        """A bright pixel stands at the well in place of where it was expected."""
        bright = [
            (p.mean[used], p.variance[used])
            for frame, p in selected
            for used in [frame.keep & ~frame.at_white & (p.mean > BRIGHT)]
        ]

        def gain(below_white: float) -> float:
            return sum(
                float((np.maximum(x - (1 - below_white), 0) ** 2 / v).sum()) / 2
                for x, v in bright
            )

        return gain

    def size(self, values: Estimates) -> str:
        return f"charge clips {percent(value_of(values, 'below_white'))} below white"


def _low_pixels(frame: Frame, p: Prediction) -> Array:
    """Return the signals of pixels far below what is predicted of them."""
    low = p.mean - frame.signal > 6 * np.sqrt(p.variance - p.light_variance)
    used = frame.counted & ~frame.censored & low & (frame.signal > 0.25)
    return np.asarray(frame.signal[used])


def _with_tails(
    y: Array, well: Well, rest: Array, tails: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Return (log densities, chances of less, of more) of signals y (n,) of a well.

    rest : variance of the read-out. tails : share of it that is wider than the others,
        ratio of their variances."""
    share, ratio = tails
    if share <= 0 or ratio <= 1:
        return _clipped(y, well, rest)
    core = rest / (1 + share * (ratio - 1))
    narrow = _clipped(y, well, core)
    wide = _clipped(y, well, ratio * core)
    below, above = (
        (1 - share) * a + share * b for a, b in zip(narrow[1:], wide[1:], strict=True)
    )
    density = np.logaddexp(np.log1p(-share) + narrow[0], np.log(share) + wide[0])
    return density, below, above


def _clipped(y: Array, well: Well, rest: Array) -> tuple[Array, Array, Array]:
    """Return the same, if the read-out is normal; densities are but for a factor."""
    x, s2, level = well.charge, well.variance, well.level
    both = s2 + rest
    sd, a = np.sqrt(s2), (level - x) / np.sqrt(s2)
    open_ = -0.5 * (y - x) ** 2 / both - 0.5 * np.log(both)
    split = np.sqrt(s2 * rest / both)
    open_ += log_ndtr((level - (x * rest + y * s2) / both) / split)
    over = (y - level) / np.sqrt(rest)
    shut = log_ndtr(-a) - 0.5 * over**2 - 0.5 * np.log(rest)
    below = _both_below(a, (y - x) / np.sqrt(both), sd / np.sqrt(both))
    above = np.maximum(ndtr(a) - below, 0) + ndtr(-a) * ndtr(-over)
    below = below + ndtr(-a) * ndtr(over)
    return np.logaddexp(open_, shut), below, above


def _both_below(h: Array, k: Array, correlation: Array) -> Array:
    """Return the chance that two standard normal numbers lie below h and k.

    Source: D. B. Owen, Ann. Math. Stat. 27(4), 1956."""
    h, k = (np.where(np.abs(v) < 1e-9, 1e-9, v) for v in (h, k))
    root = np.sqrt(1 - correlation**2)
    unlike = np.where(h * k < 0, 0.5, 0.0)
    of_h = owens_t(h, (k / h - correlation) / root)
    of_k = owens_t(k, (h / k - correlation) / root)
    return np.asarray(0.5 * (ndtr(h) + ndtr(k)) - of_h - of_k - unlike)


EFFECT = FullWell()
