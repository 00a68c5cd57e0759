# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Black-level drift: an offset for each frame, new in every one."""

from collections.abc import Mapping
from typing import Any

from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.sensor import Sensor


class BlackLevelDrift(SharedOffset):
    """All pixels of a frame, of all its tiles, share one offset."""

    name = "black_level_drift"
    title = "black-level drift"
    where = "frames differ by an offset, whatever the light"
    told_apart = {
        "black_level": "Several darks of one exposure time: a black level is the same "
        "in each, a drift is new in each.",
        "dark_current": "Several darks of one exposure time: dark current is the same "
        "in each, a drift is new in each.",
    }

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        sigma = self.sigma_in_effects(sensor)
        return (sigma / read_noise,) if sigma else None


EFFECT = BlackLevelDrift()
