# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark current: charge that gathers with time."""

import numpy as np

from cg2raw.diagnose.effects.base import PEDESTAL, TIME, Effect, Values
from cg2raw.diagnose.effects.moments import Moments


class DarkCurrent(Effect):
    name = "dark_current"
    title = "dark current"
    where = "grows with exposure time, in darks too"
    measured_by_uniform_frames = True
    step = 1e-4
    families = frozenset({PEDESTAL})
    signature = frozenset({"offset"})
    needs = TIME

    def from_moments(self, moments: Moments) -> Values:
        return np.array([moments.rate])


EFFECT = DarkCurrent()
