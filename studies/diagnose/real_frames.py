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
from cg2raw.io.raw_file import open_raw

VARIABLE = "CG2RAW_REAL_FRAMES"


class Shot(NamedTuple):
    """One frame, and what is known of it. path, image : file, and which of those in an
    .npz. seconds : exposure time. temperature : Celsius."""

    path: Path
    image: str | None
    kind: str
    seconds: float | None
    temperature: float | None

    @property
    def frame(self) -> RawImage:
        """(H, W) uint16 DN."""
        return open_raw(str(self.path), self.image).mosaic()


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


def shots(data: Path, files: str, kind: str | None = None) -> list[Shot]:
    """Return frames in the order of their dates, else of their files.

    files : pattern below the folder. kind : of all; by default what the frames.csv
    beside a file says, or its name. Raises ValueError for none."""
    found = []
    for path in sorted(data.glob(files)):
        table = path.with_name("frames.csv")
        images: list[str | None] = [None]
        if path.suffix == ".npz":
            with np.load(path) as arrays:
                images = list(arrays.files)
        rows = {}
        if table.exists():
            with table.open(newline="") as file:
                rows = {row["frame"]: row for row in csv.DictReader(file)}
        for image in images:
            row = rows.get(image or path.name, {})
            own = row.get("kind") or ("flat" if path.name[:4] == "flat" else "dark")
            seconds, warm = row.get("exposure_s"), row.get("temperature_c")
            shot = Shot(
                path,
                image,
                kind or own,
                float(seconds) if seconds else _milliseconds(path.name),
                float(warm) if warm else None,
            )
            found.append((row.get("date", ""), shot))
    if not found:
        raise ValueError(f"{data}: has no {files}")
    return [shot for _, shot in sorted(found, key=lambda one: one[0])]


def _milliseconds(name: str) -> float | None:
    """Return the seconds of a name such as d1_dark_100ms_2019.tif."""
    words = [word[:-2] for word in name.split("_") if word.endswith("ms")]
    return float(words[0]) / 1000 if words and words[0].isdecimal() else None


def ccd(data: Path) -> list[Shot]:
    """Return the 36 frames of the CCD."""
    return shots(data, "real/ccd/*_-5C.npz")
