# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Gap between simulation and measurement, on held-out frames."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cg2raw.diagnose.diagnosis import Gap
from cg2raw.diagnose.effects.base import NORMAL_95
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.censoring import DRAWN_ABOVE, UNCLIPPED, residuals
from cg2raw.diagnose.likelihood.likelihood import block_sums, log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict

LARGEST_IN_CHI_SQUARE = 50.0  # standard deviations that count in chi-square


@dataclass
class Sums:
    """Of the pixels of report frames: negative log density, squares of residuals.

    log_likelihood : of all that counts, at the ends of the ADC too, as a search has it.

    pixels : between the ends of the ADC, for densities. residuals : those and pixels at
    0, whose residuals are drawn: without them, noise that is cut is too narrow.
    independent : as many of them have noise of their own; of patch means, only the
    part that no error of their chart's colours is.
    blocks : of the loss; beyond : of what it is beyond the truth's, or, where that is
    not known, beyond that of standard normal residuals; both by squares of pixels."""

    loss: float = 0.0
    log_likelihood: float = 0.0
    squares: float = 0.0
    true_loss: float | None = 0.0
    pixels: int = 0
    residuals: int = 0
    independent: float = 0.0
    blocks: list[Array] = field(default_factory=list)
    beyond: list[Array] = field(default_factory=list)

    def add(self, model: Model, frame: Frame) -> tuple[Array, Prediction]:
        """Count a frame; return its residuals and prediction."""
        density, z, p = log_density(model, frame)
        used = frame.keep & ~frame.censored
        self.loss -= float(density[used].sum())
        self.log_likelihood += float(density[frame.counted].sum())
        self.pixels += int(used.sum())
        counted = frame.keep & ~frame.at_white & (p.mean < DRAWN_ABOVE)
        size = np.abs(z) * _widened(frame, p)
        self.squares += float(
            (np.minimum(size[counted], LARGEST_IN_CHI_SQUARE) ** 2).sum()
        )
        self.residuals += int(counted.sum())
        own = 1 - p.light_variance / p.variance if frame.samples is not None else 1.0
        self.independent += float((own * counted).sum())
        self.blocks.append(block_sums(np.where(used, -density, 0)))
        truth = frame.capture.log_density
        if truth is None or self.true_loss is None:
            self.true_loss = None
            beyond = 0.5 * (np.minimum(z * z, LARGEST_IN_CHI_SQUARE**2) - 1)
        else:
            true_density = np.nan_to_num(frame.tiles.cut(truth()))
            self.true_loss -= float(true_density[used].sum())
            beyond = true_density - density
        self.beyond.append(block_sums(np.where(used, beyond, 0)))
        return z, p

    def __add__(self, other: "Sums") -> "Sums":
        ours, theirs = self.true_loss, other.true_loss
        return Sums(
            self.loss + other.loss,
            self.log_likelihood + other.log_likelihood,
            self.squares + other.squares,
            None if ours is None or theirs is None else ours + theirs,
            self.pixels + other.pixels,
            self.residuals + other.residuals,
            self.independent + other.independent,
            self.blocks + other.blocks,
            self.beyond + other.beyond,
        )

    @property
    def chi2(self) -> float:
        return self.squares / max(self.residuals, 1)


def _widened(frame: Frame, p: Prediction) -> Array | float:
    """Return how much wider than one table's the standard deviation is that each table
    of a chart has, so that together they know its colours no better than one does."""
    if frame.samples is None:
        return 1.0
    more = p.light_variance * (1 - 1 / frame.repeats)
    return np.asarray(np.sqrt(p.variance / (p.variance - more)))


def systematic(model: Model, base: Model, frames: Sequence[Frame]) -> float | None:
    """Return E[z1 z2] over pairs of repeats, in noise variances of the base model: the
    squared error of the mean, without a bias by noise. None without repeats."""
    sets: dict[str, list[Frame]] = {}
    for frame in frames:
        if frame.capture.shows.image and frame.samples is None:
            sets.setdefault(frame.capture.set, []).append(frame)
    products, pixels = 0.0, 0
    for members in sets.values():
        if len(members) < 2:
            continue
        first, second = members[:2]
        p = predict(model, first)
        used = first.keep & second.keep & (p.mean < UNCLIPPED)
        # Residuals of censored pixels are drawn: without them noise near 0 is biased.
        product = residuals(p, first) * residuals(p, second) * p.variance
        product = product / predict(base, first).variance
        products += float(product[used].sum())
        pixels += int(used.sum())
    return products / pixels if pixels else None


def gap_of(
    before: Sums,
    after: Sums,
    systematic_errors: tuple[float | None, float | None],
    held_out: Sequence[str],
) -> Gap:
    """Return the gap of the report frames before and after."""
    pixels = max(after.pixels, 1)
    if after.true_loss is None:
        truth = after.loss / pixels - max(0.0, 0.5 * (after.chi2 - 1))
    else:
        truth = after.true_loss / pixels
    beyond = [part / pixels for part in after.beyond]
    more = [
        part + (first - last) / pixels
        for part, first, last in zip(beyond, before.blocks, after.blocks, strict=True)
    ]
    gaps = before.loss / pixels - truth, after.loss / pixels - truth
    return Gap(
        before=gaps[0],
        after=gaps[1],
        interval_before=_interval(gaps[0], more),
        interval_after=_interval(gaps[1], beyond),
        chi2_before=before.chi2,
        chi2_after=after.chi2,
        systematic_before=systematic_errors[0],
        systematic_after=systematic_errors[1],
        held_out=sorted(held_out),
    )


def _interval(value: float, parts: Sequence[Array]) -> tuple[float, float] | None:
    """Return the 95 % interval of a sum of independent parts, per piece of a frame.

    Of their noise alone: neighbours differ by it, and far ones by what they show.
    Source: J. von Neumann et al., Ann. Math. Stat. 12(2), 1941."""
    steps = np.concatenate([np.zeros(0), *(np.diff(part) for part in parts)])
    count = sum(len(part) for part in parts)
    if not len(steps):
        return None
    half = NORMAL_95 * float(np.sqrt(count * 0.5 * np.mean(steps**2)))
    return value - half, value + half
