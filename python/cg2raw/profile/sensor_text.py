# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""All that is known of one sensor, as text."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.cfa import is_mono, sites_of
from cg2raw.profile.summary import iso_words, neutral_words

Summary = Mapping[str, Any]  # as summary() makes it

LEVELS = ("cfa", "width", "height", "bits", "black_level", "white_level")
NO_NOISE = "none: cg2raw calibrate measures it from darks and flats"
FIELD = 26  # columns of a field's name
STEP = 10.0  # nm, of a character of a curve
BLOCKS = (
    "\u2581\u2582\u2583\u2584\u2585\u2586\u2587\u2588"  # an eighth to a whole block
)
PLAIN_BLOCKS = "_.:-=+*#"  # where a terminal has none


def details(sensor: Summary, columns: int, encoding: str = "utf-8") -> list[str]:
    """Return the lines on everything of one sensor, each field with its source.

    encoding : of the terminal, which may have no blocks to draw curves of."""
    lines, told = [], set()
    pending = fields_of(sensor, encoding)
    for index, (field, value) in enumerate(pending):
        key = source_key(field, sensor["sources"])
        lines += wrapped(field, value, columns)
        following = pending[index + 1][0] if index + 1 < len(pending) else None
        text = sensor["sources"].get(key)
        same = following and text == sensor["sources"].get(
            source_key(following, sensor["sources"])
        )
        told.add(key)
        if text and not same:
            lines += wrapped("", f"from: {text}", columns)
    rest = {key: text for key, text in sensor["sources"].items() if key not in told}
    for key, text in rest.items():
        lines += wrapped(key, text, columns)
    return lines


def source_key(field: str, sources: Mapping[str, str]) -> str | None:
    """Return the key of @field's source: its own, or that of a group it belongs to."""
    groups = [field, field.rstrip("12").rstrip("_"), field.partition(" ")[0]]
    if field in LEVELS:
        groups.append("levels, CFA and size")  # of profiles made of DNGs
    return next((key for key in groups if key in sources), None)


def wrapped(label: str, text: str, columns: int) -> list[str]:
    """Return lines with @text beside @label."""
    width = max(30, columns - FIELD)
    parts = textwrap.wrap(text, width, break_on_hyphens=False) or [""]
    label = label if len(label) < FIELD else label[: FIELD - 4] + "..."
    return [f"{label:{FIELD}}{parts[0]}"] + [" " * FIELD + part for part in parts[1:]]


def fields_of(sensor: Summary, encoding: str) -> list[tuple[str, str]]:
    """Return [(field, text), ...] of everything but the sources."""
    black = per_site(sensor["black_level"], sensor["cfa"], 6)
    lamps = [(f"lamps {lamp['name']}", lamp_words(lamp)) for lamp in sensor["lamps"]]
    texts = {
        "sources": [],
        "black_level": [("black_level", f"{black} DN")],
        "white_level": [("white_level", f"{sensor['white_level']} DN")],
        "calibrations": calibration_fields(sensor["calibrations"]),
        "lamps": lamps,
        "spectral_sensitivities": sensitivity_fields(
            sensor["spectral_sensitivities"], encoding
        ),
        "illuminants": [("illuminants", neutrals_of(sensor))],
        "digital_gain": [("digital_gain", gain_words(sensor["digital_gain"]))],
        "noise": noise_fields(sensor["noise"], sensor["cfa"]),
        "noise_effects": [],  # with the noise
        "effects": [("effects", effect_words(effect)) for effect in sensor["effects"]],
    }
    found = []
    for name, _ in _core.profile_fields:
        if name in texts:
            found += texts[name]
        elif sensor[name] is not None:
            found.append((name, f"{sensor[name]}"))
    return found


def neutrals_of(sensor: Summary) -> str:
    """Return the neutrals in words; a monochrome sensor needs none."""
    if is_mono(sensor["cfa"]):
        return "none: monochrome, all are alike"
    return neutral_words(sensor["illuminants"])


def per_site(values: Sequence[float], cfa: str, digits: int = 3) -> str:
    """Return values of CFA sites: one if all are alike; means of R, G, B of X-Trans."""
    if len(set(values)) == 1:
        values, names = values[:1], [""]
    elif len(values) == 4:
        names = [""] * 4
    else:
        names = ["R ", "G ", "B "]
        groups = [
            [
                v
                for v, letter in zip(values, sites_of(cfa), strict=True)
                if letter == color
            ]
            for color in "RGB"
        ]
        values = [sum(group) / len(group) for group in groups]
    words = zip(names, values, strict=True)
    return " ".join(f"{name}{value:.{digits}g}" for name, value in words)


def calibration_fields(
    calibrations: Sequence[Mapping[str, Any]],
) -> list[tuple[str, str]]:
    """Return the fields of each colour matrix."""
    fields = []
    for number, calibration in enumerate(calibrations, 1):
        fields.append((f"calibration_illuminant_{number}", calibration["light_source"]))
        fields.append(
            (f"color_matrix_{number}", matrix(calibration["camera_from_xyz"]))
        )
        if calibration["xyz_d50_from_camera"]:
            forward = matrix(calibration["xyz_d50_from_camera"])
            fields.append((f"forward_matrix_{number}", forward))
    return fields


def lamp_words(lamp: Mapping[str, Any]) -> str:
    """Return the neutral and the matrix of one lamp."""
    red, blue = lamp["neutral"]
    return f"R/G {red:.4f}, B/G {blue:.4f}, {matrix(lamp['camera_from_xyz'])}"


def matrix(rows: Sequence[Sequence[float]]) -> str:
    """Return "a b c / d e f / g h i"."""
    return " / ".join(" ".join(f"{value:.4f}" for value in row) for row in rows)


def gain_words(gain: Mapping[str, float] | None) -> str:
    """Return the distribution of the digital gain."""
    return f"mean {gain['mean']:g}, sd {gain['sigma']:g}" if gain else "none"


def noise_fields(noise: Mapping[str, Any], cfa: str) -> list[tuple[str, str]]:
    """Return beta1 and beta2 at each ISO, the range of ISOs, and what draws it."""
    rows = [
        (
            f"noise at ISO {row['iso']:g}",
            f"beta1 {per_site(row['beta1'], cfa)}, beta2 {per_site(row['beta2'], cfa)}",
        )
        for row in noise["rows"]
    ]
    if not rows:
        return [("noise", NO_NOISE)]
    drawn = ("noise drawn by", ", ".join(noise["effects"]))
    return [*rows, ("iso", iso_words(noise)), drawn]


def effect_words(effect: Mapping[str, Any]) -> str:
    """Return the name of an effect with its parameters."""
    parameters = sorted(effect["parameters"].items())
    return " ".join([effect["name"], *(f"{name}={v:g}" for name, v in parameters)])


def sensitivity_fields(
    sensitivities: Mapping[str, Any] | None, encoding: str
) -> list[tuple[str, str]]:
    """Return [(field, text), ...]: range, unit, and a curve of each channel.

    sensitivities : as summary() has them; None: nothing is returned.
    encoding : of the terminal."""
    if sensitivities is None:
        return []
    name = "spectral_sensitivities"
    wavelengths = np.array(sensitivities["wavelengths"])
    curves = np.array(sensitivities["rgb"])
    channels = "RGB" if np.ptp(curves, axis=1).any() else ["mono"]
    unit = {"energy": "radiant energy", "photon": "photons"}[sensitivities["unit"]]
    scale = sensitivities["scale"]
    fields = [
        (
            name,
            f"{wavelengths[0]:g} to {wavelengths[-1]:g} nm, {len(wavelengths)} rows, "
            f"response to {unit}" + (f", 1 is {scale:.4g} as measured" * (scale != 1)),
        )
    ]
    for channel, curve in zip(channels, curves.T, strict=False):
        peak = wavelengths[np.argmax(curve)]
        line = curve_line(wavelengths, curve / curves.max(), encoding)
        fields.append((f"{name} {channel}", f"{line} peak {peak:g} nm"))
    return fields


def curve_line(wavelengths: Any, values: Any, encoding: str) -> str:
    """Return a character for every 10 nm; values (n,) of 0 to 1."""
    blocks = BLOCKS if can_show(encoding) else PLAIN_BLOCKS
    at = np.arange(wavelengths[0], wavelengths[-1] + STEP / 2, STEP)
    heights = np.clip(np.interp(at, wavelengths, values), 0.0, 1.0)
    return "".join(blocks[i] for i in np.rint(heights * (len(blocks) - 1)).astype(int))


def can_show(encoding: str) -> bool:
    """Return whether text of an encoding may have blocks."""
    try:
        BLOCKS.encode(encoding)
    except (UnicodeEncodeError, LookupError):
        return False
    return True
