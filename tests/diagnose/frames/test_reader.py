# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Reading: of how many pixels each frame is, when there are many."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.frames.reader import (
    PIXELS,
    PIXELS_OF_ALL,
    _wanted,
    read_frames,
)
from cg2raw.diagnose.scenes.noise_level import noise_models
from diagnose.frames.test_patch_frame import means_of
from diagnose.planted import captures_of, sensor_of

SENSOR = sensor_of()
SHAPE = (600, 800)


def pixels_of(count, pixels=None, beside=()):
    """Return how many pixels each of so many frames has. beside : more captures."""
    darks = captures_of(("dark",) * count, shape=SHAPE)
    captures = CaptureSet(SENSOR, [*darks, *beside])
    noise = noise_models(captures)
    frames = read_frames(captures, noise, pixels, lambda text, share: None)
    (found,) = {frame.signal.size for frame in frames if frame.samples is None}
    return found


def test_up_to_64_frames_are_of_as_many_pixels_each():
    assert pixels_of(3) == pixels_of(64) == pytest.approx(PIXELS, rel=0.25)


@pytest.mark.parametrize("count", [80, 128, 200])
def test_many_frames_have_no_more_pixels_together(count):
    assert count * pixels_of(count) == pytest.approx(PIXELS_OF_ALL, rel=0.25)


def test_tables_of_patches_have_no_pixels_and_are_not_counted():
    means = means_of(500)
    tables = captures_of(("flat",) * 100, shape=means.mean.shape)
    tables = [replace(one, kind="chart", means=means) for one in tables]
    assert pixels_of(3, beside=tables) == pixels_of(3)


def test_who_asks_for_pixels_gets_them():
    assert pixels_of(128, 40000) == pixels_of(3, 40000) == pytest.approx(4e4, rel=0.25)


def test_pixels_are_wanted_where_any_frame_of_the_shape_counts():
    """All of them, where one frame has no mask."""
    left, top = np.zeros((2, *SHAPE), bool)
    left[:, :300] = top[:200] = True
    plain, *masked = captures_of(("flat",) * 3, shape=SHAPE)
    pairs = zip(masked, (left, top), strict=True)
    masked = [replace(one, mask=lambda mask=mask: mask) for one, mask in pairs]
    [other] = captures_of(("flat",), shape=(300, 400))
    found = _wanted(CaptureSet(SENSOR, [*masked, other]), SHAPE)
    np.testing.assert_array_equal(found, left | top)
    assert _wanted(CaptureSet(SENSOR, [*masked, plain]), SHAPE) is None
