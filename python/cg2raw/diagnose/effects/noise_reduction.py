# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Noise reduction: the camera blended a pixel with its neighbours."""

import numpy as np
from scipy import fft

from cg2raw.diagnose.effects.base import (
    Effect,
    Gain,
    Parameter,
    Predicted,
    Values,
    Whitened,
    Whitener,
    WhiteningStage,
)
from cg2raw.diagnose.effects.families import SPREAD
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array

LEAST_BLEND = np.array([0.0, -0.1])
# Share of the noise that is rounding, of which no frequency has less.
LEAST_POWER, MOST_ROUNDED = 1e-4, 0.9


class NoiseReduction(Effect):
    """It blurs the mean, too, and goes where noise goes all the same."""

    name = "noise_reduction"
    title = "in-camera noise reduction"
    where = "neighbours of one colour share their noise"
    estimator = "transform"
    # On top of what a profile has, which may be too much.
    search = (Parameter("blend", -0.9, 0.9), Parameter("diagonal", -0.4, 0.4))
    step = 5e-3
    starts = (
        *((0.004, 0), (0.02, 0), (0.05, 0), (0.2, 0), (0.4, 0.05)),
        *((-0.01, 0), (-0.05, 0), (-0.15, 0)),
    )
    first_scale = 0.004
    families = frozenset({SPREAD})
    signature = frozenset({"softener"})
    moves_mean = False
    bayer_only = True
    whitening = WhiteningStage.FILTER
    linear = True

    @property
    def predicted(self) -> bool:
        return True

    def within_registry_bounds(self, values: Values) -> Values:
        """Return values of a filter that blends: one that sharpens is none of these."""
        bounded = super().within_registry_bounds(values)
        return np.asarray(np.maximum(bounded, LEAST_BLEND))

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """Divide by the filter that a camera blended its noise with, in frequency."""
        return self.whitener(p, values, frame, read)(z)

    def whitener(
        self, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitener:
        if not np.any(values):
            return lambda z: (z, 0.0)
        height, width = p.variance.shape[-2:]
        power = _response(height, width, values) ** 2 / self.variance_left(values)
        rounded = _rounding(p, frame)
        power = (1 - rounded) * power + rounded
        log_sum = 2 * np.log(power).sum() - np.log(power[:, 0]).sum()
        if width % 2 == 0:
            log_sum -= np.log(power[:, -1]).sum()
        cost = -0.5 * log_sum / (height * width)
        root = np.sqrt(power)

        def whiten(z: Array) -> Whitened:
            return fft.irfft2(fft.rfft2(z) / root, (height, width)), cost

        return whiten

    def blended(self, image: Array, values: Values) -> Array:
        height, width = image.shape[-2:]
        response = _response(height, width, values)
        return np.asarray(fft.irfft2(fft.rfft2(image) * response, (height, width)))

    def variance_left(self, values: Values) -> float:
        blend, diagonal = values
        own = (1 - blend - diagonal) ** 2
        return float(own + blend**2 / 4 + diagonal**2 / 4)

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        """Of how noise is shared, and of mean and variance."""
        pixels = sum(int(frame.keep.sum()) for frame, _ in selected)
        waves = np.cos(2 * np.pi * np.arange(64) / 64)

        def gain(blend: float) -> float:
            response = 1 - blend + blend / 2 * (waves[:, None] + waves)
            power = response**2 / ((1 - blend) ** 2 + blend**2 / 4)
            shared = -0.5 * pixels * float(np.log(power + LEAST_POWER).mean())
            return shared + 0.5 * information * blend**2

        return gain


def _rounding(p: Prediction, frame: Frame) -> float:
    """Return the share of most pixels' variance that whole DN have: they are rounded
    after the filter, to white noise."""
    share = frame.rounding / (np.median(frame.range) ** 2 * np.median(p.variance))
    return float(np.clip(share, LEAST_POWER, MOST_ROUNDED))


def _response(height: int, width: int, values: Values) -> Array:
    """Return the filter, which has no phase, at the frequencies of a real image."""
    blend, diagonal = values
    cy = np.cos(4 * np.pi * np.fft.fftfreq(height))[:, None]
    cx = np.cos(4 * np.pi * np.fft.rfftfreq(width))[None]
    centre = 1 - blend - diagonal
    return np.asarray(centre + blend / 2 * (cy + cx) + diagonal * cy * cx)


EFFECT = NoiseReduction()
