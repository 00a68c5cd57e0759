# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""captures.yaml and its files become a CaptureSet."""

import os
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.cfa import is_mono
from cg2raw.diagnose.captures import consistency
from cg2raw.diagnose.captures.capture import KINDS, Capture, CaptureSet, Group
from cg2raw.diagnose.captures.chart import ColorChecker, PatchChart
from cg2raw.diagnose.captures.chart_table import TableFile, table_file
from cg2raw.diagnose.captures.manifest import (
    UNKNOWN,
    Frame,
    FrameEntry,
    Manifest,
    read_manifest,
)
from cg2raw.diagnose.captures.scene_files import Mask, read_mask, read_scene, uniform
from cg2raw.diagnose.captures.splits import GROUPS, groups_of_sets, third
from cg2raw.io.raw_checks import together
from cg2raw.io.raw_file import open_raw
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from cg2raw.sensor import Sensor

LIGHT_OF_DARKS = "D65"  # any: there is none, or no filter that tells it from others
DIVIDED_TABLES = (
    "patch means are divided by patches, a third each to fit, select and report, if "
    "they have no group: the errors of a chart's colours are the same in all its frames"
)
PROFILE_ENDINGS = (".json", ".dng")


def read_captures(
    path: str | os.PathLike[str], sensor: Sensor | None = None
) -> CaptureSet:
    """Return the checked captures of a manifest; their pixels are not read yet.

    sensor : in place of the manifest's.

    Sets are divided into fit, select and report, kind by kind: a set whose frames say
    their group keeps it, the others take turns. Of a kind with fewer than three sets
    the frames are divided by pixels instead, into three captures with disjoint masks.

    Raises ValueError naming file, line, field, value and what is allowed; OSError."""
    manifest, sensor, frames, notes = read_frames(path, sensor)
    captures, more = divided(frames)
    return CaptureSet(
        sensor=sensor,
        captures=captures,
        nuisances=manifest.nuisances,
        uncertainty=manifest.uncertainty,
        file=manifest.file,
        notes=(*notes, *more, *consistency.what_is_missing(frames, sensor)),
    )


def read_frames(
    path: str | os.PathLike[str], sensor: Sensor | None = None
) -> tuple[Manifest, Sensor, list[Frame], list[str]]:
    """Return (manifest, sensor, frames before they are divided, notes)."""
    manifest = read_manifest(path)
    sensor = sensor or sensor_of(manifest)
    check_nuisances(manifest, sensor)
    digests = consistency.digests_of(manifest.frames)
    files = [file_of(entry, sensor) for entry in manifest.frames]
    shape = consistency.check_sizes(manifest.frames, files, sensor)
    if manifest.mask and shape:
        consistency.check_image(manifest.at["mask"], manifest.mask, shape)
    names = consistency.names_of(manifest.frames)
    said = [
        (name, consistency.sensor_notes(entry, file, sensor))
        for entry, file, name in zip(manifest.frames, files, names, strict=True)
    ]
    frames = [
        frame_of(manifest, sensor, *item)
        for item in zip(manifest.frames, files, names, digests, strict=True)
    ]
    consistency.check_settings(frames)
    notes = together(said)
    return manifest, sensor, frames, notes + consistency.notes_on(frames, sensor)


def check_nuisances(manifest: Manifest, sensor: Sensor) -> None:
    """Raise ValueError at its line for a nuisance that the sensor cannot have."""
    if is_mono(sensor.cfa) and "white_balance" in manifest.nuisances:
        manifest.at["nuisance"].fail(
            f"has white_balance, and {sensor.id} is monochrome: remove it; exposure is "
            "what differs"
        )


def sensor_of(manifest: Manifest) -> Sensor:
    """Return the manifest's sensor: a profile's id or path, or a DNG's metadata."""
    word = manifest.at["sensor"].text()
    is_path = os.path.dirname(word) != "" or word.lower().endswith(PROFILE_ENDINGS)
    path = os.path.join(manifest.folder, word) if is_path else word
    try:
        if path.lower().endswith(".dng"):
            return Sensor.from_dng(path)
        return Sensor(path)
    except (ValueError, OSError) as error:
        manifest.at["sensor"].fail(f'is "{word}": {error}')


def file_of(entry: FrameEntry, sensor: Sensor) -> RawFile:
    """Return a frame's file, or its table of patch means. Raises ValueError at its
    line."""
    if entry.means is not None:
        return table_file(entry, sensor)
    try:
        return open_raw(entry.file, entry.image)
    except (ValueError, OSError) as error:
        entry.fail("file", f"cannot be used: {error}")


def frame_of(
    manifest: Manifest,
    sensor: Sensor,
    entry: FrameEntry,
    file: RawFile,
    name: str,
    digest: str,
) -> Frame:
    """Return one frame. Raises ValueError at its line."""
    header = file.header
    capture = Capture(
        name=name,
        kind=entry.kind,
        shape=header.shape,
        group="fit",
        set=entry.set or name,
        illuminant=illuminant_of(entry, header, sensor),
        iso=iso_of(entry, header, sensor),
        exposure_time=(
            header.exposure_time if entry.exposure_time is None else entry.exposure_time
        ),
        raw=lambda: file.mosaic(sensor=sensor),
        scene=None,
        means=file.means if isinstance(file, TableFile) else None,
        mask=None,
        as_shot=header.as_shot,
        temperature=(
            header.temperature if entry.temperature is None else entry.temperature
        ),
        digest=f"{digest} {entry.image or ''}",
    )
    if capture.means is not None:
        return Frame(entry, header, capture, ())
    scene, middles = scene_of(entry, header.shape)
    mask = mask_of(manifest, entry, header.shape, middles)
    capture = replace(capture, scene=scene, mask=mask)
    return Frame(entry, header, capture, borders_of(capture, file, sensor))


def borders_of(capture: Capture, file: RawFile, sensor: Sensor) -> tuple[Capture, ...]:
    """Return a dark of each masked border of a frame."""

    def border(area: Area) -> Capture:
        name = f"{capture.name} (masked {area.name})"
        return replace(
            capture,
            name=name,
            kind="dark",
            shape=(area.height, area.width),
            set=name,
            raw=lambda: file.mosaic(area, sensor),
            scene=dark,
            mask=None,
        )

    return tuple(border(area) for area in file.header.borders)


def dark() -> NDArray[np.float32]:
    """Return the scene of a dark."""
    return np.zeros(3, np.float32)


def illuminant_of(entry: FrameEntry, header: RawHeader, sensor: Sensor) -> str:
    """Return the word of a frame's light. Raises ValueError at its line."""
    word = entry.illuminant
    if word is None and (is_mono(sensor.cfa) or not KINDS[entry.kind].light):
        return LIGHT_OF_DARKS
    if word is None and header.as_shot is None:
        entry.fail(
            "",
            f"has no illuminant, and {os.path.basename(entry.file)} no as-shot white "
            f"balance: add illuminant, one of {_core.illuminant_grammar}",
        )
    word = word or "as-shot"
    try:
        sensor.illuminant(word, header.as_shot)
    except ValueError as error:
        entry.fail("illuminant", f'is "{word}": {error}')
    return word


def iso_of(entry: FrameEntry, header: RawHeader, sensor: Sensor) -> float | None:
    """Return a frame's ISO: the manifest's, else the file's. Raises ValueError."""
    iso = header.iso if entry.iso is None else entry.iso
    if iso is not None and sensor.noise:
        try:
            sensor.noise_at(iso)
        except ValueError as error:
            name = os.path.basename(entry.file)
            entry.fail("iso", f"{iso:g}, of {name}: {error}")
    return iso


def scene_of(
    entry: FrameEntry, shape: tuple[int, int]
) -> tuple[Callable[[], FloatImage] | None, Callable[[], Mask] | None]:
    """Return (scene, mask of a chart's patches); None where there is none."""
    if not KINDS[entry.kind].light:
        return dark, None
    if "patches" in KINDS[entry.kind].fields:
        try:
            chart = (
                PatchChart(entry.patches, shape, entry.gain)
                if entry.patches
                else ColorChecker(entry.corners, shape, entry.gain)
            )
        except ValueError as error:
            entry.fail("", f"{error}")
        return chart.scene, chart.mask
    if isinstance(entry.scene, tuple):
        return uniform(entry.scene, entry.gain), None
    if entry.scene == UNKNOWN or entry.scene is None:
        return None, None
    path = entry.scene
    consistency.check_image(entry.at["scene"], path, shape)
    return lambda: read_scene(path, entry.gain, entry.linearize), None


def mask_of(
    manifest: Manifest,
    entry: FrameEntry,
    shape: tuple[int, int],
    middles: Callable[[], Mask] | None,
) -> Callable[[], NDArray[np.bool_]] | None:
    """Return all of a frame's masks as one; None if there is none."""
    if entry.mask:
        consistency.check_image(entry.at["mask"], entry.mask, shape)
    paths = [path for path in (manifest.mask, entry.mask) if path]
    if not paths and middles is None:
        return None

    def mask() -> NDArray[np.bool_]:
        parts = [read_mask(path, shape) for path in paths]
        parts += [middles()] if middles else []
        together: NDArray[np.bool_] = np.logical_and.reduce(parts)
        return together

    return mask


def divided(frames: Sequence[Frame]) -> tuple[list[Capture], list[str]]:
    """Return (captures with their groups, notes). Raises ValueError."""
    consistency.check_sets(frames)
    groups: dict[str, Group | None] = {}
    notes = []
    tables = [frame for frame in frames if frame.capture.means is not None]
    if tables:
        groups |= {table.capture.name: table.entry.group for table in tables}
        notes.append(DIVIDED_TABLES)
    with_pixels = [frame for frame in frames if frame.capture.means is None]
    for kind in dict.fromkeys(frame.capture.kind for frame in with_pixels):
        ours = [frame for frame in with_pixels if frame.capture.kind == kind]
        unit = _what_stays_together(ours)
        strata = {unit(frame): stratum(frame) for frame in reversed(ours)}
        strata = {unit(frame): strata[unit(frame)] for frame in ours}
        said = {f.capture.set: f.entry.group for f in ours if f.entry.group}
        declared = {unit(f): said[f.capture.set] for f in ours if f.capture.set in said}
        found = groups_of_sets(strata, declared)
        why = f"{len(strata)} of the three sets that groups need"
        if not declared and _lack_times(ours, [found[unit(f)] for f in ours]):
            found = dict.fromkeys(found)
            why = "the frames that fit would have one exposure time alone"
        groups |= {frame.capture.name: found[unit(frame)] for frame in ours}
        if None in found.values():
            notes.append(
                f"{kind}: {why}, so these frames are divided by pixels, a third each "
                "to fit, select and report; what a frame's pixels share is then in all "
                "three"
            )
    captures: list[Capture] = []
    for frame in frames:
        for capture in (frame.capture, *frame.borders):
            captures += in_groups(capture, groups[frame.capture.name])
    consistency.check_groups(frames, captures)
    return captures, notes


def _what_stays_together(frames: Sequence[Frame]) -> Callable[[Frame], str]:
    """Return which frames of a kind are of one group: those of a set; each for itself
    where sets are too few and frames have no image, whose pixels only other frames
    tell from noise."""
    sets = {frame.capture.set for frame in frames}
    if len(sets) >= len(GROUPS) or any(f.capture.shows.image for f in frames):
        return lambda frame: frame.capture.set
    return lambda frame: frame.capture.name


def _lack_times(frames: Sequence[Frame], groups: Sequence[Group | None]) -> bool:
    """Return whether darks differ in their exposure times, and the group that fits has
    one of these alone, which does not tell charge from offsets."""
    if any(frame.capture.shows.light for frame in frames):
        return False
    pairs = list(zip(frames, groups, strict=True))
    times = {frame.capture.exposure_time for frame in frames}
    fitted = {f.capture.exposure_time for f, group in pairs if group in ("fit", None)}
    return len(times) > 1 and len(fitted) == 1


def stratum(frame: Frame) -> tuple[float, ...]:
    """Return what sets of a kind are spread by: ISO, exposure time, radiance, and the
    temperature, which comes last since a cooler leaves it to chance."""
    capture, scene = frame.capture, frame.entry.scene
    level = scene[1] * frame.entry.gain if isinstance(scene, tuple) else 0.0
    warm = capture.temperature or 0.0
    return capture.iso or 0.0, capture.exposure_time or 0.0, level, warm


def in_groups(capture: Capture, group: Group | None) -> list[Capture]:
    """Return a capture in its group; three, by pixels, if it has none."""
    if group is not None:
        return [replace(capture, group=group)]

    def part(group: Group) -> Capture:
        def mask() -> NDArray[np.bool_]:
            ours = third(capture.shape, group)
            return ours & capture.mask() if capture.mask else ours

        if capture.means is not None:
            means = capture.means.part(GROUPS.index(group), len(GROUPS))
            name, shape = f"{capture.name} ({group} patches)", means.mean.shape
            return replace(capture, name=name, group=group, means=means, shape=shape)
        name = f"{capture.name} ({group} pixels)".replace(") (", ", ")
        return replace(capture, name=name, group=group, mask=mask, divided=True)

    return [part(group) for group in GROUPS]
