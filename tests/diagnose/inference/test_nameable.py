# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Only what some frames can show may be named."""

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.inference.nameable import nameable
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.workers import Workers
from diagnose.planted import BY_NAME, SHAPE, capture_of, frames_of, sensor_of

SENSOR = sensor_of()


def named(captures, sensor=SENSOR):
    """Return the names that a fit and a select frame of each capture allow."""
    every = [
        capture_of(name=f"{n}{group}", group=group, **capture)
        for n, capture in enumerate(captures)
        for group in ("fit", "select")
    ]
    splits = Splits(frames_of(sensor, every), Workers(1))
    effects = nameable(CaptureSet(sensor, every), splits, set(BY_NAME))
    return {effect.name for effect in effects}


@pytest.mark.parametrize(("divided", "shown"), [(True, False), (False, True)])
def test_pixels_of_the_same_frames_do_not_tell_what_frames_share(divided, shown):
    """Its evidence would be of the offsets that it was fitted to."""

    def raw():
        return np.full(SHAPE, 300, np.uint16)

    same = {"raw": raw} if divided else {}
    names = named([{"kind": "dark", "exposure_time": 4.0, **same}] * 2)
    assert ("black_level_drift" in names) == shown
    assert "row_noise" in names


@pytest.mark.parametrize(("time", "seconds"), [(0.0, 0.0), (None, 1.0), (2.5, 2.5)])
def test_a_bias_frame_has_no_time(time, seconds):
    [frame] = frames_of(SENSOR, [capture_of("dark", exposure_time=time)])
    assert frame.seconds == seconds


@pytest.mark.parametrize(
    ("levels", "measured", "exposure", "curve"),
    [
        ((0.3, 0.3), True, True, False),
        ((0.3, 0.6), True, True, True),
        ((0.3, 0.3), False, False, False),
    ],
)
def test_what_light_tells_is_by_its_levels(levels, measured, exposure, curve):
    """Of flats that nobody measured each may be as bright as it is."""
    more = {} if measured else {"scene": None}
    names = named([{"kind": "flat", "level": level, **more} for level in levels])
    assert ("exposure" in names, "nonlinearity" in names) == (exposure, curve)
    assert {"lens_shading", "full_well"} <= names
    assert "prnu" not in names
