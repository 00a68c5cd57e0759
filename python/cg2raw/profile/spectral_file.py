# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectra read from files: sensitivities of a camera, power of a light.

Two forms. JSON as the Academy's rawtoaces-data has it: header {manufacturer, model,
...}, spectral_data {index {main: channels}, data {main: {"380": values, ...}}}. Tables
(io/text_table.py): rows of wavelength and values; a first row that is no numbers names
the columns.
"""

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.io.text_table import read_table, read_text

# The visible range in steps of the published tables. Source: CIE 015, 7.2.
Array = NDArray[np.float64]
Rows = list[tuple[float, list[float]]]  # wavelength, values of the channels

UNITS = ("energy", "photon")
MONO = ("mono",)  # the channel of a sensor without filters

WAVELENGTHS = np.arange(380.0, 781.0, 5.0)  # nm
# What a table must cover at least (as ISO 7589's do), and how far apart rows may lie.
COVERED = (400.0, 690.0)  # nm
WIDEST_STEP = 20.0  # nm
# Measured sensitivities dip below 0 by noise, never by more than this of their peak.
NEGATIVE_NOISE = 0.01


@dataclasses.dataclass(frozen=True)
class SpectralTable:
    """Sensitivities at the wavelengths where they were measured."""

    wavelengths: Array  # (n,), nm, rising
    rgb: Array  # (n, 3), peak 1
    scale: float = 1.0  # what 1 stands for in the file
    unit: str = "energy"  # what they are a response to; or "photon"

    def at(self, wavelengths: Array) -> Array:
        """Return (m, 3) of the monotone curves through the table, 0 outside it."""
        from scipy.interpolate import PchipInterpolator

        curves = PchipInterpolator(self.wavelengths, self.rgb, extrapolate=False)
        return np.asarray(np.nan_to_num(curves(wavelengths), nan=0.0))


@dataclasses.dataclass(frozen=True)
class Sensitivities:
    """Relative spectral sensitivities of a camera's R, G and B to radiant energy."""

    file: str  # where they were read, for messages and sources
    rgb: Array  # (81, 3), at WAVELENGTHS, peak 1; 0 outside the table
    make: str | None = None  # as the file's header has it
    model: str | None = None
    origin: str = ""  # creator, date and licence, as far as the header says them
    table: SpectralTable | None = None  # None: rgb, at WAVELENGTHS

    def measured(self) -> SpectralTable:
        """Return the table that they were read from."""
        return self.table or SpectralTable(WAVELENGTHS, self.rgb)


def read_sensitivities(
    path: str | Path, mono: bool = False, unit: str = "energy"
) -> Sensitivities:
    """Return the Sensitivities of a JSON or CSV file (channels R, G and B).

    mono : of a monochrome sensor: the channel is called mono, or is the only one, and
        all three are alike.
    unit : what they are a response to, radiant "energy" or a "photon" (quantum
        efficiency).
    Raises ValueError that names file, field and value: wavelengths must rise without a
    gap and cover 400 to 690 nm, values be finite, none below -1 % of its channel's
    peak, and every channel see something."""
    if unit not in UNITS:
        raise ValueError(f"unit {unit!r} must be one of {', '.join(UNITS)}")
    channels = MONO if mono else ("R", "G", "B")
    header, wavelengths, values = _table(path, channels)
    for channel, curve in zip(channels, values.T, strict=True):
        _check_channel(path, channel, wavelengths, curve)
    values = np.broadcast_to(values, (len(values), 3))
    scale = float(np.max(values))
    table = SpectralTable(wavelengths, values / scale, scale, unit)
    rgb = table.at(WAVELENGTHS)
    if unit == "photon":  # whose energy goes by 1 / wavelength
        rgb = rgb * WAVELENGTHS[:, None]
        rgb = rgb / np.max(rgb)
    names = ("document_creator", "document_creation_date", "license")
    said = [str(header[name]) for name in names if header.get(name)]
    return Sensitivities(
        file=Path(path).name,
        rgb=rgb,
        make=header.get("manufacturer"),
        model=header.get("model"),
        origin=", ".join(said),
        table=table,
    )


def read_power(path: str | Path) -> tuple[Array, Array]:
    """Return (wavelengths, power) of a light's JSON or CSV file, in nm and any unit.

    Raises ValueError as read_sensitivities does."""
    _, wavelengths, values = _table(path, ("power",))
    _check_channel(path, "power", wavelengths, values[:, 0])
    return wavelengths, values[:, 0]


def check_cover(name: object, wavelengths: Array) -> None:
    """Raise ValueError unless rising wavelengths cover the visible range."""
    if wavelengths[0] > COVERED[0] or wavelengths[-1] < COVERED[1]:
        raise ValueError(
            f"{name}: wavelengths {wavelengths[0]:g} to {wavelengths[-1]:g} nm must "
            f"cover {COVERED[0]:g} to {COVERED[1]:g} nm"
        )


def _table(
    path: str | Path, channels: Sequence[str]
) -> tuple[dict[str, Any], Array, Array]:
    """Return (header, wavelengths, values in the order of channels) of a file."""
    try:
        text = read_text(path)
        if text.lstrip().startswith("{"):
            header, rows = _json_table(path, text, channels)
        else:
            header, rows = {}, _rows(path, channels)
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}") from None
    if not rows:
        raise ValueError(f"{path}: holds no row of wavelength and values")
    table = np.array([[wavelength, *values] for wavelength, values in rows])
    _check_wavelengths(path, table[:, 0])
    return header, table[:, 0], table[:, 1:]


def _json_table(
    path: str | Path, text: str, channels: Sequence[str]
) -> tuple[dict[str, Any], Rows]:
    def no_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        names = [name for name, _ in pairs]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"{path}: {twice[0]!r} stands there twice")
        return dict(pairs)

    try:
        document = json.loads(text, object_pairs_hook=no_duplicates)
    except (json.JSONDecodeError, RecursionError) as error:
        raise ValueError(f"{path}: is no JSON: {error}") from None
    index = _field(path, document, "spectral_data.index.main", list)
    data = _field(path, document, "spectral_data.data.main", dict)
    columns = _columns(path, "spectral_data.index.main", index, channels)
    rows = []
    for key, values in data.items():
        field = f"spectral_data.data.main {key!r}"
        if not isinstance(values, list) or len(values) != len(index):
            raise ValueError(f"{path}: {field} must be a list of {len(index)} numbers")
        numbers = [_number(path, field, values[column]) for column in columns]
        rows.append((_number(path, "wavelength", key), numbers))
    header = document.get("header")
    return header if isinstance(header, dict) else {}, rows


def _rows(path: str | Path, channels: Sequence[str]) -> Rows:
    table = read_table(path, ("wavelength", *channels))
    where = f"line {table.line}"
    columns = _columns(path, where, table.names[1:], channels)
    return [
        (row.number(0), [row.number(1 + column) for column in columns])
        for row in table.rows
    ]


def _field(path: str | Path, document: Any, dotted: str, kind: type) -> Any:
    """Return a nested field of a JSON document."""
    value = document
    for name in dotted.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    if not isinstance(value, kind):
        what = "a list of channels" if kind is list else "an object of wavelengths"
        raise ValueError(f"{path}: {dotted} is missing: {what}")
    return value


def _columns(
    path: str | Path, field: str, names: Sequence[Any], channels: Sequence[str]
) -> list[int]:
    """Return where the wanted channels stand among the names of the columns; the only
    column is that of a monochrome sensor, whatever it is called."""
    if channels == MONO and len(names) == 1:
        return [0]
    folded = [str(name).casefold() for name in names]
    for channel in channels:
        if folded.count(channel.casefold()) != 1:
            raise ValueError(
                f"{path}: {field} {names} must name the channel {channel} once"
            )
    return [folded.index(channel.casefold()) for channel in channels]


def _is_number(word: str | float) -> bool:
    try:
        float(word)
    except (ValueError, OverflowError):
        return False
    return True


def _number(path: str | Path, field: str, value: Any) -> float:
    legal = isinstance(value, (int, float, str)) and not isinstance(value, bool)
    if not legal or not _is_number(value) or not np.isfinite(float(value)):
        raise ValueError(f"{path}: {field} {value!r} must be a finite number")
    return float(value)


def _check_wavelengths(path: str | Path, wavelengths: Array) -> None:
    steps = np.diff(wavelengths)
    for before, after in zip(wavelengths, wavelengths[1:], strict=False):
        if after <= before:
            raise ValueError(
                f"{path}: wavelength {after:g} nm comes after {before:g} nm; they must "
                "rise"
            )
    check_cover(path, wavelengths)
    widest = int(np.argmax(steps))
    allowed = min(1.5 * np.median(steps), WIDEST_STEP)
    if steps[widest] > allowed:
        raise ValueError(
            f"{path}: wavelengths have a gap from {wavelengths[widest]:g} to "
            f"{wavelengths[widest + 1]:g} nm; at most {allowed:g} nm is allowed here"
        )


def _check_channel(
    path: str | Path, channel: str, wavelengths: Array, curve: Array
) -> None:
    peak = np.max(curve)
    if peak <= 0.0:
        raise ValueError(f"{path}: {channel} is nowhere above 0")
    lowest = int(np.argmin(curve))
    if curve[lowest] < -NEGATIVE_NOISE * peak:
        raise ValueError(
            f"{path}: {channel} at {wavelengths[lowest]:g} nm is {curve[lowest]:g}; "
            f"noise may reach {-NEGATIVE_NOISE * peak:g}, 1 % of the peak"
        )
