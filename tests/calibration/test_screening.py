# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A frame that is none of its repeats is excluded by name; of two that differ, both are
named and neither is believed."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.planted import BLACK, frames_of, sensor_of
from cg2raw.calibration import UniformFrame, calibrate
from cg2raw.calibration.frames import by_level, groups_of, in_steps, scan, screened
from cg2raw.calibration.sites import sites_of

SENSOR = sensor_of({"prnu": {"sigma": 0.01}}, shape=(64, 96))
FRAMES = frames_of(SENSOR, biases=5, darks=5, flats=5)


def spoiled(number, change):
    """Return FRAMES of which one is changed."""
    one = FRAMES[number]
    raw = change(one.pixels().astype(float))
    pixels = np.clip(np.rint(raw), 0, 16383).astype(np.uint16)
    return [*FRAMES[:number], replace(one, raw=lambda: pixels), *FRAMES[number + 1 :]]


def truncated(raw):
    """Return a frame whose last rows were never written."""
    raw[-8:] = 0
    return raw


@pytest.mark.parametrize(
    ("number", "change", "words"),
    [
        (7, lambda raw: raw + 1500, "DN above that of the 4 other darks of 30 s"),
        (2, lambda raw: 0 * raw + 256, "its noise is 0.50 DN"),
        (3, truncated, "12.5% of its pixels are far off"),
        (12, truncated, "12.5% of its pixels are far off"),
        (12, lambda raw: 256 + (raw - 256) / 2, "its level is"),
    ],
)
def test_a_frame_off_its_repeats_is_excluded(number, change, words):
    scanned = [scan(f, sites_of(SENSOR), SENSOR) for f in spoiled(number, change)]
    groups, excluded = screened(groups_of(scanned), np.array([BLACK]))
    assert list(excluded) == [FRAMES[number].name]
    assert words in excluded[FRAMES[number].name]
    assert sum(len(group.frames) for group in groups) == len(FRAMES) - 1


def brief(frames):
    """Return biases and flats, without what takes longest, the darks of 30 s."""
    return [frame for frame in frames if frame.exposure_time < 30]


def test_an_excluded_frame_moves_no_number():
    found = calibrate(SENSOR, brief(spoiled(2, lambda raw: raw + 1500)))
    clean = calibrate(SENSOR, brief([*FRAMES[:2], *FRAMES[3:]]))
    assert any(note.startswith("dark-2: its level is 1") for note in found.notes)
    assert found.updated_profile() == clean.updated_profile()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda raw: raw + 1500,
            "dark-7: is 1499.* DN above dark-5, and both have one",
        ),
        (
            lambda raw: (
                BLACK + 5 * (raw - BLACK) + np.arange(64 * 96).reshape(64, 96) % 5
            ),
            r"dark-7: its noise is 15\.\d\d DN, that of dark-5 2\.9\d DN, and both",
        ),
    ],
)
def test_two_repeats_that_differ_are_refused_by_name(change, words):
    frames = spoiled(7, change)
    with pytest.raises(ValueError, match=words):
        calibrate(SENSOR, [*frames[:6], frames[7], *frames[10:]])


@pytest.mark.parametrize("step", [1, 4])
def test_a_first_look_is_at_levels_noise_and_ends_of_codes(step):
    """Of sites that are 100 steps apart, each of which has its share of 1 % at white;
    these count neither in the level nor in the noise."""
    shape, rng = (64, 96), np.random.default_rng(2)
    levels = np.array([500.0, 600.0, 700.0, 800.0])
    raw = np.tile(levels.reshape(2, 2), (32, 48)) + 20 * rng.standard_normal(shape)
    raw = step * np.rint(raw)
    raw[:8, :8] = white = SENSOR.white_level  # 16 of each site
    frame = UniformFrame("a", "flat", lambda: raw.astype(np.uint16))
    found = scan(frame, sites_of(SENSOR), SENSOR)
    assert found.shape == shape and found.step == step
    assert found.level == pytest.approx(step * levels, abs=step * 4 * 20 / 1520**0.5)
    assert found.noise == pytest.approx(20 * step, rel=0.05)
    assert found.far == pytest.approx(1 / 96)
    assert found.saturated == found.at_highest == 1 / 96
    assert (found.highest, found.cut) == (white, 0.0)
    assert found.spacing == 4 * (step,) and found.codes > 80


@pytest.mark.parametrize(("kind", "share"), [("dark", 0.5), ("flat", 0.0)])
def test_noise_is_cut_in_darks_alone(kind, share):
    """Half of a normal law about 0."""
    noise = 20 * np.random.default_rng(3).standard_normal((64, 96))
    raw = np.rint(np.maximum(noise, 0)).astype(np.uint16)
    found = scan(UniformFrame("a", kind, lambda: raw), sites_of(SENSOR), SENSOR)
    assert found.cut == pytest.approx(share, abs=0.1)


@pytest.mark.parametrize(
    ("levels", "groups"),
    [
        ([500, 100, 104, 501], [[1, 2], [0, 3]]),
        ([100, 105, 110.25], [[0, 1, 2]]),  # steps of 5 %, of neighbours
        ([105.01, 100], [[1], [0]]),
        ([0, 300, 0], [[0, 2], [1]]),
    ],
)
def test_flats_whose_levels_differ_by_no_more_than_5_percent_repeat(levels, groups):
    assert by_level(range(len(levels)), levels) == groups


def looked_at(step, name="a", top=None):
    """Return a first look at a flat of codes that are so many DN apart. top : DN of a
    tenth of the pixels."""
    raw = step * np.rint(np.random.default_rng(3).normal(500, 20, (64, 96)))
    if top is not None:
        raw.flat[::10] = top
    frame = UniformFrame(name, "flat", lambda: raw.astype(np.uint16))
    return scan(frame, sites_of(SENSOR), SENSOR)


@pytest.mark.parametrize(("steps", "common"), [((4, 4), 4), ((1, 1), 1)])
def test_frames_have_one_step_of_codes(steps, common):
    step, found = in_steps([looked_at(n) for n in steps], SENSOR.white_level)
    assert step == common and len(found) == 2


def test_a_frame_of_wider_steps_than_others_is_refused():
    with pytest.raises(ValueError, match="b: only one in 4 DN occurs, in other frames"):
        in_steps([looked_at(1), looked_at(4, "b")], SENSOR.white_level)


@pytest.mark.parametrize(("top", "share"), [(16380, 0.1), (16376, 0.0), (16383, 0.1)])
def test_the_last_code_of_a_step_below_white_is_saturated(top, share):
    """Of 4 DN: no code is between 16380 and white at 16383."""
    _, [found] = in_steps([looked_at(4, top=top)], SENSOR.white_level)
    assert found.saturated == pytest.approx(share, abs=1e-3)
