# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects that are shapes of single pixels: shapes(statistics, training, validation).

A file each: its evidence, in nats on validation frames, and its numbers."""

from collections.abc import Mapping
from dataclasses import dataclass

from cg2raw.model.fit import Fit
from cg2raw.model.shapes.base import Shape, Shown
from cg2raw.model.shapes.hot_pixels import dark_median, hot_pixels
from cg2raw.statistics.constant import ConstantStatistics

EFFECTS = (hot_pixels,)


@dataclass(frozen=True)
class Shapes:
    """found : by name. dark_median : by how much the dark current of most pixels is
    above the mean of those that are not masked, and its standard error, DN/s; of
    training frames."""

    found: Mapping[str, Shape]
    dark_median: tuple[float, float] = (0.0, 0.0)


def shapes(
    statistics: ConstantStatistics, splits: tuple[str, str], fits: tuple[Fit, Fit]
) -> Shapes:
    """Return what frames can show of shapes.

    statistics : of the groups of all splits. splits : the names of those to train and
    to validate by. fits : of these."""
    shown = Shown(statistics, splits, fits)
    found = (effect(shown) for effect in EFFECTS)
    by_name = {shape.name: shape for shape in found if shape is not None}
    return Shapes(by_name, dark_median(shown, splits[0]) or (0.0, 0.0))
