# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames of several amplifiers are refused, with size and place; others are not."""

import numpy as np
import pytest

from calibration.planted import frame_of
from cg2raw import Sensor
from cg2raw.calibration import calibrate
from cg2raw.calibration.parts import step_of_halves
from oracles import cameras

SHAPE = (96, 128)
BLACK, GAIN, READ = 256, 2.0, 4.0  # DN, e-/DN, DN
MONO = Sensor.from_json(cameras.mono_text(id="parts", black_level=BLACK, noise=[]))
LEFT = np.s_[:, :64]
BOTTOM = np.s_[48:, :]
STRIPE = np.s_[:, 32:64]
QUADRANT = np.s_[48:, 64:]
EVEN = np.s_[:, ::2]
ROWS = np.s_[1::2, :]


def frames_of(offset=0.0, gain=1.0, noise=1.0, light=1.0):
    """Return four darks and four flats; each argument is of a pixel, or of all."""
    frames = []
    response = 1 + 0.004 * np.random.default_rng(0).normal(size=SHAPE)
    for number in range(8):
        rng = np.random.default_rng([1, number])
        level = 6000 * (number > 3)
        charge = rng.poisson(level * GAIN * response * light, SHAPE)
        above = charge / GAIN * gain + rng.normal(0, READ, SHAPE) * noise
        kind, seconds = ("flat", 1.0) if level else ("dark", 0.0)
        frames.append(frame_of(number, kind, above + BLACK + offset, seconds))
    return frames


def part(place, inside, outside=1.0):
    """Return (H, W): one value in a part, another outside."""
    found = np.full(SHAPE, outside)
    found[place] = inside
    return found


@pytest.mark.parametrize(
    ("differs", "words"),
    [
        (
            {"offset": part(LEFT, 5, 0)},
            ["black level by", "at column 64"],
        ),
        ({"offset": part(BOTTOM, 5, 0)}, ["top and bottom", "level", "at row 48"]),
        ({"gain": part(LEFT, 1.05)}, ["left and right", "response by"]),
        ({"noise": part(BOTTOM, 1.5)}, ["top and bottom", "variance of the read"]),
        ({"offset": part(STRIPE, 4, 0)}, ["left and right", "at columns 32, 64"]),
        ({"gain": part(EVEN, 1.02)}, ["odd and even columns", "response by 1.9"]),
        ({"offset": part(QUADRANT, 4, 0)}, ["left and right", "at column 64"]),
        ({"offset": part(ROWS, 2, 0)}, ["odd and even rows", "black level by 2"]),
    ],
)
def test_parts_that_differ_are_refused(differs, words):
    with pytest.raises(ValueError, match="amplifiers of their own") as error:
        calibrate(MONO, frames_of(**differs))
    assert all(word in str(error.value) for word in words), error.value


def test_what_one_amplifier_has_is_no_step():
    """First columns, a ramp, columns' pattern, a hot column in the middle, vignetting
    whose centre is off, dust, a tilted lamp and a glow that is noisy."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[-1:1:96j, -1:1:128j]
    offset = 12 * np.exp(-np.arange(128) / 12) + 6 * x + rng.normal(0, 1, 128)
    offset[:, 63] += 60
    dust = np.s_[30:44, 60:74]
    light = (1 - 0.5 * ((x - 0.2) ** 2 + y**2) / 2) * (1 + 0.1 * x)
    light[dust] *= 0.75
    noise = 1 + np.exp(-np.hypot(1 - x, 1 - y) / 0.4)
    found = calibrate(MONO, frames_of(offset=offset, light=light, noise=noise))
    assert found.transfer.points and found.structure.edge is not None


def test_a_step_below_the_noise_is_no_reason_to_refuse():
    found = calibrate(MONO, frames_of(offset=part(LEFT, 0.5, 0)))
    assert found.figure("PRNU").value == pytest.approx(0.004, rel=0.05)


@pytest.mark.parametrize(
    ("planted", "error", "side", "found"),
    [
        (0.2, 0.01, 8, 0.2),
        (-0.2, 0.01, 8, 0.2),
        (0.09, 0.0001, 8, 0.0),  # moves no number
        (0.2, 0.1, 8, 0.0),  # within chance: 8 errors of four means of 8 blocks
        (0.2, 0.01, 9, 0.0),  # no halves
        (0.2, 0.01, 2, 0.0),  # no slope beside them
    ],
)
def test_a_step_of_noise_between_halves_is_relative_and_without_a_slope(
    planted, error, side, found
):
    along = np.arange(side)
    lines = 1 + 0.01 * along + planted * (along >= side // 2)
    blocks, errors = np.tile(lines, side), np.full(side**2, error)
    step = step_of_halves(blocks, errors, axis=1)
    assert step == pytest.approx(found / lines.mean())
    assert step_of_halves(blocks, errors, axis=0) == 0
    blocks[3] = np.nan
    assert step_of_halves(blocks, errors, axis=1) == 0
