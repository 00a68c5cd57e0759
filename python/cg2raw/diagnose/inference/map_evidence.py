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
from cg2raw.diagnose.likelihood.prediction import predict

LEAST_KNOWN = 1e-6  # of the best pixel's information; a pixel with less is not known
LEAST_INFORMATION = 1e-200


@dataclass(frozen=True)
class Evidence:
    """Of K maps: information (K, K, T, h, w), whose inverse is the covariance of their
    estimates, and score (K, T, h, w), information times estimates.

    repeat : side of the CFA's, px."""

    information: Array
    score: Array
    repeat: int

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

    def of_frame(frame: Frame) -> tuple[Array, Array]:
        p = predict(rest, frame)
        photons = np.maximum(p.exposed, 0)
        z, _, weight = scores(p, frame)
        weight = np.where(frame.keep & ~frame.at_white, weight, 0)
        spread = np.sqrt(p.variance)
        slopes = [e.sensitivity(frame, photons) * weight / spread for e in effects]
        products = [slopes[k] * slopes[i] for k, i in _upper(count)]
        return np.array(products), np.array([slope * z for slope in slopes])

    shape = likelihood.frames[0].signal.shape
    information, score = np.zeros((count, count, *shape)), np.zeros((count, *shape))
    for products, scored in likelihood.each(of_frame):
        for (k, i), product in zip(_upper(count), products, strict=True):
            information[k, i] += product
        score += scored
    for k, i in _upper(count):
        information[i, k] = information[k, i]
    return Evidence(information, score, repeat_of(rest.sensor.cfa))


def _upper(count: int) -> list[tuple[int, int]]:
    return [(k, i) for k in range(count) for i in range(k, count)]
