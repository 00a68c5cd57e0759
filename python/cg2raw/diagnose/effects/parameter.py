# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Parameter: a number that a search looks for."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """A number that is searched: its bounds; 0 is none of the effect."""

    name: str
    low: float
    high: float
    unit: str = "1"
