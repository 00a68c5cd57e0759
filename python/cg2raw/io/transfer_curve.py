# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Curves from display-referred code values to scene-linear light."""

import math
from decimal import Decimal, localcontext
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import FloatImage

Curve = str | float  # "srgb", or the exponent of a power


def srgb(code: float) -> float:
    """Return light of an sRGB value, both 0..1. Source: IEC 61966-2-1."""
    if code <= 0.04045:
        return code / 12.92
    return power((code + 0.055) / 1.055, 2.4)


def power(base: float, exponent: float) -> float:
    """Return a power that rounds to the same float32 on any machine.

    The C library's differs in the last bits of float64; where these decide the float32,
    an exact one takes its place."""
    value = math.pow(base, exponent)
    if np.float32(value * (1 - 2**-48)) == np.float32(value * (1 + 2**-48)):
        return value
    with localcontext() as context:
        context.prec = 40
        return float(Decimal(base) ** Decimal(exponent))


@cache
def table(curve: Curve, levels: int) -> FloatImage:
    """Return (levels,) float32: light of each code value 0 .. levels - 1.

    curve : "srgb", or the exponent of a power."""
    top = levels - 1
    if isinstance(curve, str):
        light = [srgb(code / top) for code in range(levels)]
    else:
        light = [power(code / top, curve) for code in range(levels)]
    return np.array(light, np.float32)


def srgb_light(values: NDArray[Any]) -> FloatImage:
    """Return float32 light of float sRGB values. Source: IEC 61966-2-1."""
    v = np.asarray(values, np.float64)
    linear = np.where(v <= 0.04045, v / 12.92, ((np.abs(v) + 0.055) / 1.055) ** 2.4)
    return linear.astype(np.float32)
