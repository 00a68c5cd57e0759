# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Shot noise: its variance per signal."""

from cg2raw.diagnose.effects.base import Parameter
from cg2raw.diagnose.effects.noise_gain import NoiseGain


class ShotNoise(NoiseGain):
    name = "shot_noise"
    title = "shot noise gain"
    where = "variance in proportion to signal"
    fitted = (Parameter("log_gain", -1.5, 1.5),)
    scales = "beta1"
    told_apart = {
        "prnu": "Several flats of one level: PRNU repeats in every frame and its "
        "variance grows with the square of the signal, that of shot noise with the "
        "signal.",
    }


EFFECT = ShotNoise()
