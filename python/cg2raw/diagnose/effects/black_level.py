# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Black level: an offset for each CFA site."""

import numpy as np

from cg2raw.cfa import is_mono
from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.sensor import Sensor


class BlackLevel(Effect):
    name = "black_level"
    title = "black level"
    where = "an offset per CFA site, whatever the light"
    step = 1e-4
    signature = frozenset({"offset"})
    from_means = True
    bayer_only = True
    of_images = False

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """In DN, since nobody measures black in shares of white."""
        ranges = sensor.white_level - np.asarray(sensor.black_level, float)
        sites = [""] if is_mono(sensor.cfa) else [f"{one} " for one in sensor.cfa]
        parts = [
            f"{site}{span * e.value:+.4g} DN "
            f"({span * e.ci95[0]:.4g} to {span * e.ci95[1]:.4g})"
            for site, span, e in zip(sites, ranges, values.values(), strict=True)
        ]
        return f"the black level is off by {', '.join(parts)}"


EFFECT = BlackLevel()
