# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Splits: frames in three disjoint groups, to fit, to select and to report."""

from collections.abc import Mapping, Sequence
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.captures.capture import Group

GROUPS: tuple[Group, ...] = get_args(Group)
SPLIT_BLOCK = 8  # px; a multiple of every Bayer repeat


def groups_of_sets(
    strata: Mapping[str, tuple[float, ...]], declared: Mapping[str, Group]
) -> dict[str, Group | None]:
    """Return the group of each set of one kind; None where its pixels are divided.

    strata : of each set, what it should be spread by (such as the exposure time).
    declared : sets whose group was given.

    Fewer than three sets cannot be divided: those not declared are by pixels. Else
    each, in the order of the strata, goes where fewest are: they take turns."""
    found: dict[str, Group | None] = dict(declared)
    free = sorted(
        (name for name in strata if name not in declared), key=lambda set: strata[set]
    )
    if len(strata) < len(GROUPS):
        return found | dict.fromkeys(free)
    for name in free:
        members = list(found.values())
        found[name] = min(GROUPS, key=lambda group: members.count(group))
    return found


def third(shape: Sequence[int], group: Group) -> NDArray[np.bool_]:
    """Return (H, W), True in the pixels of a frame that are one group's.

    Blocks in diagonals: each row and column has a third of its pixels in each group, so
    that rows and columns can be tested, and every radius is in all three."""
    rows = np.arange(shape[0])[:, None] // SPLIT_BLOCK
    cols = np.arange(shape[1])[None, :] // SPLIT_BLOCK
    mask: NDArray[np.bool_] = (rows + cols) % len(GROUPS) == GROUPS.index(group)
    return mask


def third_of_columns(width: int, group: Group, side: int) -> NDArray[np.intp]:
    """Return the columns of a frame that are one group's, as many in each, in order:
    every third one, so that what varies over the field is in all groups alike. They
    have the colours of the CFA's repeat.

    side : px of that repeat. Raises ValueError for a frame without a repeat in each
    group."""
    apart, first = len(GROUPS), GROUPS.index(group) * side
    repeat = np.arange(side) * (apart if side % apart else 1)
    last = (apart - 1) * side + repeat[-1]
    if width <= last:
        raise ValueError(
            f"frames: {width} px wide, too narrow to divide their columns; must be "
            f"{last + 1} at least, or add frames"
        )
    starts = np.arange(0, width - last, apart * side)
    return np.asarray((first + starts[:, None] + repeat).ravel())
