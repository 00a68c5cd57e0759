# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whether RAW frames are of their sensor and of one setting, by their headers."""

from collections.abc import Iterable, Sequence

import numpy as np

from cg2raw.io.raw_header import RawHeader
from cg2raw.sensor import Sensor

MOST_NAMES = 3  # of files in a note
SAME_GAIN = 0.05  # relative difference of a header's gain and another


def check_sensor(header: RawHeader, sensor: Sensor) -> list[str]:
    """Return the reader's notes, and those on a size or levels that are not quite the
    sensor's, without the file.

    Raises ValueError as check_levels."""
    levels = check_levels(header, sensor)
    notes = list(header.notes)
    (height, width), size = header.shape, (sensor.height, sensor.width)
    if header.shape != size:
        notes.append(
            f"is {width}x{height}, the active area of {sensor.id} is {size[1]}x"
            f"{size[0]}: the optical centre is taken to be that of the frame"
        )
    return notes + levels


def check_levels(header: RawHeader, sensor: Sensor) -> list[str]:
    """Return notes on levels that are not quite the sensor's, without the file.

    Raises ValueError for another CFA, bit depth or scale of DN, with both values."""
    for what, ours, theirs in (
        ("CFA", header.cfa, sensor.cfa),
        ("bit depth", header.bits, sensor.bits),
    ):
        if ours is not None and ours != theirs:
            raise ValueError(
                f"{header.name}: its {what} is {ours}, that of {sensor.id} {theirs}; "
                "give frames of this sensor, or the sensor of these frames"
            )
    notes: list[str] = []
    if header.white_level is None or header.black_level is None:
        return notes
    black = float(np.mean(sensor.black_level))
    span = sensor.white_level - black
    for what, read, model, most in (
        ("black level", float(np.mean(header.black_level)), black, 0.02),
        ("white level", header.white_level, sensor.white_level, 0.05),
    ):
        words = f"tags say {what} {read:g} DN, {sensor.id} {model:g} DN"
        if abs(read - model) > most * span:
            raise ValueError(
                f"{header.name}: {words}; they differ by more than {most:.0%} of the "
                "range: give the sensor of these frames"
            )
        if abs(read - model) > 1e-6 * span:
            notes.append(f"{words}; the profile's is used, since it is what is tested")
    return notes


def first_unlike(headers: Sequence[RawHeader]) -> tuple[int, str] | None:
    """Return (index, sentence) of the first frame with a setting that is not that of a
    frame before it; None if all are alike."""
    stated: dict[str, RawHeader] = {}
    for index, header in enumerate(headers):
        for name, value in header.settings.items():
            first = stated.setdefault(name, header)
            if first.settings[name] != value:
                return index, (
                    f"{header.where}: its {name} is {value}, that of {first.where} is "
                    f"{first.settings[name]}: a row of noise is of one setting of one "
                    "camera; give frames of one at a time"
                )
    return None


def check_alike(headers: Sequence[RawHeader]) -> None:
    """Raise ValueError for the first frame whose settings are not the others'."""
    if found := first_unlike(headers):
        raise ValueError(found[1])


def together(sentences: Iterable[tuple[str, Iterable[str]]]) -> list[str]:
    """Return sentences on frames, each once, after the names of its frames."""
    names: dict[str, list[str]] = {}
    for name, texts in sentences:
        for text in texts:
            names.setdefault(text, []).append(name)
    return [f"{some(frames)}: {text}" for text, frames in names.items()]


def some(names: Sequence[str]) -> str:
    """Return a few names, and how many more there are."""
    more = len(names) - MOST_NAMES
    few = ", ".join(names[:MOST_NAMES])
    return f"{few} and {more} more" if more > 0 else few
