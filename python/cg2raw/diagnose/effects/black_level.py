# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Black level: an offset for each CFA site."""

import numpy as np

from cg2raw.diagnose.effects.base import PEDESTAL, Effect, Values
from cg2raw.diagnose.effects.moments import Moments


class BlackLevel(Effect):
    name = "black_level"
    title = "black level"
    where = "an offset per CFA site, whatever the light"
    measured_by_uniform_frames = True
    step = 1e-4
    families = frozenset({PEDESTAL})
    signature = frozenset({"offset"})
    from_means = True
    bayer_only = True

    def from_moments(self, moments: Moments) -> Values:
        return np.full(len(self.parameters), moments.offset)


EFFECT = BlackLevel()
