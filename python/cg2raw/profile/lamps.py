# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Lamps with a matrix of their own: what a camera's sensitivities see under each."""

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cg2raw.io.atomic_file import FilePath
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from cg2raw.system import has_folder

# The light source of EXIF 2.32 whose range of temperatures a fluorescent lamp of CIE
# 015 is in; other lamps have none. Source: CIPA DC-008, LightSource.
FLUORESCENT = {
    **dict.fromkeys(("FL1", "FL5", "FL7"), "daylight fluorescent"),
    **dict.fromkeys(("FL8", "FL10"), "day white fluorescent"),
    **dict.fromkeys(("FL2", "FL6", "FL9", "FL11"), "cool white fluorescent"),
    "FL3": "white fluorescent",
}
DECIMALS_OF_POWER = 6  # of a peak of 1
DAYLIGHT = ("D50", "D55", "D75")


def lamp_name(light: FilePath) -> str:
    """Return the name of a lamp in a profile: its word, or its file's name.

    "FL2" -> "FL2", "lamps/my lamp.csv" -> "my-lamp"."""
    word = os.fspath(light)
    if has_folder(word) or word.endswith((".csv", ".json")):
        word = Path(word).stem
    return re.sub(r"[^A-Za-z0-9._]+", "-", word).strip("-")


def calibration_illuminant(light: FilePath) -> str:
    """Return the EXIF LightSource of a lamp's word, "other" where there is none."""
    word = os.fspath(light)
    return word if word in DAYLIGHT else FLUORESCENT.get(word, "other")


def check_lamp_names(file: str, lamps: Iterable[FilePath]) -> None:
    """Raise ValueError for two lamps of one name, as two files in two folders."""
    by_name: dict[str, str] = {}
    for lamp in lamps:
        word, name = os.fspath(lamp), re.sub(r"[.-]", "_", lamp_name(lamp).lower())
        if name in by_name:
            raise ValueError(
                f"{file}: lamps {by_name[name]!r} and {word!r} would both be called "
                f"{lamp_name(lamp)}; name one of the files otherwise"
            )
        by_name[name] = word


def lamp_field(light: FilePath, neutral: Any, color_matrix: Any) -> dict[str, Any]:
    """Return the entry of a profile's "lamps".

    light : a word of illuminant_spectra.GRAMMAR. neutral : (R/G, B/G) of grey.
    color_matrix : (3, 3), XYZ -> camera."""
    power = illuminant_spectrum(light)
    return {
        "name": lamp_name(light),
        "calibration_illuminant": calibration_illuminant(light),
        "neutral": [float(value) for value in neutral],
        "color_matrix": (color_matrix.ravel() + 0.0).tolist(),
        "power": {
            "wavelengths": WAVELENGTHS.tolist(),
            "values": (power / power.max()).round(DECIMALS_OF_POWER).tolist(),
        },
    }
