# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Read noise correlation: the read noise of neighbours in a row correlates."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Gain,
    Parameter,
    Predicted,
    Values,
    Whitened,
    Whitener,
    WhiteningStage,
)
from cg2raw.diagnose.effects.families import SPREAD
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

LEAST_OF_READ_NOISE = (
    0.25  # of read noise in a pixel's variance, for it to tell of others
)
SOFTENED = (
    "Darks, and flats from dim to bright: read noise correlates with the next pixel of "
    "the row in darks, and ever less in brighter flats; what a lens or a filter of the "
    "file softens stays as soft in flats, and does not know rows."
)


class ReadNoiseCorrelation(Effect):
    name = "read_noise_correlation"
    title = "read noise correlation"
    where = "neighbours in a row share read noise, most of all in darks"
    estimator = "transform"
    search = (Parameter("coefficient", -0.5, 0.5),)
    step = 5e-3
    starts = ((-0.2,), (-0.05,), (-0.015,), (0.015,), (0.05,), (0.2,))
    first_scale = 0.005
    families = frozenset({SPREAD})
    signature = frozenset({"noise"})
    moves_mean = False
    whitening = WhiteningStage.AMPLIFIER
    linear = True
    told_apart = {"noise_reduction": SOFTENED, "blur": SOFTENED, "crosstalk": SOFTENED}

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """Take out of each pixel what the one before it in the row tells of it.

        The correlation of the two is that of their read noise times the shares of it in
        their deviations; what pixels farther away would tell besides is of the order of
        its square times the share of other noise. Brighter pixels tell little of it,
        and any error of their mean would pass for it."""
        return self.whitener(p, values, frame, read)(z)

    def whitener(
        self, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitener:
        of_read = np.minimum(read / p.variance, 1)
        used = frame.keep & ~frame.censored & (of_read > LEAST_OF_READ_NOISE)
        share = np.sqrt(of_read) * used
        told = values[0] * share[..., 1:] * share[..., :-1]
        left = 1 - told**2
        root = np.sqrt(left)
        cost = np.zeros_like(share)
        cost[..., 1:] = -0.5 * np.log(left)

        def whiten(z: Array) -> Whitened:
            white = np.empty_like(z)
            white[..., 0] = z[..., 0]
            white[..., 1:] = (z[..., 1:] - told * z[..., :-1]) / root
            return white, cost

        return whiten

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        told = [
            (np.minimum(frame.beta2 / p.variance, 1)[frame.keep]) ** 2
            for frame, p in selected
        ]
        counts, edges = np.histogram(
            np.concatenate(told), 50, (LEAST_OF_READ_NOISE**2, 1)
        )
        middles = (edges[1:] + edges[:-1]) / 2

        def gain(coefficient: float) -> float:
            return float(-0.5 * counts @ np.log1p(-(coefficient**2) * middles))

        return gain

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        return listed_values(sensor, self.name)

    def size(self, values: Estimates) -> str:
        one = values["coefficient"]
        low, high = one.ci95
        return (
            f"correlation {one.value:.3g} ({low:.3g} to {high:.3g}) with the next "
            "pixel of the row"
        )


EFFECT = ReadNoiseCorrelation()
