# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The gap between simulation and measurement, on frames that nothing was fitted to."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.diagnosis import Gap
from cg2raw.diagnose.frames import Frame
from cg2raw.diagnose.likelihood import Workers, log_density
from cg2raw.diagnose.prediction import Model, predict

LARGEST = 50.0  # standard deviations that count in chi-square
HIGHEST = 0.95  # of white, for repeats


@dataclass(frozen=True)
class Fit:
    """How a model fits frames: means per pixel."""

    loss: float  # negative log density, nats
    chi2: float
    pixels: int


def fit_of(model: Model, frames: Sequence[Frame], workers: Workers) -> Fit:
    """Return the mean loss and chi-square of frames under a model."""

    def sums(frame: Frame) -> tuple[float, float, int]:
        density, z, _ = log_density(model, frame)
        used = frame.keep & ~frame.censored
        square = np.minimum(np.abs(z[used]), LARGEST) ** 2
        return float(density[used].sum()), float(square.sum()), int(used.sum())

    parts = workers.map(sums, frames)
    pixels = max(sum(part[2] for part in parts), 1)
    loss = -sum(part[0] for part in parts) / pixels
    return Fit(loss, sum(part[1] for part in parts) / pixels, pixels)


def true_loss(frames: Sequence[Frame]) -> float | None:
    """Return the loss of the true model, where simulated captures know it."""
    total, pixels = 0.0, 0
    for frame in frames:
        if frame.capture.log_density is None:
            return None
        density = frame.tiles.cut(frame.capture.log_density())
        used = frame.keep & ~frame.censored
        total += float(np.nansum(density[used]))
        pixels += int(used.sum())
    return -total / max(pixels, 1)


def systematic(model: Model, base: Model, frames: Sequence[Frame]) -> float | None:
    """Return E[z1 z2] over pairs of repeats, in noise variances of the base model: the
    squared error of the mean, without a bias by noise. None without repeats."""
    sets: dict[str, list[Frame]] = {}
    for frame in frames:
        if frame.capture.kind in ("scene", "chart"):
            sets.setdefault(frame.capture.set, []).append(frame)
    products, pixels = 0.0, 0
    for members in sets.values():
        if len(members) < 2:
            continue
        first, second = members[:2]
        mean = predict(model, first).mean
        spread = np.sqrt(predict(base, first).variance)
        used = first.keep & second.keep & ~first.censored & ~second.censored
        used &= mean < HIGHEST
        product = (first.signal - mean) * (second.signal - mean) / spread**2
        products += float(product[used].sum())
        pixels += int(used.sum())
    return products / pixels if pixels else None


def gap_of(base: Model, model: Model, frames: Sequence[Frame], workers: Workers) -> Gap:
    """Return the gap of the report frames before and after."""
    before, after = (fit_of(m, frames, workers) for m in (base, model))
    truth = true_loss(frames)
    if truth is None:
        rest = max(0.0, 0.5 * (after.chi2 - 1))
        truth = after.loss - rest
    return Gap(
        before=before.loss - truth,
        after=after.loss - truth,
        chi2_before=before.chi2,
        chi2_after=after.chi2,
        systematic_before=systematic(base, base, frames),
        systematic_after=systematic(model, base, frames),
        held_out=sorted({frame.capture.name for frame in frames}),
    )
