# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Crosstalk: a pixel's light is counted by its neighbours."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.sizes import percent


class Crosstalk(Effect):
    name = "crosstalk"
    title = "crosstalk between pixels"
    where = "between neighbours of the mosaic, at edges and in coloured flats"
    signature = frozenset({"mixer", "softener"})

    def size(self, values: Estimates) -> str:
        lost = percent(sum(e.value for e in values.values()))
        return f"a pixel loses {lost} of its signal to its neighbours"


EFFECT = Crosstalk()
