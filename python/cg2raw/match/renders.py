# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Renders become Frames through the model of a sensor."""

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.cfa import is_mono
from cg2raw.io.frame_files import ENDINGS
from cg2raw.io.image_file import RAW_ENDINGS, read_image
from cg2raw.match.captures import files_below
from cg2raw.match.frame import LIT, PROBABILITIES, Frame, floor_of, look
from cg2raw.raw_frame import RawFrame
from cg2raw.sensor import Sensor
from cg2raw.system import check_readable

METERED = "auto:50:0.05"  # shadows are above rounding then, and lights below white
SEEN = 0.25  # share of bins that may be clipped


@dataclass(frozen=True)
class Model:
    """What renders go through.

    lights : words of illuminants, which renders take in turn. iso : None for no noise.
    layer, undo, space : as of image_file.read_image."""

    sensor: Sensor
    lights: Sequence[str]
    iso: float | None = None
    exposure_time: float | None = None
    convention: str = "dng"
    layer: str | None = None
    undo: str = "stated"
    space: str | None = None


def renders_in(paths: Sequence[str]) -> list[str]:
    """Return the images among @paths and in folders of them, by name.

    Raises ValueError for none, and for RAW files."""
    found: list[str] = []
    for path in paths:
        if not os.path.isdir(path):
            check_readable(path)
            found.append(path)
            continue
        inside = list(files_below(path))
        images = [file for file in inside if file.lower().endswith(ENDINGS)]
        if not images:
            raw = any(file.lower().endswith(RAW_ENDINGS) for file in inside)
            why = "RAW files, and no renders" if raw else "no renders"
            raise ValueError(
                f"{path}: holds {why}: give scene-linear images (.exr ...)"
            )
        found += images
    return found


def read_render(path: str, index: int, model: Model) -> Frame:
    """Return the Frame that the sensor makes of a render, which is the index-th.

    Of one whose middle is clipped, or so dim that noise and rounding move it, luminance
    is that of the render as METERED exposes it, without noise, moved back. Raises
    ValueError, OSError."""
    pixels = read_image(path, model.layer, model.undo, model.space).pixels
    frame = simulated(path, pixels, index, model)
    dim = math.log2(LIT * floor_of(model.sensor))
    if frame.white_bins < SEEN and frame.level >= dim:
        return frame
    clean = replace(model, iso=None)
    plane = raw_of(pixels, index, clean, METERED)
    assert plane.simulation is not None  # of what simulate returns
    stops = plane.simulation.exposure["stops"]
    other = frame_of(path, plane, clean)
    share = np.array(PROBABILITIES)
    known = (share > other.black_bins) & (share < 1 - other.white_bins)
    return replace(
        frame,
        quantiles=np.where(known, other.quantiles - stops, frame.quantiles),
        black_bins=other.black_bins,
        white_bins=other.white_bins,
        thumbnail=other.thumbnail,
    )


def simulated(path: str, pixels: NDArray[Any], index: int, model: Model) -> Frame:
    """Return the Frame of a render's pixels."""
    return frame_of(path, raw_of(pixels, index, model), model)


def raw_of(
    pixels: NDArray[Any], index: int, model: Model, exposure: float | str = 0.0
) -> RawFrame:
    """Return the RAW frame that the sensor makes of a render's pixels."""
    mono = is_mono(model.sensor.cfa)
    return model.sensor.simulate(
        pixels,
        illuminant="" if mono else model.lights[index % len(model.lights)],
        iso=model.iso,
        exposure_time=model.exposure_time,
        convention=model.convention,
        exposure=exposure,
        frame=index,
        threads=1,
    )


def frame_of(path: str, plane: RawFrame, model: Model) -> Frame:
    """Return the Frame of a RAW frame that was simulated."""
    assert plane.simulation is not None  # of what simulate returns
    light = None if is_mono(model.sensor.cfa) else plane.simulation.illuminant
    return look(os.path.basename(path), np.asarray(plane), model.sensor, light)
