# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Only what some frames can show may be named."""

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.splits import third
from cg2raw.diagnose.inference.nameable import nameable
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.workers import Workers
from diagnose.planted import BY_NAME, SHAPE, capture_of, frames_of, sensor_of

SENSOR = sensor_of()


HOT = {"name": "hot_pixels", "parameters": {"fraction": 0.02, "rate": 0.01}}


def named(captures, sensor=SENSOR):
    """Return the names that a fit and a select frame of each capture allow."""
    every = [
        capture_of(name=f"{n}{group}", group=group, **capture)
        for n, capture in enumerate(captures)
        for group in ("fit", "select")
    ]
    splits = Splits(frames_of(sensor, every), Workers(1))
    effects, unseen = nameable(CaptureSet(sensor, every), splits, set(BY_NAME))
    assert not {e.name for e in effects} & {e.name for e in unseen}
    return {effect.name for effect in effects}


@pytest.mark.parametrize(
    ("times", "shown"),
    [((0.0, 60.0), True), ((0.0, 0.0), False), ((None, 60.0), False), ((2.0,), True)],
)
def test_dark_current_needs_times_and_some_time(times, shown):
    names = named([{"kind": "dark", "exposure_time": time} for time in times])
    assert ("dark_current" in names) == shown
    assert {"read_noise", "black_level"} <= names and "prnu" not in names


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
    assert {"prnu", "lens_shading", "full_well"} <= names


@pytest.mark.parametrize(("darks", "shown"), [(1, False), (2, True)])
def test_one_dark_does_not_tell_tails_from_the_defects_of_a_profile(darks, shown):
    captures = [{"kind": "dark", "exposure_time": 10.0}] * darks
    names = named(captures, sensor_of(effects=[HOT]))
    assert ({"heavy_tailed_noise", "dsnu", "hot_pixels"} <= names) == shown
    assert ("heavy_tailed_noise" in names) == shown
    assert "dark_current" in names and "heavy_tailed_noise" in named(captures)


def named_by_pixels(flats, pixels):
    """Return the names that flats of a level allow, whose frames are all in fit and in
    select, with pixels of their own in each."""
    every = [
        capture_of(
            "flat", n, name=f"{n}{group}", group=group, mask=mask, level=level
        )
        for n, level in enumerate(flats)
        for group, mask in zip(("fit", "select"), pixels, strict=True)
    ]  # fmt: skip
    splits = Splits(frames_of(SENSOR, every), Workers(1))
    return {
        e.name for e in nameable(CaptureSet(SENSOR, every), splits, set(BY_NAME))[0]
    }


@pytest.mark.parametrize(
    ("flats", "divided", "shown"),
    [
        ((0.3,), True, False),
        ((0.3, 0.3), True, True),
        ((0.3,), False, True),
        ((0.3, 0.6), True, True),
    ],
)
def test_one_flat_does_not_tell_pixels_from_photons(flats, divided, shown):
    thirds = [lambda group=g: third(SHAPE, group) for g in ("fit", "select")]
    names = named_by_pixels(flats, thirds if divided else [None, None])
    assert {"prnu", "shot_noise"} & names == (
        {"prnu", "shot_noise"} if shown else set()
    )
    assert "lens_shading" in names
