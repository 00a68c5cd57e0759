# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Temperatures that headers state, and what they say of charge without light."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

SAME_TEMPERATURE = 1.0  # K; what lies closer is the jitter of one set point
# K that double dark charge: 5 to 7 for silicon near room temperature. Source: R.
# Widenhorn et al., Proc. SPIE 4669, 2002.
DOUBLING = 6.0
ROUNDED = 12**-0.5  # standard deviation of what is rounded, in units of the step


class Warmth(NamedTuple):
    """factors : of each frame, how much faster charge gathers than at the median
    temperature; 1 where it is not known. error : standard deviation of each."""

    factors: list[float]
    error: float


def set_points(temperatures: Sequence[float | None]) -> list[int]:
    """Return the number of the set point that each temperature belongs to."""
    known = sorted({t for t in temperatures if t is not None})
    number, numbers = 0, {}
    for before, t in zip([None, *known], known, strict=False):
        number += before is not None and t - before > SAME_TEMPERATURE
        numbers[t] = number
    return [0 if t is None else numbers[t] for t in temperatures]


def warmth_of_readings(temperatures: Sequence[float | None]) -> Warmth:
    """Return what readings of frames' temperatures, degrees Celsius, say of charge.

    Readings are rounded to their smallest difference. Where there are two alone, they
    may be one temperature at the edge between them: then neither is warmer."""
    known = np.array([t for t in temperatures if t is not None], float)
    readings = np.unique(known)
    if len(readings) < 2:
        return Warmth([1.0] * len(temperatures), 0.0)
    error = np.log(2) / DOUBLING * ROUNDED * float(np.diff(readings).min())
    middle = float(np.median(known))
    factors = [
        1.0
        if t is None or len(readings) == 2
        else float(2 ** ((t - middle) / DOUBLING))
        for t in temperatures
    ]
    return Warmth(factors, error)
