# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the variances of darks and flats are the sum of.

Each component is a variance times what one coefficient of a part has of it. Components
are nested: an offset of each pixel is in all parts, one of each column in those of the
columns. If each part had its own, one cause would get many names."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cg2raw.statistics.constant import PARTS, Array, PlaneStatistics

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
    number. planes : which have the same of it: those that a line runs through, all, or
    none. signature : what it is proportional to in a group; two make it a covariance
    of what has the one and what has the other."""

    name: str
    parts: Array
    signature: Signature = "constant"
    per: Literal["sample", "line"] = "sample"
    planes: Literal["none", "line", "all"] = "none"

    def multiplicity(self, height: int, width: int) -> Array:
        """Return (8,) what a coefficient has of it."""
        if self.per == "sample":
            return self.parts
        return self.parts * np.where(ROWS > 0, width, height)

    def in_means(self, plane: PlaneStatistics) -> Array:
        """Return (8,) what a coefficient of mean images has of it, in units of what it
        has of the noise of a sample. Copies of lines have lines' own, and are nearly
        what a shape is."""
        if self.parts.all():
            return self.parts
        of_lines = plane.copies.noise if self.per == "line" else 1.0
        many = self.multiplicity(*plane.shape) * of_lines
        return np.asarray(many / plane.mean_noise)

    def shared(self, side: int) -> Array:
        """Return (P, P) 1 where two of side x side planes have the same of it."""
        sites = np.divmod(np.arange(side**2), side)
        if self.planes == "all":
            return np.ones((side**2, side**2))
        if self.planes == "none":
            return np.eye(side**2)
        line = sites[0] if (self.parts * ROWS).any() else sites[1]
        return np.equal.outer(line, line).astype(float)


def _structure(
    name: str,
    signature: Signature,
    planes: Literal["none", "line", "all"] = "all",
    parts: Sequence[str] = LOW_PARTS,
) -> Iterator[Component]:
    """Yield what each low part has for itself.

    A low part is few coefficients of a shape. Each has a variance of its own, so that
    shapes do not tell those of patterns, which are in all parts."""
    for part in parts:
        yield Component(f"{name}, {part}", _in(part), signature, planes=planes)


# New in every frame. Those whose names no effect has: the read-out drifts within
# a frame, and a lamp's shape from frame to frame.
TEMPORAL = (
    Component("row_noise", ROWS, per="line", planes="line"),
    Component("column_noise", COLUMNS, per="line", planes="line"),
    *_structure("drift", "constant"),
    # A wave runs down the rows; how a lamp changes slowly knows no direction.
    *_structure("lamp", "light", parts=("smooth_rows", "smooth_columns")),
    *_structure("lamp", "light", parts=("slow", "field")),
    *_structure("mains_flicker", "light", "line", ("slow_rows", "fast_rows")),
)
# Of these, what every camera and lamp may do: no finding, and nothing unexplained.
FREE = ("drift", "lamp")
# The same in every frame. Those with spaces have no name of their own among effects.
PATTERNS = (
    Component("dsnu", ALL),
    Component("column_fixed_pattern", COLUMNS, per="line", planes="line"),
    Component("row_fixed_pattern", ROWS, per="line", planes="line"),
    Component("dark_current_nonuniformity", ALL, "time"),
    # Pixels of much dark current leak while they are read, or before.
    Component("dsnu and dark current", ALL, "constant and time"),
    Component("prnu", ALL, "light"),
    Component("columns of light", COLUMNS * FAST, "light", "line", "line"),
    Component("rows of light", ROWS * FAST, "light", "line", "line"),
)
FIXED = (
    *PATTERNS,
    *_structure("bias_structure", "constant"),
    *_structure("amplifier_glow", "time"),
    *_structure("lens_shading", "light"),
    *_structure("color_shading", "light", "none"),
)
