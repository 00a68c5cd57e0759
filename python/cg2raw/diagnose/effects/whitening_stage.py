# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""WhiteningStage: when an effect whitens residuals."""

from enum import IntEnum


class WhiteningStage(IntEnum):
    """The order in which a model's effects whiten residuals: back through a camera.

    What all pixels of a frame share comes after what those of a row do: what is left
    of it by then is still one direction, which `likelihood.whitening` follows."""

    CLIPPING = 1
    FILTER = 2
    AMPLIFIER = 3
    ROWS = 4
    FRAME = 5
    NUISANCE = 6
    JUMPS = 7
    PHOTONS = 8
    READOUT = 9
