# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Statistics of darks and flats, all splits under one mask: of their frames, or of a
file that was written when the frames were the same."""

import hashlib
import json
import os
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.frames import by_level
from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import Capture, Group
from cg2raw.diagnose.captures.splits import GROUPS, third_of_columns
from cg2raw.sensor import Sensor
from cg2raw.statistics.constant import ConstantStatistics, GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics
from cg2raw.statistics.kept import Kept, Reader
from cg2raw.statistics.temperature import warmth_of_readings

Progress = Callable[[float], None]


def saved_statistics(
    path: str | os.PathLike[str],
    captures: Sequence[Capture],
    sensor: Sensor,
    progress: Progress | None = None,
) -> ConstantStatistics:
    """Return the statistics that a file keeps, which is written if it is not there.

    Raises OSError, and ValueError for a file of other frames, or of anything else."""
    facts = {capture.name: _facts(capture) for capture in captures}
    facts["the sensor"] = json.dumps([repeat_of(sensor.cfa), sensor.white_level])
    if os.path.exists(path):
        return ConstantStatistics.load(path, facts)
    found = statistics_by_split(captures, sensor, progress)
    found.save(path, facts)
    return found


def _facts(capture: Capture) -> str:
    """Return what statistics depend on, and whether a file's bytes are the same. Raises
    ValueError for a capture of no file."""
    if not capture.digest:
        raise ValueError(
            f"{capture.name}: is of no file, by which it is known whether saved "
            "statistics are of it: leave them out"
        )
    mask = capture.mask().tobytes() if capture.mask else b""
    of_all = (
        capture.digest,
        capture.kind,
        capture.group,
        capture.exposure_time,
        capture.temperature,
        _light_of(capture),
        capture.divided,
        hashlib.sha256(mask).hexdigest(),
    )
    return json.dumps(of_all)


def _light_of(capture: Capture) -> tuple[float, ...]:
    """Return the radiance of a flat; nothing where it is not known, and of darks."""
    if not capture.shows.light or capture.scene is None:
        return ()
    return tuple(np.ravel(capture.scene()).tolist())


def statistics_by_split(
    captures: Sequence[Capture], sensor: Sensor, progress: Progress | None
) -> ConstantStatistics:
    """Return the statistics of darks and flats. Flats of unknown light repeat each
    other if their levels are alike. Where some are divided by pixels, each split has a
    third of the columns of all.

    progress : is called with the share that is done."""
    keys: dict[tuple[object, ...], list[Capture]] = {}
    for capture in captures:
        key = (
            capture.group,
            capture.kind,
            capture.exposure_time,
            _light_of(capture),
        )
        keys.setdefault(key, []).append(capture)
    side, kept = repeat_of(sensor.cfa), Kept()
    whole = {id(capture): kept.reader(capture.raw) for capture in captures}
    columns: dict[Group, NDArray[np.intp]] = {}
    if any(capture.divided for capture in captures):
        width = captures[0].shape[1]
        columns = {group: third_of_columns(width, group, side) for group in GROUPS}

    height, width = (n // side * side for n in captures[0].shape)

    def reader_of(capture: Capture) -> Reader:
        """Of whole repeats of the CFA, so that all planes are of one size."""
        if not columns and (height, width) == capture.shape[:2]:
            return whole[id(capture)]
        own = columns[capture.group] if columns else slice(0, width)
        return lambda: np.ascontiguousarray(whole[id(capture)]()[:height, own])

    read = {id(capture): reader_of(capture) for capture in captures}
    factors, error = warmth_of_readings([capture.temperature for capture in captures])
    warmth = {id(capture): by for capture, by in zip(captures, factors, strict=True)}
    groups = []
    for members in keys.values():
        parts = [members]
        if members[0].scene is None:
            levels = [float(read[id(c)]()[::8, ::8].mean()) for c in members]
            parts = by_level(members, levels)
        for part in parts:
            info = GroupInfo(
                "flat" if part[0].shows.light else "dark",
                tuple(capture.name for capture in part),
                part[0].exposure_time,
                part[0].temperature,
                part[0].group,
                tuple(warmth[id(capture)] for capture in part),
                error,
            )
            groups.append((info, [read[id(capture)] for capture in part]))
    masks = [capture.mask() for capture in captures if capture.mask is not None]
    excluded: NDArray[np.bool_] | None = None
    if masks:
        counted = np.any(masks, axis=0)[:height, :width]
        parts_of = columns.values() if columns else [np.arange(width)]
        excluded = np.any([~counted[:, own] for own in parts_of], axis=0)
    return frame_statistics(
        groups, side, sensor.white_level, excluded=excluded, progress=progress
    )
