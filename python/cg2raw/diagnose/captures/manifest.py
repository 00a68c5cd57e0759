# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""captures.yaml: the captures, their sensor and their scenes, checked line by line."""

import os
from dataclasses import dataclass, field
from typing import NoReturn

from cg2raw.diagnose.captures.capture import KINDS, NUISANCES, Capture, Group, Kind
from cg2raw.diagnose.captures.manifest_charts import (
    MOST_RADIANCE,
    OF_CHARTS,
    MeansEntry,
    Patch,
    check_chart,
    corners_of,
    is_table,
    means_entry,
    patches_of,
)
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.captures.yaml_lines import Value, existing, read_yaml
from cg2raw.io.raw_header import RawHeader

TOP = (
    *("sensor", "frames", "nuisance", "uncertainty", "mask", "iso", "illuminant"),
    *("temperature", "image"),
)
FRAME = (
    *("file", "kind", "scene", "gain", "illuminant", "set", "group", "iso"),
    *("exposure_time", "temperature", "image", "mask", "linearize", *OF_CHARTS),
)
# What the top level may say for all frames.
DEFAULTS: tuple[str, ...] = ("iso", "illuminant", "temperature", "image")
UNCERTAINTY = {"light": 1.0, "radiance": 1.0, "registration": 100.0}  # largest
UNKNOWN = "unknown"
LINEARIZE = ("srgb", "none")
LARGEST_OF_UNIT = {
    "gain": 1e6,
    "radiance": MOST_RADIANCE,
    "iso": 1e7,
    "seconds": 1e6,
    "celsius": 200.0,
}
SHOWN = {"celsius": "degrees Celsius"}  # units that a message has
ABSOLUTE_ZERO = -273.15  # degrees Celsius


@dataclass(frozen=True)
class FrameEntry:
    """One frame of the manifest; paths are complete. None: not said.

    at : the fields that were given, with their lines; "" is the frame itself.
    scene : three numbers, a path, or "unknown"; None for darks and charts.
    linearize : the curve of a render whose file does not state it, "none" or "srgb".
    patches, corners : of a chart with pixels: its rectangles, or the (row, col) of its
        corner patches' centres. means : of a chart that is a table of patch means.
    image : name or number of one of several images in the file, or "all"."""

    at: dict[str, Value]
    file: str
    kind: Kind
    scene: tuple[float, ...] | str | None
    gain: float
    illuminant: str | None
    set: str | None
    group: Group | None
    iso: float | None
    exposure_time: float | None
    temperature: float | None
    mask: str | None
    linearize: str | None = None
    patches: tuple[Patch, ...] = ()
    corners: tuple[tuple[float, ...], ...] = ()
    means: MeansEntry | None = None
    image: str | None = None

    def fail(self, name: str, message: str) -> NoReturn:
        """Raise ValueError at a field of the frame, or at the frame."""
        self.at.get(name, self.at[""]).fail(message)


@dataclass(frozen=True)
class Frame:
    """A frame before it is divided: its Capture, and those of its masked borders."""

    entry: FrameEntry
    header: RawHeader
    capture: Capture
    borders: tuple[Capture, ...]


@dataclass(frozen=True)
class Manifest:
    """All of captures.yaml; paths are complete. at : fields that were given."""

    file: str
    at: dict[str, Value]
    frames: tuple[FrameEntry, ...]
    nuisances: frozenset[str] = frozenset()
    uncertainty: dict[str, float] = field(default_factory=dict)
    mask: str | None = None

    @property
    def folder(self) -> str:
        """What the manifest's paths are relative to."""
        return os.path.dirname(self.file)


def read_manifest(path: str | os.PathLike[str]) -> Manifest:
    """Return the checked manifest; its RAW files are not opened yet.

    Raises ValueError naming file, line, field, value and what is allowed; OSError."""
    root = read_yaml(path)
    top = root.fields(TOP, required=("sensor", "frames"))
    entries = [frame_entry(value, top, path) for value in top["frames"].items()]
    if not entries:
        top["frames"].fail("has no frame; add at least one")
    nuisances = top["nuisance"].items() if "nuisance" in top else []
    bounds = (
        top["uncertainty"].fields(tuple(UNCERTAINTY)) if "uncertainty" in top else {}
    )
    return Manifest(
        file=os.fspath(path),
        at=top,
        frames=tuple(entries),
        nuisances=frozenset(value.word(NUISANCES) for value in nuisances),
        uncertainty={
            name: value.number(0.0, UNCERTAINTY[name]) for name, value in bounds.items()
        },
        mask=existing(top["mask"], path) if "mask" in top else None,
    )


def frame_entry(
    value: Value, top: dict[str, Value], path: str | os.PathLike[str]
) -> FrameEntry:
    """Return a checked frame; the top level has its DEFAULTS."""
    own = value.fields(FRAME, required=("file", "kind"))
    kind = own["kind"].word(tuple(KINDS))
    file = existing(own["file"], path)
    check_fields_of_kind(value, own, kind, is_table(file))
    at = {"": value, **{name: top[name] for name in DEFAULTS if name in top}, **own}

    def number(name: str, low: float, unit: str) -> float | None:
        most = LARGEST_OF_UNIT[unit]
        return at[name].number(low, most, SHOWN.get(unit, "")) if name in at else None

    gain = number("gain", 1e-6, "gain")
    has_areas = "patches" in own and not is_table(file)
    patches = patches_of(own["patches"]) if has_areas else ()
    return FrameEntry(
        at=at,
        file=file,
        kind=kind,
        scene=scene_of(own["scene"], kind, path) if "scene" in own else None,
        gain=1.0 if gain is None else gain,
        illuminant=at["illuminant"].text() if "illuminant" in at else None,
        set=own["set"].text() if "set" in own else None,
        group=own["group"].word(GROUPS) if "group" in own else None,
        iso=number("iso", 1.0, "iso"),
        exposure_time=number("exposure_time", 0.0, "seconds"),
        temperature=number("temperature", ABSOLUTE_ZERO, "celsius"),
        mask=existing(own["mask"], path) if "mask" in own else None,
        linearize=own["linearize"].word(LINEARIZE) if "linearize" in own else None,
        patches=patches,
        corners=corners_of(own["corners"]) if "corners" in own else (),
        means=means_entry(own, path) if is_table(file) else None,
        image=at["image"].text() if "image" in at else None,
    )


def check_fields_of_kind(
    value: Value, own: dict[str, Value], kind: Kind, table: bool
) -> None:
    """Raise ValueError for a field that a kind has not, or lacks.

    table : whether the file is one of patch means."""
    known = KINDS[kind]
    if known.scene and "scene" not in own:
        value.fail(f"has no scene, which a {kind} needs: add {known.scene}")
    if table and "patches" not in known.fields:
        own["file"].fail(f"is a table of patch means, which is no {kind}: kind: chart")
    if "patches" in known.fields:
        check_chart(value, own, table)
    for name in (*OF_CHARTS, "scene", "gain", "linearize"):
        if name in own and name not in known.fields:
            own[name].fail(f"is not for a {kind}; remove it, or set another kind")
    if "scene" in own and own["scene"].node.value == UNKNOWN and "gain" in own:
        own["gain"].fail("multiplies nothing: scene is unknown; remove it")


def scene_of(
    value: Value, kind: Kind, manifest: str | os.PathLike[str]
) -> tuple[float, ...] | str:
    """Return (r, g, b), a path or "unknown"."""
    if value.is_list:
        color = value.numbers(3, 0.0, LARGEST_OF_UNIT["radiance"])
    else:
        text = value.text()
        if text == UNKNOWN and not KINDS[kind].image:
            return UNKNOWN
        if text == UNKNOWN:
            value.fail("is unknown, which a flat alone may be; give the render")
        try:
            float(text)
        except ValueError:
            return existing(value, manifest)
        color = (value.number(0.0, LARGEST_OF_UNIT["radiance"]),) * 3
    if KINDS[kind].render:
        value.fail(
            "is one colour; a scene needs its render: if it was uniform, kind: flat"
        )
    return color
