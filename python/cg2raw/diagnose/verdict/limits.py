# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Detection limits: how strong an effect would have had to be to be named."""

from collections.abc import Collection, Iterator

import numpy as np

from cg2raw.diagnose.darks_and_flats import VALIDATION, DarksAndFlats
from cg2raw.diagnose.diagnosis import DetectionLimit
from cg2raw.diagnose.effects.registry import unit_of
from cg2raw.diagnose.verdict.values import limits_of_levels, of_amplifiers
from cg2raw.model.values import Value, effect_values
from cg2raw.normal import CI95


def detection_limits(
    found: DarksAndFlats, named: Collection[str]
) -> Iterator[DetectionLimit]:
    """Yield the limit of each parameter that the frames show and whose effect is not
    named.

    Of a parameter alone, known by a standard error to the frames that decide, a
    strength s gains (s / error)^2 / 2 on average, and half a nat by chance."""
    sensor, selected = found.captures.sensor, found.selection
    white = sensor.signal_range
    own = found.statistics.of_splits([VALIDATION])
    values = effect_values(own, selected.validation, found.profile, white)
    root = np.sqrt(2 * (found.least + 0.5))
    errors = found.amplifiers.errors.items()
    of_steps = of_amplifiers(found, {name: (0.0, error) for name, error in errors})
    for one in (*values, *limits_of_levels(found), *of_steps):
        if one.effect in named:
            continue
        unsure = selected.unsure.get(one.effect, 0.0) / white
        strength = root * np.hypot(_error_of(one), unsure)
        if one.parameter == "sigma":
            strength = np.sqrt(strength)
        unit = unit_of(one.effect, one.parameter, sensor.cfa)
        yield DetectionLimit(one.effect, one.parameter, float(strength), unit)


def _error_of(one: Value) -> float:
    """Return the standard error of a value; of a deviation that of its variance, which
    is what frames show."""
    if one.parameter == "sigma":
        return (one.high**2 - max(one.low, 0.0) ** 2) / 2 / CI95
    return (one.high - one.low) / 2 / CI95
