# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark current: charge that gathers with time."""

from cg2raw.diagnose.effects.base import PEDESTAL, TIME, Effect


class DarkCurrent(Effect):
    name = "dark_current"
    title = "dark current"
    where = "grows with exposure time, in darks too"
    step = 1e-4
    families = frozenset({PEDESTAL})
    signature = frozenset({"offset"})
    needs = TIME


EFFECT = DarkCurrent()
