# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What frames say of maps of the sensor, pixel by pixel."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import photon_gain, predict_with_jumps

LEAST_KNOWN = 1e-6  # of the best pixel's information; a pixel with less is not known
LEAST_INFORMATION = 1e-200


@dataclass(frozen=True)
class Evidence:
    """Of K maps: information (K, K, T, h, w), whose inverse is the covariance of their
    estimates, and score (K, T, h, w), information times estimates.

    repeat : side of the CFA's, px.
    noisier : (K, T, h, w), what a value of each map adds, by the shot noise of its
        charge, to the variance of its estimate, times the square of the information."""

    information: Array
    score: Array
    repeat: int
    noisier: Array

    def known(self, one: int) -> Mask:
        """Return the pixels that any frame says anything about."""
        own = self.information[one, one]
        found: Mask = own > max(LEAST_KNOWN * own.max(), LEAST_INFORMATION)
        return found


def evidence_of(
    effects: Sequence[FixedPattern], rest: Model, likelihood: Likelihood
) -> Evidence:
    """Return what frames of one shape say of the maps of some effects.

    rest : the model without them."""
    count = len(effects)

    def of_frame(frame: Frame) -> tuple[Array, Array, Array]:
        p = predict_with_jumps(rest, frame)
        photons = np.maximum(p.exposed, 0)
        z, _, weight = scores(p, frame)
        weight = np.where(frame.keep & ~frame.at_white, weight, 0)
        spread = np.sqrt(p.variance)
        given = [e.sensitivity(frame, photons) for e in effects]
        slopes = [sensitivity * weight / spread for sensitivity in given]
        products = [slopes[k] * slopes[i] for k, i in _upper(count)]
        of_charge = photon_gain(rest, frame) / p.variance
        noisier = [
            slope**2 * sensitivity * of_charge * effect.is_charge
            for slope, sensitivity, effect in zip(slopes, given, effects, strict=True)
        ]
        scored = [slope * z for slope in slopes]
        return np.array(products), np.array(scored), np.array(noisier)

    shape = likelihood.frames[0].signal.shape
    information, score = np.zeros((count, count, *shape)), np.zeros((count, *shape))
    noisier = np.zeros_like(score)
    for products, scored, more in likelihood.each(of_frame):
        for (k, i), product in zip(_upper(count), products, strict=True):
            information[k, i] += product
        score += scored
        noisier += more
    for k, i in _upper(count):
        information[i, k] = information[k, i]
    return Evidence(information, score, repeat_of(rest.sensor.cfa), noisier)


def _upper(count: int) -> list[tuple[int, int]]:
    return [(k, i) for k in range(count) for i in range(k, count)]
