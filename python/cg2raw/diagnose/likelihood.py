# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Likelihood: log density of frames under a model, nats, with density in DN."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np
from scipy.special import log_ndtr, ndtr, ndtri

from cg2raw.diagnose.cut_rows import cut_rows
from cg2raw.diagnose.flows import whiten
from cg2raw.diagnose.frames import Frame
from cg2raw.diagnose.prediction import Model, Prediction, flow_values, predict
from cg2raw.diagnose.tiling import Array, Mask

LOG_2PI = np.log(2 * np.pi)
LEAST_LOG = -200.0  # of a censored pixel, so that one cannot outweigh all
LARGEST_Z = 8.0
LEAST_TOLD = 1e-6  # of a pixel that was cut, of what one tells that was not
BLOCK = 16  # pixels; sums over such squares are taken as independent

Item = TypeVar("Item")
Result = TypeVar("Result")


class Workers:
    """Threads that work on frames; numpy and the registry let go of the interpreter."""

    def __init__(self, count: int) -> None:
        self._pool = ThreadPoolExecutor(count) if count > 1 else None

    def map(
        self, work: Callable[[Item], Result], items: Sequence[Item]
    ) -> list[Result]:
        if self._pool is None:
            return [work(item) for item in items]
        return list(self._pool.map(work, items))


def residuals(p: Prediction, frame: Frame) -> Array:
    """Return standardised residuals; those of censored pixels are drawn from what the
    model leaves possible. Source: P. K. Dunn, G. K. Smyth, J. Comput. Graph. Stat.
    5(3), 1996."""
    spread = np.sqrt(p.variance)
    z = (frame.signal - p.mean) / spread
    for hit, sign in ((frame.at_white, 1.0), (frame.at_zero, -1.0)):
        if not hit.any():
            continue
        end = _first_censored(frame, hit, sign, p) / spread[hit]
        low = ndtr(end)
        drawn = ndtri(low + frame.uniform[hit] * (1 - low))
        drawn = np.clip(drawn, -LARGEST_Z, LARGEST_Z)
        z[hit] = sign * np.where(low > 1 - 1e-14, end, drawn)
    return z


def _first_censored(frame: Frame, hit: Mask, sign: float, p: Prediction) -> Array:
    """Return the way from the mean to what is rounded to the ADC's end."""
    half = 0.5 / np.broadcast_to(frame.range, hit.shape)[hit]
    return sign * (frame.signal[hit] - p.mean[hit]) - half


def scores(p: Prediction, frame: Frame) -> tuple[Array, Array, Array]:
    """Return (score of the mean, of the variance, weight) of every pixel.

    The mean's is its residual, times its weight; the variance's is of its log, times
    the root of 2. weight : root of what a pixel tells of its mean, 1 but of those that
    are cut at an end of the ADC: they tell that they lie beyond it, and the score of
    their mean is the inverse of Mills' ratio."""
    spread = np.sqrt(p.variance)
    z = np.where(frame.counted, (frame.signal - p.mean) / spread, 0)
    square = (z * z - 1) * np.sqrt(0.5)
    weight = np.ones_like(z)
    for hit, sign in ((frame.at_white, 1.0), (frame.at_zero, -1.0)):
        if hit.any():
            end = _first_censored(frame, hit, sign, p) / spread[hit]
            ratio = np.exp(-0.5 * end**2 - 0.5 * LOG_2PI - log_ndtr(-end))
            told = np.sqrt(np.clip(ratio * (ratio - end), LEAST_TOLD, 1))
            z[hit], weight[hit] = sign * ratio / told, told
            square[hit] = np.sqrt(0.5) * ratio * end
    return z, square, weight


def log_density(
    model: Model, frame: Frame, prediction: Prediction | None = None
) -> tuple[Array, Array, Prediction]:
    """Return (log density per pixel, final residuals, prediction with the offsets of
    rows that the ADC cuts)."""
    p = predict(model, frame) if prediction is None else prediction
    rows = flow_values(model, frame, "row_noise") if frame.is_cut else None
    cut = None if rows is None else cut_rows(p, rows, frame)
    p = p if cut is None else cut.likeliest
    z, cost = whiten(residuals(p, frame), p, model, frame)
    density = -0.5 * z * z - 0.5 * LOG_2PI + cost - 0.5 * np.log(p.variance)
    density = density - np.log(frame.range)
    for hit, sign in ((frame.at_white, 1.0), (frame.at_zero, -1.0)):
        if hit.any():
            end = _first_censored(frame, hit, sign, p) / np.sqrt(p.variance[hit])
            beyond = log_ndtr(-end)
            density[hit] = np.maximum(beyond, LEAST_LOG)
    if cut is not None:
        density = density + cut.log_density
        z = whiten(residuals(cut.drawn, frame), cut.drawn, model, frame)[0]
    return density, z, p


def total(
    model: Model,
    frames: Sequence[Frame],
    workers: Workers,
    prepared: Sequence[Prediction] | None = None,
) -> float:
    """Return the log-likelihood of frames, nats."""
    if prepared is None:
        return float(
            sum(
                workers.map(lambda f: log_density(model, f)[0][f.counted].sum(), frames)
            )
        )
    known = {id(f): p for f, p in zip(frames, prepared, strict=True)}
    return float(
        sum(
            workers.map(
                lambda f: log_density(model, f, known[id(f)])[0][f.counted].sum(),
                frames,
            )
        )
    )


def in_blocks(model: Model, frames: Sequence[Frame], workers: Workers) -> Array:
    """Return the log-likelihood in sums over squares of BLOCK pixels."""

    def sums(frame: Frame) -> Array:
        return block_sums(np.where(frame.counted, log_density(model, frame)[0], 0))

    return np.concatenate(workers.map(sums, frames))


def block_sums(image: Array) -> Array:
    """Return sums over squares of BLOCK pixels of an image (T, h, w)."""
    count, height, width = image.shape
    rows, columns = -(-height // BLOCK), -(-width // BLOCK)
    padded = np.zeros((count, rows * BLOCK, columns * BLOCK))
    padded[:, :height, :width] = image
    shape = (count, rows, BLOCK, columns, BLOCK)
    return np.asarray(padded.reshape(shape).sum((2, 4)).ravel())
