# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Black level: an offset for each CFA site."""

from cg2raw.diagnose.effects.base import PEDESTAL, Effect


class BlackLevel(Effect):
    name = "black_level"
    title = "black level"
    where = "an offset per CFA site, whatever the light"
    step = 1e-4
    families = frozenset({PEDESTAL})
    signature = frozenset({"offset"})
    bayer_only = True


EFFECT = BlackLevel()
