# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Reader: the frames of a capture set, whole or in tiles."""

from collections.abc import Callable, Mapping

import numpy as np

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.frames.frame import Frame, frame_of, source_of, warmth_of
from cg2raw.diagnose.frames.noise_model import NoiseModel
from cg2raw.diagnose.frames.patch_frame import patch_frame_of
from cg2raw.diagnose.frames.tiling import Mask, tiling
from cg2raw.statistics.frame_statistics import read_ahead

READING_SHARE = 0.25  # of a diagnosis, that reading takes
PIXELS = 65536  # of one frame that are worked on; a small frame is taken whole
# Of all frames together. A weak pattern shows better in more frames of fewer pixels: in
# what is told of its variance, frames count by their square.
FEW_FRAMES = 64  # up to which each has all its pixels
PIXELS_OF_ALL = FEW_FRAMES * PIXELS


def read_frames(
    capture_set: CaptureSet,
    noise: Mapping[float | None, NoiseModel],
    pixels: int | None,
    report: Callable[[str, float], None],
) -> list[Frame]:
    """Return the frames of all captures, in their order.

    noise : by ISO. pixels : of every frame that are taken; a small frame is whole. None
    for PIXELS, and for fewer of more frames than 64."""
    whole = [c for c in capture_set.captures if c.means is None]
    pixels = pixels or PIXELS_OF_ALL // max(FEW_FRAMES, len(whole))
    repeat = repeat_of(capture_set.sensor.cfa)
    tiles = {
        shape: tiling(shape, pixels, repeat, _wanted(capture_set, shape))
        for shape in {c.shape for c in whole}
    }
    frames = []
    mosaics = read_ahead([c.raw for c in whole], 1)
    temperature = capture_set.temperature
    for number, capture in enumerate(capture_set.captures):
        share = READING_SHARE * number / len(capture_set.captures)
        report(f"reading {capture.name}", share)
        if capture.means is not None:
            frames.append(patch_frame_of(capture_set, capture, noise[capture.iso]))
            continue
        warmth = warmth_of(capture, temperature)
        noise_of = noise[capture.iso]
        # The whole source has no name here: it is freed before the next is read.
        frames.append(
            frame_of(
                source_of(capture_set, capture, next(mosaics)),
                tiles[capture.shape],
                noise_of,
                warmth,
            )
        )
    return frames


def _wanted(capture_set: CaptureSet, shape: tuple[int, int]) -> Mask | None:
    """Return where any capture of a shape counts; None if one counts everywhere."""
    captures = [c for c in capture_set.captures if c.shape == shape and c.means is None]
    wanted = np.zeros(shape, bool)
    for capture in captures:
        if capture.mask is None:
            return None
        wanted |= capture.mask()
    return wanted
