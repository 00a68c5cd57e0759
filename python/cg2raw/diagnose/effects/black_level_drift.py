# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Black-level drift: an offset for each frame, new in every one."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import WhiteningStage
from cg2raw.diagnose.effects.families import PEDESTAL, TEMPORAL
from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.diagnose.frames.tiling import Array, Tiling
from cg2raw.sensor import Sensor


class BlackLevelDrift(SharedOffset):
    """All pixels of a frame, of all its tiles, share one offset."""

    name = "black_level_drift"
    title = "black-level drift"
    where = "frames differ by an offset, whatever the light"
    # A frame's mean is known to a read noise over the root of its pixels.
    starts = ((0.01,), (0.03,), (0.1,), (0.3,), (1.0,))
    first_scale = 0.003
    families = frozenset({TEMPORAL, PEDESTAL})
    shares_offset = "frame"
    whitening = WhiteningStage.FRAME
    told_apart = {
        "black_level": "Several darks of one exposure time: a black level is the same "
        "in each, a drift is new in each.",
        "dark_current": "Several darks of one exposure time: dark current is the same "
        "in each, a drift is new in each.",
    }

    def summed(self, tiles: Tiling, image: Array) -> Array:
        return np.asarray(image.sum(keepdims=True))

    def once(self, tiles: Tiling) -> float:
        return 1.0

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        sigma = self.sigma_in_effects(sensor)
        return (sigma / read_noise,) if sigma else None


EFFECT = BlackLevelDrift()
