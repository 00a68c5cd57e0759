# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make a profile from RAW files that are no DNGs, through LibRaw."""

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.io import libraw
from cg2raw.io.raw_header import RawHeader

REMEDY = "convert it with Adobe DNG Converter or dnglab, then give the DNG"
NOTE = (
    "read through LibRaw: its one colour matrix is for D65 and it knows no noise; the "
    "DNG that Adobe DNG Converter makes of such a file has two matrices and noise"
)


def read(path: str, make: str = "", model: str = "") -> RawHeader:
    """Return the header of a RAW file that is no DNG.

    make, model : stand in for those of its Exif.
    Raises ValueError that says what is missing and what to do, OSError."""
    [file] = libraw.camera_raw(path)
    header = file.header
    make, model = make or header.make, model or header.model
    if not (make and model):
        raise ValueError(
            f"{path}: its Exif names no camera: give --make and --model, or {REMEDY}"
        )
    if header.camera_from_xyz is None:
        raise ValueError(
            f"{path}: LibRaw has no colour matrix of this camera: {REMEDY}"
        )
    return replace(header, make=make, model=model)


def profile_from_raw_files(
    files: Sequence[RawHeader], id: str = ""
) -> tuple[dict[str, Any], list[str]]:
    """Return (fields of the profile, notes) of the headers of one camera's files.

    id : stands in for the one made of the camera's name. Raises ValueError."""
    first = files[0]
    for file in files[1:]:
        for name in ("make", "model", "cfa", "shape", "white_level"):
            ours, others = getattr(first, name), getattr(file, name)
            if ours != others:
                raise ValueError(
                    f"{file.path}: {name} {others} is not that of {first.path}, "
                    f"{ours}: give files of one camera in one mode"
                )
    notes = [NOTE]
    black, neutrals = black_of(files, notes), neutrals_of(files, notes)
    name = _core.camera_name(first.make, first.model)
    height, width = first.shape
    white, matrix = first.white_level, first.camera_from_xyz
    assert white is not None and matrix is not None  # read() has them
    fields = {
        "schema": 1,
        "id": id or _core.sensor_id_from_name(name),
        "make": first.make,
        "model": first.model,
        "unique_camera_model": name,
        "sources": sources_of(files, neutrals),
        "cfa": first.cfa,
        "width": width,
        "height": height,
        "bits": max(8, white.bit_length()),
        "black_level": black,
        "white_level": white,
        "calibration_illuminant_1": "D65",
        "color_matrix_1": list(matrix),
    }
    return fields | ({"illuminants": {"neutrals": neutrals}} if neutrals else {}), notes


def black_of(files: Sequence[RawHeader], notes: list[str]) -> list[float]:
    """Return the mean black level per CFA site; a note says if they differ."""
    black = np.array([file.black_level for file in files])
    if np.ptp(black, axis=0).any():
        notes.append(
            f"black levels differ from file to file, {black.min():g} to "
            f"{black.max():g} DN: the profile has their mean"
        )
    mean: list[float] = black.mean(axis=0).round(4).tolist()
    return mean


def neutrals_of(files: Sequence[RawHeader], notes: list[str]) -> list[list[float]]:
    """Return [[R/G, B/G], ...] of those files that have one; a note names the rest."""
    without = [file.path for file in files if file.as_shot is None]
    if without:
        notes.append(
            f"{len(without)} of {len(files)} files record no white balance that LibRaw "
            f"can read, {os.path.basename(without[0])} first: no neutral of them"
        )
    return [[file.as_shot[0], file.as_shot[2]] for file in files if file.as_shot]


def sources_of(
    files: Sequence[RawHeader], neutrals: list[list[float]]
) -> dict[str, str]:
    """Return {field: where it is from}."""
    import rawpy

    libraw = "LibRaw " + ".".join(map(str, rawpy.libraw_version))
    name = os.path.basename(files[0].path)
    read = f"{name} as {libraw} reads it"
    sources = {
        **dict.fromkeys(("make", "model", "unique_camera_model"), f"{name}: Exif"),
        **dict.fromkeys(("cfa", "width", "height"), f"{read}: visible area"),
        "bits": "those that white_level needs",
        **dict.fromkeys(("black_level", "white_level"), read),
        "calibration_illuminant_1": f"{libraw}: its matrices are for D65",
        "color_matrix_1": f"{libraw}: its table of cameras",
    }
    if neutrals:
        sources["illuminants"] = f"as-shot white balance of {len(neutrals)} files"
    return sources
