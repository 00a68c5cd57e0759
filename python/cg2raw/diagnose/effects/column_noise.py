# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Column noise: an offset of each column, the same in all frames."""

from cg2raw.diagnose.effects.fixed_pattern import FixedPattern


class ColumnNoise(FixedPattern):
    name = "column_noise"
    title = "column noise"
    where = "columns differ, the same in all frames"
    layout = "columns"


EFFECT = ColumnNoise()
