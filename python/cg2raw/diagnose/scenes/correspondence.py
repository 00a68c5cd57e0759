# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Correspondence: whether a render is one of what was captured."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.captures.phase_correlation import (
    CONTRAST,
    LEAST_ALIKE,
    Shift,
    far_words,
    likeness,
    misplaced_words,
    shift_between,
    unlike_words,
)
from cg2raw.diagnose.diagnosis import LARGEST_SHIFT
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.scenes.point import Point
from cg2raw.diagnose.scenes.registration import Placement, edges_of, first_guess

LEAST_USED = 0.01  # of the pixels of an image, between black and white


def check_correspondence(
    points: Iterable[Point], placements: Mapping[str, Placement]
) -> None:
    """Refuse renders of something else than was captured or beside it, and images that
    say nothing. placements : by set, where renders were found if registration is a
    nuisance. Raises ValueError."""
    shifts: list[Shift] = []
    for point in points:
        view, used = point.view, point.root > 0
        name = view.frame.capture.name
        share = float(used.sum() / max(view.frame.keep.sum(), 1))
        if share < LEAST_USED:
            raise ValueError(
                f"{name}: {share:.1%} of its pixels are predicted, and measured, "
                f"between black and white; must be {LEAST_USED:.0%} at least: "
                "expose otherwise, or give the scene's gain"
            )
        if not view.frame.capture.shows.render:
            continue
        noise = float(np.sqrt(np.mean(point.root[used] ** -2.0)))
        alike = likeness(view.signal[used], point.mean[used], noise)
        both = edges_in(point)
        if alike < LEAST_ALIKE:
            alike = max(alike, likeness(both[:, 0], both[:, 1], noise / 2))
        if alike < LEAST_ALIKE:
            raise ValueError(f"{name}: {unlike_words(alike)}")
        contrast = max(view.signal[used].std(), point.mean[used].std())
        if contrast < CONTRAST * noise:
            continue  # too little to tell where it lies
        found = placements.get(view.frame.capture.set, Placement.none()).affine[:, 0]
        for place in (found, first_guess(view.signal, point.mean, point.root > 0)):
            if np.abs(place).max() > LARGEST_SHIFT + 1:
                raise ValueError(
                    f"{name}: {far_words(*place)}: give the render of the same view "
                    "and crop"
                )
        if view.frame.capture.set not in placements:
            shifts += shifts_of(both)
    if words := misplaced_words(shifts):
        raise ValueError(words)


def edges_in(point: Point) -> Array:
    """Return (T, 2, h, w), the edges in the tiles of a capture and of its render, which
    are halved."""
    usable = point.root > 0
    pairs = zip(point.view.signal, point.mean, usable, strict=True)
    return np.array([[edges_of(a, some), edges_of(b, some)] for a, b, some in pairs])


def shifts_of(tiles: Array) -> Iterator[Shift]:
    """Yield by how much the render of each tile lies beside it, px, where it is one of
    it. tiles : as of edges_in."""
    for pair in tiles:
        shift = shift_between(*pair)
        if shift.is_told:
            yield replace(shift, down=2 * shift.down, right=2 * shift.right)
