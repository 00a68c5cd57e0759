# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the study of spectra measures over: lights, reflectances and cameras."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cg2raw.profile.matrix_fit import training_reflectances
from cg2raw.profile.spectral_file import WAVELENGTHS
from oracles import spectral

Array = np.ndarray[Any, np.dtype[np.float64]]
CAMERAS = Path("tables/ssf/rawtoaces-data/data/camera")
LIGHTS = (
    *("A", "D50", "D55", "D65", "D75"),
    *(f"FL{number}" for number in range(1, 13)),
    *(f"LED-B{number}" for number in range(1, 6)),
    *("LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"),
    *(f"HP{number}" for number in range(1, 6)),
)
# Two phosphor LEDs, 3000 and 6800 K, and low pressure sodium, which is one line: lamps
# by file, as a profile takes them. Source: NIST, Color Quality Scale, 9.0.a, as
# colour-science has it.
LAMPS = {"PHOS-1": "PHOS-1", "YAG": "Phosphor LED YAG", "LPS": "LPS"}
MONOCHROMATIC = "LPS"
COVER = (400.0, 700.0)  # nm that a table of reflectances must reach
BRIGHTEST = 1.1  # of a reflectance; fluorescent ones are no reflectances
DARKEST = 0.005  # mean; below it an angle is one of the measurement's noise
SAME = 0.01  # rms of a difference over the rms of a reflectance, below which it is one


def write_lamps(folder: str | Path) -> dict[str, str]:
    """Return {light: word or path} of LIGHTS and LAMPS, the latter written as CSV."""
    words = {light: light for light in LIGHTS}
    for name, table in LAMPS.items():
        power = spectral.colour.SDS_LIGHT_SOURCES[table]
        words[name] = str(Path(folder) / f"{name}.csv")
        rows = np.column_stack([power.wavelengths, power.values])
        np.savetxt(words[name], rows, delimiter=",", fmt="%g")
    return words


def camera_files(data: Path, parts: Sequence[str]) -> dict[str, Path]:
    """Return {name: path} of sensitivities whose name has one of the parts, or all."""
    files = sorted((data / CAMERAS).glob("*.json"))
    named = {path.name.removesuffix("_380_780_5.json"): path for path in files}
    return {
        name: path
        for name, path in named.items()
        if not parts or any(part in name for part in parts)
    }


def read_reflectances(path: str | Path) -> Array:
    """Return reflectances (n, 81) at WAVELENGTHS of a table.

    path : CSV (or .dat) of a row per wavelength, nm first, then a column for each
        reflectance, 0 to 1; or .npz of one array (1 + n, wavelengths), nm first.
    Outside a table its end value holds. Raises ValueError."""
    try:
        if Path(path).suffix == ".npz":
            with np.load(path) as arrays:
                table = arrays[arrays.files[0]]
        else:
            table = np.loadtxt(path, delimiter=",", ndmin=2).T
        nm, rows = table[0], table[1:]
    except (OSError, ValueError, IndexError) as error:
        raise ValueError(f"{path}: {error}") from None
    if not np.all(np.diff(nm) > 0.0) or nm[0] > COVER[0] or nm[-1] < COVER[1]:
        raise ValueError(f"{path}: wavelengths must rise and cover 400 to 700 nm")
    if len(rows) == 0 or not np.all((rows >= 0.0) & (rows <= BRIGHTEST)):
        raise ValueError(f"{path}: must hold reflectances of 0 to {BRIGHTEST}")
    return np.array([np.interp(WAVELENGTHS, nm, row) for row in rows])


def distance(reflectances: Array, others: Array) -> Array:
    """Return (n,): the least rms difference to any of others, over the own rms."""
    rms = np.sqrt(np.mean(reflectances**2, axis=1))
    nearest = [
        np.sqrt(np.mean((row - others) ** 2, axis=1).min()) for row in reflectances
    ]
    return np.asarray(np.array(nearest) / rms, float)


def usable(reflectances: Array) -> tuple[Array, dict[str, int]]:
    """Return (rows, {why: how many were left out}) of reflectances (n, 81).

    Left out: those almost black, those that stand there twice, and those that are one
    of the Academy's 190, to which basis and matrices were fitted."""
    bright = reflectances[reflectances.mean(axis=1) > DARKEST]
    _, first = np.unique(bright.round(6), axis=0, return_index=True)
    once = bright[np.sort(first)]
    kept = once[distance(once, np.array(training_reflectances())) > SAME]
    return kept, {
        "black": len(reflectances) - len(bright),
        "twice": len(bright) - len(once),
        "training": len(once) - len(kept),
    }


def reflectance_sets(
    files: Sequence[str | Path],
) -> tuple[dict[str, Array], dict[str, dict[str, int]]]:
    """Return ({name: (n, 81)}, {name: {why: left out}}): built in, then of files."""
    built_in = spectral.held_out()
    sets = {
        "ColorChecker": built_in["ColorChecker"],
        "CIE 224, PMC": np.concatenate([built_in["CIE 224"], built_in["PMC"]]),
        **{Path(file).stem: read_reflectances(file) for file in files},
    }
    found = {name: usable(rows) for name, rows in sets.items()}
    kept = {name: rows for name, (rows, _) in found.items()}
    return kept, {name: left_out for name, (_, left_out) in found.items()}
