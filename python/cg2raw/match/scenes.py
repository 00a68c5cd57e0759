# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which captures show the scene of a render: what differs then is the exposure alone.

Scenes are known again by the ranks of luminance in a small picture, which neither
exposure nor tone changes; names do not count."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from cg2raw.match.frame import Frame

Ranks = NDArray[np.float32]

ALIKE = 0.98  # correlation of ranks from which on two frames show one scene
LIKELY = 0.9  # likewise, once the sets are known to share their scenes
LEAST_CELLS = 64  # of 256, that are known in both
SHARE = 0.5  # of the captures that must surely have a pair
ROWS = 256  # frames that are compared at a time
SAME_LEVEL = 0.1  # stops between renders of one scene
CHANCE = 0.05  # share of renders that may look like another one


def pairs(captures: Sequence[Frame], renders: Sequence[Frame]) -> list[tuple[int, int]]:
    """Return (capture, render) of one scene each; empty unless half of the captures
    have one, and renders are not alike among themselves."""
    ours, theirs = ranks(captures), ranks(renders)
    if chance(theirs, renders) > CHANCE:
        return []
    found = [
        (correlation(captures[index], renders[best]), index, int(best))
        for index, best in enumerate(nearest(ours, theirs))
    ]
    sure = sum(alike >= ALIKE for alike, _, _ in found)
    if sure < SHARE * len(captures):
        return []
    return [(index, best) for alike, index, best in found if alike >= LIKELY]


def chance(ours: Ranks, renders: Sequence[Frame]) -> float:
    """Return the share of renders that look like another of another level."""
    alike = [
        correlation(renders[index], renders[best]) >= ALIKE
        and abs(renders[index].level - renders[best].level) > SAME_LEVEL
        for index, best in enumerate(nearest(ours, ours, itself=False))
    ]
    return float(np.mean(alike)) if alike else 0.0


def ranks(frames: Sequence[Frame]) -> Ranks:
    """Return (frames, cells) ranks of thumbnails, of mean 0 and length 1; unknown cells
    have the mean."""
    found = np.zeros((len(frames), frames[0].thumbnail.size), np.float32)
    for row, frame in zip(found, frames, strict=True):
        cells = frame.thumbnail.ravel()
        known = np.isfinite(cells)
        row[known] = rankdata(cells[known])
        row[known] -= row[known].mean() if known.any() else 0
        row /= max(float(np.linalg.norm(row)), 1e-9)
    return found


def nearest(ours: Ranks, theirs: Ranks, itself: bool = True) -> NDArray[np.intp]:
    """Return the index of the most similar of theirs for each of ours."""
    found = []
    for first in range(0, len(ours), ROWS):
        alike = ours[first : first + ROWS] @ theirs.T
        if not itself:
            rows = np.arange(len(alike))
            alike[rows, first + rows] = -2
        found.append(np.argmax(alike, axis=1))
    return np.concatenate(found)


def correlation(one: Frame, other: Frame) -> float:
    """Return Spearman's correlation of the cells that both frames show, -1 of few."""
    a, b = one.thumbnail.ravel(), other.thumbnail.ravel()
    known = np.isfinite(a) & np.isfinite(b)
    if known.sum() < LEAST_CELLS:
        return -1.0
    a, b = rankdata(a[known]), rankdata(b[known])
    a, b = a - a.mean(), b - b.mean()
    length = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / length if length > 0 else -1.0
