# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects that are shapes of single pixels: shapes(statistics, training, validation).

A file each: its evidence, in nats on validation frames, and its numbers."""

from collections.abc import Mapping
from dataclasses import dataclass

from cg2raw.model.fit import Fit
from cg2raw.model.shapes.base import Shape, Shown
from cg2raw.model.shapes.dust import NAME as DUST
from cg2raw.model.shapes.dust import dust, like_shading, power_of_spots, unseen_light
from cg2raw.model.shapes.heavy_tailed_noise import NAME as TAILS
from cg2raw.model.shapes.heavy_tailed_noise import (
    core_of,
    heavy_tailed_noise,
    most_of,
    whole_of,
)
from cg2raw.model.shapes.hot_pixels import dark_median, hot_pixels
from cg2raw.model.shapes.pdaf_pixels import pdaf_pixels
from cg2raw.model.shapes.random_telegraph_noise import random_telegraph_noise
from cg2raw.statistics.constant import ConstantStatistics

EFFECTS = (
    hot_pixels,
    random_telegraph_noise,
    heavy_tailed_noise,
    dust,
    pdaf_pixels,
)


@dataclass(frozen=True)
class Shapes:
    """found : by name. dark_median : by how much the dark current of most pixels is
    above the mean of those that are not masked, and its standard error, DN/s; of
    training frames. cores : the variance of most draws in the shortest darks and its
    standard error, DN^2, of training and validation; None where it is not known. most :
    likewise, by the law of tails; only beside their evidence. whole : the variance of
    all samples of the shortest darks over that of those that are not masked, and its
    standard error.
    spots : by how much the variance of the pixels' sensitivity would be more with those
    in spots, which a profile's may have; of training frames. corners : the variance of
    a coefficient of shading by dust in corners. unseen_dust : of all light, what dust
    may take outside of the spots that are masked."""

    found: Mapping[str, Shape]
    dark_median: tuple[float, float] = (0.0, 0.0)
    cores: tuple[tuple[float, float] | None, ...] = (None, None)
    most: tuple[tuple[float, float] | None, ...] = (None, None)
    spots: float = 0.0
    whole: tuple[float, float] = (1.0, 0.0)
    corners: float = 0.0
    unseen_dust: float = 0.0

    def read_noise(
        self, profile: float, among: tuple[tuple[float, float] | None, ...]
    ) -> float | None:
        """Return the nats of read noise beside pixels that jump or tails: of most
        draws, as trained over a profile's, DN^2. among : of cores or most. None where
        it is not known."""
        trained, measured = among
        if trained is None or measured is None:
            return None
        value, error = measured
        away = (value - profile) ** 2 - (value - trained[0]) ** 2
        return away / error**2 / 2


def shapes(
    statistics: ConstantStatistics,
    splits: tuple[str, str],
    fits: tuple[Fit, Fit],
    hot: tuple[float, float] | None = None,
) -> Shapes:
    """Return what frames can show of shapes.

    statistics : of the groups of all splits. splits : the names of those to train and
    to validate by. fits : of these. hot : as of Shown."""
    shown = Shown(statistics, splits, fits, hot)
    found = (effect(shown) for effect in EFFECTS)
    by_name = {shape.name: shape for shape in found if shape is not None}
    tails = by_name.get(TAILS)
    has_tails = tails is not None and tails.nats > 0
    median = dark_median(shown, splits[0], not has_tails) or (0.0, 0.0)
    cores = tuple(core_of(shown, split) for split in splits)
    most = tuple(most_of(shown, split) if has_tails else None for split in splits)
    spots, whole = power_of_spots(shown, splits[0]), whole_of(shown, splits[1])
    corners, unseen, of_dust = 0.0, 0.0, by_name.get(DUST)
    if of_dust is not None:
        corners = like_shading(of_dust, statistics.planes[0], statistics.side)
        unseen = unseen_light(of_dust)
    return Shapes(by_name, median, cores, most, spots, whole, corners, unseen)
