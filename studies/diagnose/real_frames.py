# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Real frames: those of shared collections, which are not part of the project.

CG2RAW_REAL_FRAMES or --data names the folder that has them."""

import argparse
import csv
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cg2raw.arrays import RawImage

VARIABLE = "CG2RAW_REAL_FRAMES"


class Shot(NamedTuple):
    """One frame: (H, W) uint16 DN, and what is known of it; temperature in Celsius."""

    name: str
    frame: RawImage
    kind: str
    seconds: float
    temperature: float | None


def add_data(parser: argparse.ArgumentParser) -> None:
    """Add the option that names the folder."""
    folder = os.environ.get(VARIABLE)
    parser.add_argument(
        "--data",
        type=Path,
        default=Path(folder) if folder else None,
        help=f"folder of real frames; {VARIABLE} if it is not given",
    )


def folder_of(data: Path | None) -> Path:
    """Return a folder of real frames. Raises ValueError without one."""
    if data is None or not data.is_dir():
        said = "no folder" if data is None else f"{data}: no folder"
        raise ValueError(f"{said} of real frames: give one by --data or {VARIABLE}")
    return data


def ccd(data: Path, files: str = "*_-5C.npz") -> list[Shot]:
    """Return frames of the CCD, in the order of their dates. files : of real/ccd, a
    pattern."""
    folder = data / "real" / "ccd"
    with (folder / "frames.csv").open(newline="") as file:
        said = {row["frame"]: row for row in csv.DictReader(file)}
    found = []
    for path in sorted(folder.glob(files)):
        kind = "flat" if path.name.startswith("flat") else "dark"
        with np.load(path) as frames:
            for name in frames.files:
                row = said[name]
                seconds, warm = float(row["exposure_s"]), float(row["temperature_c"])
                shot = Shot(name, frames[name], kind, seconds, warm)
                found.append((row["date"], shot))
    if not found:
        raise ValueError(f"{folder}: has no {files}")
    return [shot for _, shot in sorted(found, key=lambda one: one[0])]
