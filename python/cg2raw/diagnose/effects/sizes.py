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


def of_white(share: float, sensor: Sensor) -> str:
    """Return a share of white in words: in DN, and in electrons if the profile has the
    noise of one ISO."""
    words = f"{share * sensor.signal_range:.3g} DN"
    electron = float(np.mean(sensor.noise[0]["beta1"])) if len(sensor.noise) == 1 else 0
    return f"{words} ({share / electron:.3g} e-)" if electron > 0 else words


def total(values: Estimates, *names: str) -> float:
    """Return the sum of some values."""
    return sum(value_of(values, name) for name in names)
