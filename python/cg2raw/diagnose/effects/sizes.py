# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sizes: numbers of an effect's estimates, for a sentence."""

from cg2raw.diagnose.effects.base import Estimates


def value_of(values: Estimates, name: str) -> float:
    """Return a value of estimates; 0 if there is none."""
    return values[name].value if name in values else 0.0


def percent(x: float) -> str:
    return f"{100 * x:.3g} %"


def total(values: Estimates, *names: str) -> float:
    """Return the sum of some values."""
    return sum(value_of(values, name) for name in names)
