# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Moments: what darks and flats say without a model of anything else."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Moments:
    """Of uniform frames, where a fit of all effects together starts.

    light, read : measured over predicted variance, of what grows with light and of the
        read noise; None where no frames repeat each other that show it.
    offset, rate : of darks above what is predicted, signal and signal per second."""

    light: float | None
    read: float | None
    offset: float
    rate: float
