# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What frames say of maps of the sensor, pixel by pixel."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.jumps import predict_for_means
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import photon_gain
from cg2raw.diagnose.likelihood.tails import tails_in
from cg2raw.diagnose.likelihood.whitening import row_variance

LEAST_KNOWN = 1e-6  # of the best pixel's information; a pixel with less is not known
LEAST_INFORMATION = 1e-200
LEAST_TOLD_AROUND = 1e-100  # of information, so that its square is a number
# Of the squared slopes of frames of light: what darks need to have.
ENOUGH_OF_DARKS = 0.2


@dataclass(frozen=True)
class Evidence:
    """Of K maps: information (K, K, T, h, w) and score (K, T, h, w), information times
    estimates. A row is what the frames that tell one map say of it, and how much of
    the others they show: maps that darks tell have none of flats in theirs.

    repeat : side of the CFA's, px.
    noisier : (K, K, T, h, w), what a value of the log-normal map, if there is one, adds
        to the covariance of the scores by the shot noise of its charge.
    of_charge : the same that charge adds where that value is 0.
    of_rows : the same that offsets of the frames' rows add, where it is not 0.
    unseen : (T, h, w), pixels that no frame was given."""

    information: Array
    score: Array
    repeat: int
    noisier: Array | float
    of_charge: Array | float
    of_rows: Array | float
    unseen: Mask

    def shared(self, one: int) -> Array:
        """Return (K, T, h, w) covariances of the score of one map with those of all, by
        the frames that tell both. Sensitivities are positive: more frames say more."""
        both: Array = np.minimum(self.information[one], self.information[:, one])
        return both

    def beside_offsets(self, variance: float) -> "Evidence":
        """Return what is said of a map beside pixels' own offsets of a variance."""
        share = 1 / (1 + variance * self.information[0, 0])
        return replace(
            self, information=self.information * share, score=self.score * share
        )

    def known(self, one: int) -> Mask:
        """Return the pixels that any frame says anything about."""
        own = self.information[one, one]
        found: Mask = own > max(LEAST_KNOWN * own.max(), LEAST_INFORMATION)
        return found


def evidence_of(
    effects: Sequence[FixedPattern],
    rest: Model,
    likelihood: Likelihood,
    known: Sequence[SensorMap | None] | None = None,
) -> Evidence:
    """Return what frames of one shape say of the maps of some effects.

    Of offsets and rates darks say so much more than flats that these would add but what
    is wrong with their light. rest : the model without them. known : the maps as far as
    they are, of the frames' tiles, beside which tails of the noise are seen, and, of
    spots, how full wells are."""
    known = known or [None] * len(effects)
    by_darks = [told_by_darks(effect, likelihood.frames) for effect in effects]
    charge = next((k for k, effect in enumerate(effects) if effect.is_log_normal), None)
    near, spots = _with_spots(rest, effects, known)

    def of_frame(frame: Frame) -> tuple[Array, ...]:
        p = predict_for_means(near, frame)
        given = [effect.shown(frame, p) for effect in effects]
        p = _beside_tails(p, rest, frame, effects, known)
        z, _, weight = scores(p, frame)
        told_by = frame.keep & ~frame.at_white
        if p.well is not None and effects[0].layout == "pixels":
            told_by &= p.well.surely_below
        weight = np.where(told_by, weight, 0)
        spread = np.sqrt(p.variance)
        slopes = np.array([sensitivity * weight / spread for sensitivity in given])
        if spots is not None:
            z = z + slopes[0] * spots
        lit = frame.capture.shows.light
        told = slopes * ~np.array(by_darks)[:, None, None, None] if lit else slopes
        products = told[:, None] * slopes[None]
        if charge is None:
            return products, told * z
        squares = told[:, None] * told / p.variance
        more = (
            given[charge] * photon_gain(rest, frame),
            p.photon_variance,
            row_variance(rest, frame),
        )
        return products, told * z, *(squares * variance for variance in more)

    information, score, *more = (
        sum(parts) for parts in zip(*likelihood.each(of_frame), strict=True)
    )
    noisier, of_charge, of_rows = more or (0.0, 0.0, 0.0)
    repeat, unseen = repeat_of(rest.sensor.cfa), unseen_by(likelihood.frames)
    return Evidence(information, score, repeat, noisier, of_charge, of_rows, unseen)


def _with_spots(
    rest: Model, effects: Sequence[FixedPattern], known: Sequence[SensorMap | None]
) -> tuple[Model, Array | None]:
    """Return (the model with the spots that are known, their map; None if there are
    none): wells that are full beside a spot may not be full in it."""
    effect, spots = effects[0], known[0]
    if effect.layout != "spots" or spots is None:
        return rest, None
    sure = SensorMap(spots.mean, np.zeros_like(spots.mean))
    term = Term(effect, np.zeros(1), sure)
    return rest.with_term(term), spots.mean


def unseen_by(frames: Sequence[Frame]) -> Mask:
    """Return the pixels that no frame was given: not those that were set aside."""
    given = [frame.keep if frame.given is None else frame.given for frame in frames]
    unseen: Mask = ~np.logical_or.reduce(given)
    return unseen


def _beside_tails(
    p: Prediction,
    rest: Model,
    frame: Frame,
    effects: Sequence[FixedPattern],
    known: Sequence[SensorMap | None],
) -> Prediction:
    """Return a prediction whose noise has no tails: pixels that are likely of them
    have their variance. effects : of the maps that are known, or None."""
    tails = tails_in(rest, frame, p)
    if tails is None:
        return p
    left = frame.signal - p.mean
    charge: Array | float = 0.0
    for effect, one in zip(effects, known, strict=True):
        if one is not None:
            signal = effect.shown(frame, p) * one.mean
            left, charge = left - signal, charge + effect.is_charge * signal
    more = np.maximum(photon_gain(rest, frame) * charge, -p.photon_variance)
    return replace(p, variance=tails.variance_of(left, more))


def mean_around(score: Array, information: Array, width: float) -> tuple[Array, Array]:
    """Return (estimates of the mean around each pixel, what they go by).

    score, information : (T, h, w). width : standard deviation, px."""
    around = (0, width, width)
    told = gaussian_filter(information, around, mode="constant")
    told = np.maximum(told, LEAST_TOLD_AROUND)
    return gaussian_filter(score, around, mode="constant") / told, told


def told_by_darks(effect: FixedPattern, frames: Sequence[Frame]) -> bool:
    """Return whether darks show an effect that is none of light nearly as well as
    frames of light, which are noisier."""
    if "light" in effect.needs:
        return False
    told = {True: 0.0, False: 0.0}
    for frame in frames:
        slope = float(effect.sensitivity(frame, np.zeros(())))
        told[frame.capture.shows.light] += slope**2
    return told[False] > ENOUGH_OF_DARKS * told[True]
