# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Correspondence: whether a render is one of what was captured."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.captures.phase_correlation import (
    Shift,
    far_words,
    misplaced_words,
    shift_between,
)
from cg2raw.diagnose.diagnosis import LARGEST_SHIFT
from cg2raw.diagnose.scenes.point import Point
from cg2raw.diagnose.scenes.registration import Placement, edges_of, first_guess

LEAST_ALIKE = 0.5  # correlation of a capture and its render
LEAST_USED = 0.01  # of the pixels of an image, between black and white
CONTRAST = 3.0  # standard deviations of noise, of an image that has any


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
        mean, noise = point.mean[used], 1 / point.root[used]
        signal, noise = view.signal[used], np.sqrt(np.mean(noise**2))
        is_render = view.frame.capture.shows.render
        if not is_render or max(mean.std(), signal.std()) < CONTRAST * noise:
            continue  # too little contrast to tell
        flat = min(mean.std(), signal.std()) < noise / CONTRAST
        alike = 0.0 if flat else float(np.corrcoef(mean, signal)[0, 1])
        if alike < LEAST_ALIKE:
            raise ValueError(
                f"{name}: the scene does not correspond to the capture: they "
                f"correlate by {alike:.2f}, and {LEAST_ALIKE} is the least: is it "
                "the render of this frame, of the same view and crop, and are both "
                "the same way up?"
            )
        found = placements.get(view.frame.capture.set, Placement.none()).affine[:, 0]
        for place in (found, first_guess(view.signal, point.mean, point.root > 0)):
            if np.abs(place).max() > LARGEST_SHIFT + 1:
                raise ValueError(
                    f"{name}: {far_words(*place)}: give the render of the same view "
                    "and crop"
                )
        if view.frame.capture.set not in placements:
            shifts += shifts_of(point)
    if words := misplaced_words(shifts):
        raise ValueError(words)


def shifts_of(point: Point) -> Iterator[Shift]:
    """Yield by how much the render of each tile lies beside it, px."""
    for signal, mean, root in zip(
        point.view.signal, point.mean, point.root, strict=True
    ):
        pair = (edges_of(image, root > 0) for image in (signal, mean))
        shift = shift_between(*pair)
        if shift.correlation >= LEAST_ALIKE:
            yield replace(shift, down=2 * shift.down, right=2 * shift.right)
