# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Renders become Frames through the model of a sensor."""

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
from cg2raw.match.frame import Frame, look
from cg2raw.sensor import Sensor
from cg2raw.system import check_readable

# Stops by which a render is moved so that its middle is seen, where it is not.
STEPS = (-6.0, 6.0, -12.0, 12.0, -18.0, 18.0)
SEEN = 0.25  # share of bins on either side of what is compared


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

    Of one whose middle is clipped or black, luminance is that of the render darkened or
    brightened, moved back. Raises ValueError, OSError."""
    pixels = read_image(path, model.layer, model.undo, model.space).pixels
    frame = simulated(path, pixels, index, model)
    for step in STEPS:
        if max(frame.black_bins, frame.white_bins) < SEEN:
            break
        if (frame.white_bins >= SEEN) != (step < 0):
            continue
        other = simulated(path, pixels, index, model, step)
        if max(other.black_bins, other.white_bins) < SEEN:
            frame = replace(
                frame,
                quantiles=other.quantiles - step,
                black_bins=other.black_bins,
                white_bins=other.white_bins,
                thumbnail=(other.thumbnail - np.float16(step)),
            )
    return frame


def simulated(
    path: str, pixels: NDArray[Any], index: int, model: Model, stops: float = 0.0
) -> Frame:
    """Return the Frame of a render's pixels, exposed by a number of stops."""
    sensor = model.sensor
    light = "" if is_mono(sensor.cfa) else model.lights[index % len(model.lights)]
    plane = sensor.simulate(
        pixels,
        illuminant=light,
        iso=model.iso,
        exposure_time=model.exposure_time,
        convention=model.convention,
        exposure=stops,
        frame=index,
        threads=1,
    )
    assert plane.simulation is not None  # of what simulate returns
    seen = plane.simulation.illuminant if light else None
    return look(os.path.basename(path), np.asarray(plane), sensor, seen)
