# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Likelihood: log density of frames under a model, nats, with density in DN."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TypeVar

import numpy as np
from scipy.special import log_ndtr

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.censored_offsets import (
    CensoredOffsets,
    censored_offsets,
)
from cg2raw.diagnose.likelihood.censoring import LOG_2PI, first_censored, residuals
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from cg2raw.diagnose.likelihood.whitening import cut_offsets, whiten
from cg2raw.diagnose.likelihood.workers import Workers

LEAST_LOG = -200.0  # of a censored pixel, so that one cannot outweigh all
RESIDUALS = "residuals"  # in the memo of a prediction
BLOCK = 16  # pixels; sums over such squares are taken as independent

Result = TypeVar("Result")


class Likelihood:
    """The likelihood of models on frames, which threads share."""

    def __init__(self, frames: Sequence[Frame], workers: Workers) -> None:
        self.frames = tuple(frames)
        self.workers = workers

    @cached_property
    def pixels(self) -> int:
        """How many pixels count."""
        return sum(int(frame.counted.sum()) for frame in self.frames)

    def each(self, work: Callable[[Frame], Result]) -> list[Result]:
        """Return what a function returns of every frame, in order."""
        return self.workers.map(work, self.frames)

    def of(self, frames: Sequence[Frame]) -> "Likelihood":
        """Return that of other frames."""
        return Likelihood(frames, self.workers)

    def predictions(self, model: Model) -> list[Prediction]:
        return self.each(lambda frame: predict(model, frame))

    def predicted(self, model: Model) -> list[tuple[Frame, Prediction]]:
        """Return the frames with what a model predicts of them."""
        return list(zip(self.frames, self.predictions(model), strict=True))

    def total(self, model: Model, known: Sequence[Prediction] | None = None) -> float:
        """Return the log-likelihood of all frames, nats. known : their predictions."""

        def of_frame(pair: tuple[Frame, Prediction | None]) -> float:
            frame, prediction = pair
            return float(_density(model, frame, prediction)[0][frame.counted].sum())

        predictions = [None] * len(self.frames) if known is None else known
        pairs = list(zip(self.frames, predictions, strict=True))
        return sum(self.workers.map(of_frame, pairs))

    def in_blocks(self, model: Model) -> Array:
        """Return the log-likelihood in sums over squares of BLOCK pixels."""

        def sums(frame: Frame) -> Array:
            return block_sums(np.where(frame.counted, _density(model, frame)[0], 0))

        return np.concatenate(self.each(sums))


def log_density(
    model: Model, frame: Frame, prediction: Prediction | None = None
) -> tuple[Array, Array, Prediction]:
    """Return (log density per pixel, final residuals, prediction with the offsets that
    the ADC cuts)."""
    density, z, p, cut = _density(model, frame, prediction)
    if cut is not None:
        z = whiten(residuals(cut.drawn, frame), cut.drawn, model, frame)[0]
    return density, z, p


def _density(
    model: Model, frame: Frame, prediction: Prediction | None = None
) -> tuple[Array, Array, Prediction, CensoredOffsets | None]:
    """Return (log density per pixel, what it is made of: residuals and prediction,
    offsets that the ADC cuts)."""
    p = predict(model, frame) if prediction is None else prediction
    shared, cut = cut_offsets(model, frame), None
    if shared is not None:
        cut = censored_offsets(p, shared, frame)
    p = p if cut is None else cut.likeliest
    if RESIDUALS not in p.memo:
        p.memo[RESIDUALS] = residuals(p, frame)
    z, cost = whiten(p.memo[RESIDUALS], p, model, frame)
    density = -0.5 * z * z - 0.5 * LOG_2PI + cost - 0.5 * np.log(p.variance)
    density = density - np.log(frame.range)
    for hit, sign in ((frame.at_white, 1.0), (frame.at_zero, -1.0)):
        if hit.any():
            end = first_censored(frame, hit, sign, p) / np.sqrt(p.variance[hit])
            beyond = log_ndtr(-end)
            density[hit] = np.maximum(beyond, LEAST_LOG)
    return density if cut is None else density + cut.log_density, z, p, cut


def block_sums(image: Array) -> Array:
    """Return sums over squares of BLOCK pixels of an image (T, h, w)."""
    count, height, width = image.shape
    rows, columns = -(-height // BLOCK), -(-width // BLOCK)
    padded = np.zeros((count, rows * BLOCK, columns * BLOCK))
    padded[:, :height, :width] = image
    shape = (count, rows, BLOCK, columns, BLOCK)
    return np.asarray(padded.reshape(shape).sum((2, 4)).ravel())
