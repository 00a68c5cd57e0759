# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Fixed sums: what residuals of the same pixel have in common, and what the errors of
maps explain of it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import blending, variance_of_map


@dataclass
class FixedSums:
    """Per pixel, of frames of one shape: sums of residuals and of their squares, number
    of frames, and what these show of uncertain maps, by map and by pair of maps."""

    residuals: Any = 0.0
    squares: Any = 0.0
    counts: Any = 0
    _shown: dict[str, Any] = field(default_factory=dict)
    _together: dict[tuple[str, str], Any] = field(default_factory=dict)
    _covariance: dict[tuple[str, str], Any] = field(default_factory=dict)

    def count_maps(self, shown: Sequence[tuple[str, SensorMap, Array]]) -> None:
        """Count what one frame shows of maps, in standard deviations of it."""
        slopes = {name: slope for name, _, slope in shown}
        for name, known, slope in shown:
            self._shown[name] = self._shown.get(name, 0.0) + slope
            for other, covariance in {name: known.variance, **known.covariance}.items():
                if other in slopes:
                    pair, product = (name, other), slope * slopes[other]
                    self._together[pair] = self._together.get(pair, 0.0) + product
                    self._covariance[pair] = covariance

    @property
    def of_maps(self) -> Any:
        """What the errors of maps, the same in all frames, add to the products of
        residuals of different frames, summed over these."""
        return sum(
            covariance * (self._shown[one] * self._shown[other] - self._together[pair])
            for pair, covariance in self._covariance.items()
            for one, other in (pair,)
        )


def shown_maps(
    model: Model, frame: Frame, p: Prediction, used: Mask
) -> list[tuple[str, SensorMap, Array]]:
    """Return the name of every map, it, and by how many standard deviations of whitened
    residuals the pixels that are used show it."""
    before = p.variance
    for effect, values in blending(model, frame):
        before = before / effect.variance_left(values)
    scale = used / np.sqrt(before)
    fitted = frame.capture.group == "fit"
    return [
        (
            term.name,
            replace(known, variance=variance_of_map(model, effect, known, fitted)),
            effect.shown(frame, p) * scale,
        )
        for term, effect, known in model.maps
        if known.mean.shape == used.shape and not effect.whitens_variance
    ]
