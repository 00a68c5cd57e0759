# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Uniform frames: which darks and flats of a capture set decide, and their statistics.

Others are left out with a note: of another ISO, size or temperature than most, with a
residual image, and with full wells."""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.constant_statistics import (
    saved_statistics,
    statistics_by_split,
)
from cg2raw.diagnose.captures.residual_image import Blocks, residual_images
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.model.evaluation import Parameters
from cg2raw.model.fit import fit
from cg2raw.model.full_well import FullWell, full_well
from cg2raw.model.profile_values import profile_values
from cg2raw.short_messages import plural
from cg2raw.statistics.constant import Array, ConstantStatistics
from cg2raw.statistics.temperature import set_points

MOST_LISTED = 20  # lines, by number


@dataclass(frozen=True)
class UniformFrames:
    """captures : that decide; statistics : of them, by split. profile : (n,) parameters
    as the profile has them; has_noise : whether it has noise, else that is of the
    frames. notes : sentences on what was left out. spoiled : darks with a residual
    image. well : where flats that are left out have full ones, None where none has."""

    captures: Sequence[Capture]
    statistics: ConstantStatistics
    profile: Array
    has_noise: bool
    notes: Sequence[str]
    spoiled: Sequence[Capture]
    well: FullWell | None

    @property
    def are_divided(self) -> bool:
        """Whether each group has a part of the columns of the same frames."""
        return any(capture.divided for capture in self.captures)

    @property
    def masked(self) -> NDArray[np.bool_]:
        """(H, W) samples that are none of a pattern: hot, or in a line that is."""
        shape = self.captures[0].shape
        return (
            np.zeros(shape, bool) if self.are_divided else self.statistics.masked(shape)
        )


def uniform_frames(
    captures: CaptureSet,
    least: float,
    tell: Callable[[float], None],
    saved: str | os.PathLike[str] | None = None,
) -> UniformFrames:
    """Return the darks and flats that decide.

    least : nats that a name needs. tell : is called with the share that is read.
    saved : a file of saved_statistics. Raises ValueError where a split has none, and
    for a file that is not of them."""
    sensor = captures.sensor
    every = [c for c in captures.captures if c.is_uniform]
    if not every:
        raise ValueError("captures: no darks or flats")
    used: Sequence[Capture] = every
    notes: list[str] = []
    for what in ("ISO", "size", "temperature"):
        used, more = _most_frequent(used, what)
        notes += more
    for split in GROUPS:
        if all(c.group != split for c in used):
            raise ValueError(
                f"no dark or flat is in the group {split}: not enough to fit, select "
                "and report on different frames; add frames"
            )
    divided = any(capture.divided for capture in used)
    if divided:
        notes.append(
            "Darks and flats are divided by columns: no hot pixel is looked for, nor "
            "what moves the mean of a flat, and levels and row noise of training and "
            "validation are those of one frame."
        )
    blocks = Blocks(sensor)
    if saved:
        statistics = saved_statistics(saved, used, sensor, tell)
        if len(every) < len(captures.captures):
            notes.append("Darks of saved statistics: no residual image is looked for.")
    else:
        statistics = statistics_by_split([*map(blocks.watched, used)], sensor, tell)
    spoiled = _spoiled(captures.captures, used, blocks, least, notes)
    if spoiled:
        used = [c for c in used if c not in spoiled]
        statistics = statistics_by_split(used, sensor, tell)
    iso = used[0].iso if sensor.noise else None
    parameters = Parameters(len(statistics.planes))
    profile = profile_values(sensor, iso, parameters)
    has_noise = iso is not None
    well = full_well(statistics, GROUPS[:2], profile, has_noise, least)
    rest = _below(well, statistics, used) if well is not None else []
    if well is not None and rest:
        notes.append(
            f"{plural(len(used) - len(rest), 'flat')} in which wells are full, at "
            f"{well.level:.0f} DN above black, are in no other number."
        )
        used, statistics = rest, statistics_by_split(rest, sensor, tell)
    else:
        well = None
    if not divided:
        notes += lines_apart(statistics, used)
    if not has_noise:  # that of the frames
        theta = fit(statistics.of_splits(GROUPS[:2]), profile).theta
        for name in ("read_noise", "gain"):
            profile[parameters.each(name)] = theta[parameters.each(name)]
    return UniformFrames(used, statistics, profile, has_noise, notes, spoiled, well)


def _most_frequent(
    captures: Sequence[Capture], what: str
) -> tuple[Sequence[Capture], list[str]]:
    """Return the captures of the most frequent ISO, size or temperature, and a note on
    others."""
    keys: list[Any] = [c.shape if what == "size" else c.iso for c in captures]
    if what == "temperature":
        keys = list(set_points([c.temperature for c in captures]))
    main = max(dict.fromkeys(keys), key=keys.count)
    used = [c for c, key in zip(captures, keys, strict=True) if key == main]
    if (count := len(captures) - len(used)) == 0:
        return used, []
    frames = plural(count, "frame")
    return used, [f"{frames} of another {what} left out of the darks and flats."]


def _spoiled(
    captures: Sequence[Capture],
    used: Sequence[Capture],
    blocks: Blocks,
    least: float,
    notes: list[str],
) -> list[Capture]:
    """Return the darks that have a residual image, of which notes are taken; none where
    a split would have no other dark."""
    darks = [c for c in used if c.name in blocks.means]
    found = residual_images(captures, darks, blocks, least)
    names = {one.dark for one in found}
    splits = {c.group for c in darks}
    may_go = splits == {c.group for c in darks if c.name not in names}
    fate = "left out" if may_go else "kept, since its group has no other dark"
    notes += [f"{one}: {fate}." for one in found]
    return [c for c in darks if c.name in names] if may_go else []


def _below(
    well: FullWell, statistics: ConstantStatistics, captures: Sequence[Capture]
) -> list[Capture]:
    """Return the captures in which no well is full; none where a split would have
    none: then light brings less noise everywhere, and that is no well."""
    full = {name for g in well.groups for name in statistics.groups[g].frames}
    rest = [capture for capture in captures if capture.name not in full]
    splits = {capture.group for capture in captures}
    return rest if {capture.group for capture in rest} == splits else []


def lines_apart(
    statistics: ConstantStatistics, captures: Sequence[Capture]
) -> Iterator[str]:
    """Yield a sentence on rows, and on columns, that are as a whole so far from the
    others that no pattern has them, with their places; none of those that a capture's
    own mask leaves out."""
    masked = statistics.masked(captures[0].shape)
    counted = [capture.mask() for capture in captures if capture.mask is not None]
    known = np.all(counted, axis=0) if counted else np.ones(masked.shape, bool)
    for axis, line in ((1, "row"), (0, "column")):
        apart = masked.all(axis=axis) & known.any(axis=axis)
        if (places := np.flatnonzero(apart)).size:
            listed = ", ".join(map(str, places[:MOST_LISTED]))
            more = ", ..." if places.size > MOST_LISTED else ""
            yield (
                f"{plural(places.size, line)} far from the others, set apart and no "
                f"effect: {line} {listed}{more}."
            )
