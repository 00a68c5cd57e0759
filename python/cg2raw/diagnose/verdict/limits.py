# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Detection limits: how strong an effect would have had to be to be named."""

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from cg2raw.diagnose.diagnosis import DetectionLimit
from cg2raw.diagnose.effects.registry import registered
from cg2raw.model.figures import NORMAL
from cg2raw.model.values import Value


def detection_limits(
    values: Sequence[Value], named: Collection[str], least: float, cfa: str
) -> Iterator[DetectionLimit]:
    """Yield the limit of each parameter whose effect is not named.

    values : of all effects that the frames show. least : nats that a name needs. Of a
    parameter alone, known by a standard error, a strength s gains (s / error)^2 / 2
    on average, and half a nat by chance."""
    root = np.sqrt(2 * (least + 0.5))
    for one in values:
        if one.effect in named:
            continue
        if one.parameter == "sigma":  # a variance is what the frames show
            error = (one.high**2 - max(one.low, 0.0) ** 2) / 2 / NORMAL
            strength = np.sqrt(root * error)
        else:
            strength = root * (one.high - one.low) / 2 / NORMAL
        units = {
            p["name"]: p["unit"] for p in registered(cfa)[one.effect]["parameters"]
        }
        unit = units.get(one.parameter, "1")
        yield DetectionLimit(one.effect, one.parameter, float(strength), unit)
