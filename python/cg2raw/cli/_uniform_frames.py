# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files and folders of darks and flats become UniformFrames."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cg2raw.calibration import UniformFrame
from cg2raw.io.raw_header import RawFile, RawHeader
from cg2raw.sensor import Sensor
from cg2raw.statistics.kept import Kept

Kind = Literal["dark", "flat"]
NO_FRAMES = (".csv", ".json", ".md", ".txt", ".yaml", ".yml", ".xmp", ".jpg")
PREVIEW = ".png"  # of a folder's other files, if there are any; else a frame
# Of white above black: a dark lies below the first, a flat above the second.
DARK, LIT = 0.01, 0.03


@dataclass(frozen=True)
class Said:
    """What is said of frames besides what their files say; None: nothing."""

    exposure_time: float | None = None
    iso: float | None = None
    temperature: float | None = None
    kind: Kind | None = None


def sensor_of(word: str) -> Sensor:
    """Return the sensor of an id, a profile (.json) or a DNG. Raises ValueError."""
    return Sensor.from_dng(word) if word.lower().endswith(".dng") else Sensor(word)


def files_in(paths: Sequence[str]) -> list[str]:
    """Return files, those of folders by name. Raises ValueError for an empty one."""
    found: list[str] = []
    for path in paths:
        if not os.path.isdir(path):
            found.append(path)
            continue
        inside = [
            os.path.join(path, name)
            for name in sorted(os.listdir(path))
            if not name.startswith(".") and not name.lower().endswith(NO_FRAMES)
        ]
        files = [name for name in inside if not os.path.isdir(name)]
        if not files:
            raise ValueError(f"{path}: holds no frames")
        pictures = [name for name in files if name.lower().endswith(PREVIEW)]
        found += [name for name in files if name not in pictures] or pictures
    repeats = {os.path.realpath(path): path for path in reversed(found)}
    return list(reversed(repeats.values()))


def uniform_frame(
    file: RawFile, sensor: Sensor, table: dict[str, Said], given: Said, kept: Kept
) -> UniformFrame:
    """Return a RAW frame as a dark or a flat.

    table : says of frames by name what their files do not. given : of all, where
    neither does; its kind goes before. kept : keeps its pixels.
    Raises ValueError, OSError."""
    header = file.header
    said = Said(header.exposure_time, header.iso, header.temperature)
    rows = [table[name] for name in names_of(header) if name in table]
    for more in (*rows[:1], given):
        said = merged(said, more)
    frame = UniformFrame(
        header.name,
        "dark",
        kept.reader(lambda: file.mosaic(sensor=sensor)),
        said.exposure_time,
        said.iso,
        said.temperature,
    )
    return replace(frame, kind=given.kind or said.kind or kind_of(frame, sensor))


def names_of(header: RawHeader) -> tuple[str, ...]:
    """Return what a table may call a frame; a file's name is that of all in it."""
    base = os.path.basename(header.path)
    return header.name, os.path.splitext(header.name)[0], base


def merged(said: Said, more: Said | None) -> Said:
    """Return what is said, and of the rest what is said elsewhere."""
    fields = vars(said)
    others = vars(more or Said())
    return Said(**{k: others[k] if v is None else v for k, v in fields.items()})


def kind_of(frame: UniformFrame, sensor: Sensor) -> Kind:
    """Return what a frame is by its exposure and level. Raises ValueError in doubt."""
    if frame.exposure_time == 0:
        return "dark"
    black = float(np.mean(sensor.black_level))
    level = float(np.median(frame.pixels()[::5, ::5])) - black
    share = level / (sensor.white_level - black)
    if share < DARK:
        return "dark"
    if share > LIT:
        return "flat"
    raise ValueError(
        f"{frame.name}: its level is {share:.1%} of white: a long dark or a faint "
        "flat? Say it: --darks FILES or --flats FILES"
    )
