# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Read noise: its variance."""

from cg2raw.diagnose.effects.base import Parameter
from cg2raw.diagnose.effects.noise_gain import NoiseGain

NO_DIRECTION = (
    "Several darks: row noise is new in each, a column fixed pattern repeats, read "
    "noise has no direction."
)


class ReadNoise(NoiseGain):
    name = "read_noise"
    title = "read noise"
    where = "variance in darks"
    fitted = (Parameter("log_variance", -2.5, 3),)
    scales = "beta2"
    told_apart = {
        "dsnu": "Several darks of one exposure time: DSNU repeats in every frame.",
        "row_noise": NO_DIRECTION,
        "column_fixed_pattern": NO_DIRECTION,
    }


EFFECT = ReadNoise()
