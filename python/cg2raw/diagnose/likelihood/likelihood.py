# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Likelihood: log density of frames under a model, nats, with density in DN."""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np
from scipy.special import log_ndtr

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.censored_rows import CutRows, cut_rows
from cg2raw.diagnose.likelihood.censoring import LOG_2PI, first_censored, residuals
from cg2raw.diagnose.likelihood.prediction import (
    Model,
    Prediction,
    flow_values,
    predict,
)
from cg2raw.diagnose.likelihood.whitening import whiten

LEAST_LOG = -200.0  # of a censored pixel, so that one cannot outweigh all
BLOCK = 16  # pixels; sums over such squares are taken as independent

Item = TypeVar("Item")
Result = TypeVar("Result")


class TimeIsUp(Exception):
    """The time that was given to a search has passed."""


class Workers:
    """Threads that work on frames; numpy and the registry let go of the interpreter.

    deadline : of time.monotonic(), from which on nothing new is begun; None: never."""

    def __init__(self, count: int, deadline: float | None = None) -> None:
        self._pool = ThreadPoolExecutor(count) if count > 1 else None
        self.deadline = deadline

    def map(
        self, work: Callable[[Item], Result], items: Sequence[Item]
    ) -> list[Result]:
        """Return the results, in order. Raises TimeIsUp after the deadline."""
        if self.deadline is not None and time.monotonic() > self.deadline:
            raise TimeIsUp
        if self._pool is None:
            return [work(item) for item in items]
        return list(self._pool.map(work, items))


def log_density(
    model: Model, frame: Frame, prediction: Prediction | None = None
) -> tuple[Array, Array, Prediction]:
    """Return (log density per pixel, final residuals, prediction with the offsets of
    rows that the ADC cuts)."""
    density, z, p, cut = _density(model, frame, prediction)
    if cut is not None:
        z = whiten(residuals(cut.drawn, frame), cut.drawn, model, frame)[0]
    return density, z, p


def _density(
    model: Model, frame: Frame, prediction: Prediction | None = None
) -> tuple[Array, Array, Prediction, CutRows | None]:
    """Return (log density per pixel, what it is made of: residuals and prediction, rows
    that the ADC cuts)."""
    p = predict(model, frame) if prediction is None else prediction
    rows = flow_values(model, frame, "row_noise") if frame.is_cut else None
    cut = None if rows is None else cut_rows(p, rows, frame)
    p = p if cut is None else cut.likeliest
    z, cost = whiten(residuals(p, frame), p, model, frame)
    density = -0.5 * z * z - 0.5 * LOG_2PI + cost - 0.5 * np.log(p.variance)
    density = density - np.log(frame.range)
    for hit, sign in ((frame.at_white, 1.0), (frame.at_zero, -1.0)):
        if hit.any():
            end = first_censored(frame, hit, sign, p) / np.sqrt(p.variance[hit])
            beyond = log_ndtr(-end)
            density[hit] = np.maximum(beyond, LEAST_LOG)
    return density if cut is None else density + cut.log_density, z, p, cut


def total(
    model: Model,
    frames: Sequence[Frame],
    workers: Workers,
    prepared: Sequence[Prediction] | None = None,
) -> float:
    """Return the log-likelihood of frames, nats."""

    def of_frame(pair: tuple[Frame, Prediction | None]) -> float:
        frame, prediction = pair
        return float(_density(model, frame, prediction)[0][frame.counted].sum())

    known = [None] * len(frames) if prepared is None else prepared
    return sum(workers.map(of_frame, list(zip(frames, known, strict=True))))


def in_blocks(model: Model, frames: Sequence[Frame], workers: Workers) -> Array:
    """Return the log-likelihood in sums over squares of BLOCK pixels."""

    def sums(frame: Frame) -> Array:
        return block_sums(np.where(frame.counted, _density(model, frame)[0], 0))

    return np.concatenate(workers.map(sums, frames))


def block_sums(image: Array) -> Array:
    """Return sums over squares of BLOCK pixels of an image (T, h, w)."""
    count, height, width = image.shape
    rows, columns = -(-height // BLOCK), -(-width // BLOCK)
    padded = np.zeros((count, rows * BLOCK, columns * BLOCK))
    padded[:, :height, :width] = image
    shape = (count, rows, BLOCK, columns, BLOCK)
    return np.asarray(padded.reshape(shape).sum((2, 4)).ravel())
