# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sizes: numbers of an effect's estimates, for a sentence."""

import numpy as np

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.sensor import Sensor


def value_of(values: Estimates, name: str) -> float:
    """Return a value of estimates; 0 if there is none."""
    return values[name].value if name in values else 0.0


def percent(x: float) -> str:
    return f"{100 * x:.3g} %"


def of_white(share: float, sensor: Sensor | None) -> str:
    """Return a share of white in words: of a sensor first in DN, and in electrons if
    its profile has the noise of one ISO."""
    text = f"{share:.4g} of white"
    if sensor is None:
        return text
    span = sensor.white_level - float(np.mean(sensor.black_level))
    units = [f"{share * span:.4g} DN"]
    if len(sensor.noise) == 1:
        electron = float(np.mean(sensor.noise[0]["beta1"]))
        units += [f"{share / electron:.4g} e-"] if electron > 0 else []
    return f"{', '.join(units)} ({text})"


def total(values: Estimates, *names: str) -> float:
    """Return the sum of some values."""
    return sum(value_of(values, name) for name in names)
