# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the variances of darks and flats are the sum of.

Each component is a variance times what one coefficient of a part has of it. Components
are nested: an offset of each pixel is in all parts, one of each column in those of the
columns. If each part had its own, one cause would get many names."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cg2raw.statistics.constant import PARTS, Array

Signature = Literal["constant", "time", "light", "constant and time"]


def _in(*parts: str) -> Array:
    """Return (8,) 1 for parts whose names begin or end so, else 0."""
    chosen = [any(p.startswith(n) or p.endswith(n) for n in parts) for p in PARTS]
    return np.array(chosen, float)


ALL = _in("")
ROWS, COLUMNS = _in("rows"), _in("columns")
LOW, FAST = _in("smooth", "slow", "field"), _in("fast")
LOW_PARTS = tuple(part for part, is_low in zip(PARTS, LOW, strict=True) if is_low)
# Parts of low frequency along a row or down a column: there the covariance of next
# neighbours adds to the variance, twice.
EVEN_ACROSS = np.maximum(ROWS, LOW)
EVEN_DOWN = np.maximum(COLUMNS, LOW)


@dataclass(frozen=True)
class Component:
    """A variance, DN^2 (of signature "time" (DN/s)^2, of "light" relative).

    parts : (8,) of it in a coefficient of each part. per : a coefficient of lines has
    it once for every sample of a line, since it is a mean times the root of their
    number. signature : what it is proportional to in a group; two make it a covariance
    of what has the one and what has the other."""

    name: str
    parts: Array
    signature: Signature = "constant"
    per: Literal["sample", "line"] = "sample"

    def multiplicity(self, height: int, width: int) -> Array:
        """Return (8,) what a coefficient has of it."""
        if self.per == "sample":
            return self.parts
        return self.parts * np.where(ROWS > 0, width, height)


def _structure(name: str, signature: Signature) -> Iterator[Component]:
    """Yield what each low part has for itself.

    A low part is few coefficients of a shape. Each has a variance of its own, so that
    shapes do not tell those of patterns, which are in all parts."""
    for part in LOW_PARTS:
        yield Component(f"{name}, {part}", _in(part), signature)


# New in every frame. Those whose names no effect has: the read-out drifts within
# a frame, and a lamp's shape from frame to frame.
TEMPORAL = (
    Component("row_noise", ROWS, per="line"),
    Component("column_noise", COLUMNS, per="line"),
    *_structure("drift", "constant"),
    *_structure("lamp", "light"),
)
# The same in every frame. Those with spaces have no name of their own among effects.
PATTERNS = (
    Component("dsnu", ALL),
    Component("column_fixed_pattern", COLUMNS, per="line"),
    Component("row_fixed_pattern", ROWS, per="line"),
    Component("dark_current_nonuniformity", ALL, "time"),
    # Pixels of much dark current leak while they are read, or before.
    Component("dsnu and dark current", ALL, "constant and time"),
    Component("prnu", ALL, "light"),
    Component("columns of light", COLUMNS * FAST, "light", "line"),
    Component("rows of light", ROWS * FAST, "light", "line"),
)
FIXED = (
    *PATTERNS,
    *_structure("bias_structure", "constant"),
    *_structure("amplifier_glow", "time"),
    *_structure("lens_shading", "light"),
)
