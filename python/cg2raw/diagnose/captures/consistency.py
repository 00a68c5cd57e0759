# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whether the frames of a manifest belong together, and what they cannot show."""

import hashlib
import os
from collections.abc import Sequence

import numpy as np

from cg2raw.cfa import is_mono, repeat_of
from cg2raw.diagnose.captures.capture import Capture
from cg2raw.diagnose.captures.chart_table import TableFile
from cg2raw.diagnose.captures.manifest import UNKNOWN, Frame, FrameEntry
from cg2raw.diagnose.captures.scene_files import has_curve, image_size, size_words
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.captures.yaml_lines import Value
from cg2raw.io.raw_checks import (
    SAME_GAIN,
    check_sensor,
    first_unlike,
    some,
    together,
)
from cg2raw.io.raw_header import RawFile, RawHeader
from cg2raw.sensor import Sensor

CHUNK = 1 << 20  # bytes
LEAST_SIDE = 4  # pixels of a frame; residuals are seen in cells of so many a side
# Dark current doubles every 5 to 7 degrees: 1.5 make it 16 to 23 % more. Source: R.
# Widenhorn et al., Proc. SPIE 4669, 2002, for what it doubles by in CCDs.
SAME_TEMPERATURE = 1.5  # degrees Celsius


def digests_of(entries: Sequence[FrameEntry]) -> list[str]:
    """Return the hash of each file. Raises ValueError if one is there twice, by its
    path or by its content."""
    found = [digest(entry.file) for entry in entries]
    seen: dict[str, FrameEntry] = {}
    for entry, of_file in zip(entries, found, strict=True):
        for key in (os.path.realpath(entry.file), of_file):
            first = seen.setdefault(key, entry)
            if first is entry:
                continue
            words = (
                "is" if os.path.samefile(first.file, entry.file) else "has the bytes of"
            )
            entry.fail(
                "file",
                f'"{entry.file}" {words} that of line {first.at["file"].line}; a frame '
                "counts once: remove one",
            )
    return found


def digest(path: str) -> str:
    """Return the hash of a file's bytes."""
    with open(path, "rb") as file:
        whole = hashlib.sha256()
        while part := file.read(CHUNK):
            whole.update(part)
    return whole.hexdigest()


def check_sizes(
    entries: Sequence[FrameEntry], files: Sequence[RawFile], sensor: Sensor
) -> tuple[int, int] | None:
    """Return (H, W) of all frames that have pixels; None if none has. Raises
    ValueError if one has another size than the first, or too small a one."""
    least = max(LEAST_SIDE, repeat_of(sensor.cfa))
    first: RawHeader | None = None
    for entry, file in zip(entries, files, strict=True):
        if isinstance(file, TableFile):
            continue
        header = file.header
        first = first or header
        if min(header.shape) < least:
            entry.fail(
                "file",
                f"{header.name} is {size_words(header.shape)}; frames must be at least "
                f"{least} pixels wide and high",
            )
        if header.shape != first.shape:
            entry.fail(
                "file",
                f"{header.name} is {size_words(header.shape)}, {first.name} "
                f"{size_words(first.shape)}; all frames must have one size",
            )
    return first.shape if first else None


def sensor_notes(entry: FrameEntry, file: RawFile, sensor: Sensor) -> list[str]:
    """Return check_sensor's notes. Raises ValueError at the frame's line."""
    if isinstance(file, TableFile):
        return list(file.header.notes)
    try:
        return check_sensor(file.header, sensor)
    except ValueError as error:
        entry.fail("file", f"{error}")


def check_settings(frames: Sequence[Frame]) -> None:
    """Raise ValueError for a frame whose header states another gain, offset, mode or
    camera than that of another frame of its ISO."""
    by_iso: dict[float | None, list[Frame]] = {}
    for frame in frames:
        if frame.capture.means is None:
            by_iso.setdefault(frame.capture.iso, []).append(frame)
    for ours in by_iso.values():
        if found := first_unlike([frame.header for frame in ours]):
            ours[found[0]].entry.fail("file", found[1])


def names_of(entries: Sequence[FrameEntry]) -> list[str]:
    """Return the file names; as the manifest has them where two would be the same."""
    names = [os.path.basename(entry.file) for entry in entries]
    return [
        name if names.count(name) == 1 else entry.at["file"].text()
        for name, entry in zip(names, entries, strict=True)
    ]


def check_image(value: Value, path: str, shape: tuple[int, int]) -> None:
    """Raise ValueError at its line unless a render or mask has the frames' size."""
    try:
        size = image_size(path)
    except (ValueError, OSError) as error:
        value.fail(f"cannot be used: {error}")
    if size != shape:
        value.fail(
            f"{os.path.basename(path)} is {size_words(size)}, the frames are "
            f"{size_words(shape)}; it must be the active area pixel by pixel"
        )


def check_sets(frames: Sequence[Frame]) -> None:
    """Raise ValueError for a set of several kinds or groups."""
    first: dict[str, Frame] = {}
    group: dict[str, FrameEntry] = {}
    for frame in frames:
        capture, entry = frame.capture, frame.entry
        other = first.setdefault(capture.set, frame)
        if other.capture.kind != capture.kind:
            entry.fail(
                "set",
                f'"{capture.set}" holds a {capture.kind} here and a '
                f"{other.capture.kind} in line {other.entry.at[''].line}; frames of a "
                "set repeat the same light: use two names",
            )
        if entry.group:
            said = group.setdefault(capture.set, entry)
            if said.group != entry.group:
                entry.fail(
                    "group",
                    f'is "{entry.group}", but that of set "{capture.set}" in line '
                    f'{said.at["group"].line} is "{said.group}"; a set has one group',
                )


def check_groups(frames: Sequence[Frame], captures: Sequence[Capture]) -> None:
    """Raise ValueError if a group has no frame."""
    for group in GROUPS:
        if not any(capture.group == group for capture in captures):
            declared = next(frame.entry for frame in frames if frame.entry.group)
            declared.fail(
                "group",
                f'leaves no frame for the group "{group}": give one to each of '
                f"{', '.join(GROUPS)}, or leave group out",
            )


def notes_on(frames: Sequence[Frame], sensor: Sensor) -> list[str]:
    """Return sentences on what is assumed of the frames."""
    with_pixels = [frame.capture for frame in frames if frame.capture.means is None]
    notes = []
    without = [f.capture.name for f in frames if f.capture.iso is None]
    if sensor.noise and without:
        notes.append(
            f"{some(without)}: neither manifest nor file says the ISO, which chooses "
            "the noise; add iso"
        )
    notes += together((f.capture.name, iso_notes(f)) for f in frames)
    notes += [*gain_notes(frames, sensor), *temperature_notes(frames)]
    shown = [capture for capture in with_pixels if capture.shows.image]
    charts = [capture.name for capture in shown if not capture.shows.render]
    if charts:
        notes.append(
            f"{some(charts)}: the surround of the patches is taken to have their "
            "mean radiance; veiling glare depends on it"
        )
    renders = [f.entry for f in frames if f.entry.linearize != "none"]
    scenes = dict.fromkeys(entry.scene for entry in renders)
    paths = [scene for scene in scenes if isinstance(scene, str) and scene != UNKNOWN]
    notes += [
        f"{os.path.basename(path)}: whole numbers, linearised by the curve that the "
        "file or linearize states"
        for path in paths
        if has_curve(path)
    ]
    return notes


def iso_notes(frame: Frame) -> list[str]:
    """Return a sentence on a file that states another ISO than the manifest."""
    stated, given = frame.header.iso, frame.entry.iso
    if not stated or given in (None, stated):
        return []
    return [f"the file says ISO {stated:g}, the manifest {given:g}, which is used"]


def gain_notes(frames: Sequence[Frame], sensor: Sensor) -> list[str]:
    """Return sentences on headers whose gain is not that of the profile's noise."""
    said: list[tuple[str, list[str]]] = []
    for frame in frames:
        told, iso = frame.header.electrons_per_dn, frame.capture.iso
        if told is None or iso is None or not sensor.noise:
            continue
        known = 1 / dn_per_electron(sensor, iso)
        if abs(told / known - 1) > SAME_GAIN:
            words = (
                f"headers say {told:.3g} electrons per DN, the noise of {sensor.id} at "
                f"ISO {iso:g} {known:.3g}; the profile's is used, since it is tested"
            )
            said.append((frame.capture.name, [words]))
    return together(said)


def dn_per_electron(sensor: Sensor, iso: float) -> float:
    """Return the system gain that a profile's noise states."""
    return float(np.mean(sensor.noise_at(iso)["beta1"])) * sensor.signal_range


def temperature_notes(frames: Sequence[Frame]) -> list[str]:
    """Return a sentence on sensors that were warmer in some frames than in others."""
    known = [f.capture for f in frames if f.capture.temperature is not None]
    if not known:
        return []
    by_degrees = sorted(known, key=lambda capture: capture.temperature or 0.0)
    coldest, warmest = by_degrees[0], by_degrees[-1]
    low, high = coldest.temperature or 0.0, warmest.temperature or 0.0
    if high - low <= SAME_TEMPERATURE:
        return []
    least, most = (2 ** ((high - low) / doubling) for doubling in (7, 5))
    return [
        f"the sensor was at {low:g} C in {coldest.name} and at {high:g} C in "
        f"{warmest.name}: dark current, which doubles every 5 to 7 C, is {least:.3g} "
        f"to {most:.3g} times as large there"
    ]


def what_is_missing(frames: Sequence[Frame], sensor: Sensor) -> list[str]:
    """Return sentences on what no diagnosis of these frames can tell apart."""
    of_light, of_scenes = "gain, optics, colour", "colour matrix, blur, aberration"
    if is_mono(sensor.cfa):
        of_light, of_scenes = "gain, optics", "blur"
    captures = [capture for f in frames for capture in (f.capture, *f.borders)]
    darks = [capture for capture in captures if not capture.shows.light]
    if len(darks) == len(captures):
        return [
            f"only darks: {of_light} and all else that needs light cannot be told; add "
            "flats at two levels, and scenes with their renders"
        ]
    notes = []
    if len(frames) == 1:
        notes.append(
            "one frame only: fixed patterns cannot be told from noise; add repeats"
        )
    if not darks:
        notes.append(
            "no darks: black level and dark current cannot be told from glare; add "
            "darks of two exposure times"
        )
    elif len({capture.exposure_time for capture in darks}) == 1:
        notes.append(
            "darks of one exposure time: dark current cannot be told from black level; "
            "add darks of another"
        )
    images = [capture for capture in captures if capture.shows.image]
    if images:
        return notes + _missing_of_images(images)
    notes.append(
        f"no scenes: {of_scenes}, crosstalk and glare cannot be told; add scenes with "
        "their renders, or a chart"
    )
    flats = [f.entry for f in frames if f.capture.shows.light]
    if len({(e.scene, e.gain) for e in flats}) == 1 and flats[0].scene != UNKNOWN:
        notes.append(
            "flats of one level: non-linearity cannot be told from exposure, nor PRNU "
            "from shot noise; add flats of another"
        )
    return notes


def _missing_of_images(images: Sequence[Capture]) -> list[str]:
    if any(capture.means is None for capture in images):
        return []
    return [
        "patch means alone: noise, fixed patterns, shading, blur, crosstalk and glare "
        "cannot be told from them; add flats, and scenes or charts as frames"
    ]
