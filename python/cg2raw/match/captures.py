# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""RAW captures become Frames, each under its own white balance."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cg2raw import _core
from cg2raw.cfa import is_mono
from cg2raw.io.image_file import RAW_ENDINGS
from cg2raw.io.raw_checks import check_levels
from cg2raw.io.raw_file import open_raw
from cg2raw.io.raw_header import RawHeader
from cg2raw.match.frame import Frame, look, neutral_of_all
from cg2raw.sensor import Sensor
from cg2raw.system import check_readable

DEVELOPED = (".jpg", ".jpeg", ".heic", ".heif", ".png", ".tif", ".tiff", ".webp")
REMEDY = "give the camera's own RAW files (.dng, .nef, .cr2, .arw ...)"


@dataclass(frozen=True)
class Capture:
    """A capture's Frame, and what its file says.

    light : word of the illuminant that its neutral is; empty of a sensor without
    filters. stated : whether the file says it; else the mean of the frame is grey."""

    frame: Frame
    light: str
    stated: bool
    iso: float | None
    exposure_time: float | None
    notes: tuple[str, ...]


def captures_in(paths: Sequence[str]) -> list[str]:
    """Return the RAW files among @paths and in folders of them, by name.

    Pictures beside RAW files are left out. Raises ValueError where there is none."""
    found: list[str] = []
    for path in paths:
        if not os.path.isdir(path):
            check_readable(path)
            if path.lower().endswith(DEVELOPED):
                raise ValueError(f"{path}: is a developed picture, not RAW: {REMEDY}")
            found.append(path)
            continue
        inside = list(files_below(path))
        raw = [file for file in inside if file.lower().endswith(RAW_ENDINGS)]
        pictures = [file for file in inside if file.lower().endswith(DEVELOPED)]
        if not raw and pictures:
            name = os.path.relpath(pictures[0], path)
            raise ValueError(
                f"{path}: holds developed pictures ({name}), and no RAW: {REMEDY}"
            )
        if not raw:
            raise ValueError(f"{path}: holds no captures: {REMEDY}")
        found += raw
    return found


def files_below(folder: str, seen: set[str] | None = None) -> Iterator[str]:
    """Yield the files of a folder and of those in it, by name, but hidden ones.

    Each folder is read once, however many links lead to it. seen : those that were, as
    they really lie."""
    seen = set() if seen is None else seen
    real = os.path.realpath(folder)
    if real in seen:
        return
    seen.add(real)
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        if name.startswith("."):
            continue
        if os.path.isdir(path):
            yield from files_below(path, seen)
        else:
            yield path


def read_capture(path: str, sensor: Sensor) -> Capture:
    """Return the Capture at @path. Raises ValueError for a file of another sensor, one
    that holds no mosaic, OSError."""
    file = open_raw(path)
    header = file.header
    check_camera(header, sensor)
    notes = (*header.notes, *check_levels(header, sensor))
    plane = file.mosaic(sensor=sensor)
    neutral = None if is_mono(sensor.cfa) else header.as_shot
    stated = neutral is not None
    if neutral is None and not is_mono(sensor.cfa):
        neutral = neutral_of_all(plane, sensor)
    word = f"neutral:{neutral[0]!r}:{neutral[2]!r}" if neutral else ""
    light = sensor.illuminant(word) if word else None
    return Capture(
        look(header.name, plane, sensor, light),
        word,
        stated,
        header.iso,
        header.exposure_time,
        notes,
    )


def check_camera(header: RawHeader, sensor: Sensor) -> None:
    """Raise ValueError if a file states another camera than the sensor's."""
    if not header.model:
        return
    name = _core.camera_name(header.make, header.model)
    ours = {sensor.unique_camera_model, _core.camera_name(sensor.make, sensor.model)}
    if name.casefold() not in {word.casefold() for word in ours}:
        raise ValueError(
            f"{header.path}: is of a {name}, {sensor.id} is the "
            f"{_core.camera_name(sensor.make, sensor.model)}: give captures of that "
            f"camera, or a profile of this one (cg2raw profile {header.path})"
        )
