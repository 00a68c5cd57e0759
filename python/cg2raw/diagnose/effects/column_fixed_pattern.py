# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Column fixed pattern: an offset for each column, the same in all frames."""

from cg2raw.diagnose.effects.fixed_pattern import FixedPattern


class ColumnFixedPattern(FixedPattern):
    name = "column_fixed_pattern"
    title = "column fixed pattern"
    where = "columns differ, the same in all frames"


EFFECT = ColumnFixedPattern()
