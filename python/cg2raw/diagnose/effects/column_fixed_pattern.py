# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Column fixed pattern: an offset for each column, the same in all frames."""

from collections.abc import Mapping

from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.tiling import Array


class ColumnFixedPattern(FixedPattern):
    name = "column_fixed_pattern"
    title = "column fixed pattern"
    where = "columns differ, the same in all frames"

    def pattern_variance(
        self, stated: Mapping[str, float], light: Array, seconds: float
    ) -> float:
        return stated["sigma"] ** 2


EFFECT = ColumnFixedPattern()
