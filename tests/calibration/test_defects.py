# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pixels that do not respond, and flats that clip in places, move no number."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from calibration.planted import BLACK, GAIN, WHITE, frame_of, frames_of, sensor_of
from cg2raw.calibration import calibrate
from cg2raw.calibration.defects import responding, words_of

SHAPE = (128, 160)
SENSOR = sensor_of({"prnu": {"sigma": 0.006}}, shape=SHAPE)
PLACES = {
    "dead": (np.s_[:, 77], lambda above: 0 * above),
    "dim": (np.s_[50:52, :], lambda above: above / 2),
    "bright": (np.s_[90:100:3, 20:40:3], lambda above: above * 1.6),
    "block": (np.s_[0:32, 128:160], lambda above: 0 * above),
    "at white": (np.s_[:100, 12], lambda above: 0 * above + WHITE),
    "at 0": (np.s_[110, :], lambda above: 0 * above - BLACK),
}
LOOKS = {
    "gain": lambda c: c.figure("gain"),
    "prnu": lambda c: c.figure("PRNU"),
    "read noise": lambda c: c.figure("temporal dark noise"),
    "row noise": lambda c: c.figure("row noise"),
    "columns": lambda c: c.figure("fixed column pattern"),
    "black": lambda c: c.each("black level")[1],
}


# Rows are few, and a column that is missing has part of all of them: over eight seeds
# the differences have a standard deviation of 0.6 errors. No column has an offset: the
# root of a variance about 0 moves by as much as its interval is wide.
MOST = {"row noise": 1.8, "columns": 4.0}


def spoiled(one):
    """Return a frame with the defects of PLACES."""
    above = one.pixels() - BLACK
    for place, change in PLACES.values():
        above[place] = change(above[place])
    pixels = np.clip(np.rint(above + BLACK), 0, WHITE).astype(np.uint16)
    return replace(one, raw=lambda: pixels)


@pytest.fixture(scope="module")
def pair():
    """Return (frames with defects, what they show, what the same without them do)."""
    frames = frames_of(SENSOR, biases=4, darks=0, flats=3, flat_times=(0.3, 1.0))
    bad = [spoiled(one) for one in frames]
    return bad, calibrate(SENSOR, bad), calibrate(SENSOR, frames)


@pytest.mark.parametrize("name", LOOKS)
def test_defects_move_no_number(pair, name):
    """A tenth of the pixels is missing: estimates differ by a third of their errors,
    of which three may be."""
    _, found, clean = pair
    a, b = LOOKS[name](found), LOOKS[name](clean)
    assert abs(a.value - b.value) < MOST.get(name, 1.0) * b.standard_error, (a, b)


def test_defects_are_counted_and_named(pair):
    _, found, clean = pair
    where = np.zeros(SHAPE, bool)
    for place, _ in PLACES.values():
        where[place] = True
    assert clean.defects is None
    assert np.array_equal(found.defects, where)
    (note,) = (note for note in found.notes if "respond" in note)
    assert f"{where.sum()} of {where.size} pixels" in note
    assert "columns 12, 77; rows 50, 51, 110;" in note
    effects = json.loads(found.updated_profile())["effects"]
    assert [effect["name"] for effect in effects] == ["prnu"]


def test_dust_and_steep_shading_are_no_defects():
    rng = np.random.default_rng(2)
    y, x = np.mgrid[-1:1:128j, -1:1:160j]
    light = 8000 * (1 - 0.75 * ((x**2 + y**2) / 2) ** 2)
    light[60:70, 80:90] *= 0.7

    def frame(kind, number, above):
        noise = np.sqrt(above / GAIN + 9) * rng.normal(size=SHAPE)
        return frame_of(number, kind, BLACK + above + noise, 1.0)

    frames = [frame("dark", n, 0 * light) for n in range(2)]
    frames += [frame("flat", n, light) for n in range(2)]
    assert calibrate(SENSOR, frames).defects is None


def vignetted(seconds, seed, kind="flat", well=np.inf):
    """Return a frame behind a lens that loses 40 % at the corners; its middle gets
    14,500 DN a second, of GAIN electrons each."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[-1:1:128j, -1:1:160j]
    response = 1 - 0.4 * (x**2 + y**2) / 2
    response *= 1 + 0.005 * np.random.default_rng(0).normal(size=response.shape)
    light = 14500 * seconds * response if kind == "flat" else 0 * response
    above = np.minimum(rng.poisson(light * GAIN), well) / GAIN
    return frame_of(seed, kind, above + rng.normal(BLACK, 3, SHAPE), seconds)


@pytest.mark.parametrize("well", [np.inf, 14000 * GAIN])
def test_flats_whose_middle_clips_show_saturation_alone(well):
    """At white, or at a full well below: 1.05 s and more are bent; the error of the
    level of 20,480 pixels is 0.006 %."""
    times = (0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.15, 1.25, 1.35)
    frames = [vignetted(0.0, seed, "dark") for seed in range(1, 5)]
    lit = [t for t in times for _ in range(2)]
    frames += [vignetted(t, seed, well=well) for seed, t in enumerate(lit, 10)]
    found = calibrate(SENSOR, frames)
    assert found.transfer.clipped >= 4
    assert found.linearity.error.value < 0.02
    assert not found.linearity.quadratic.stands_out
    prnu, gain = found.figure("PRNU"), found.figure("gain")
    assert prnu.value == pytest.approx(0.005, abs=2e-4)
    assert abs(gain.value - GAIN) < 4 * gain.standard_error


@pytest.mark.parametrize(
    ("places", "words"),
    [
        ([np.s_[3, 5]], "1 of 600 pixels .* 1 pixel in rows 3 to 3, columns 5 to 5"),
        ([np.s_[3:5, 5], np.s_[9, 7]], "3 .* 3 pixels in rows 3 to 9, columns 5 to 7"),
        ([np.s_[:11, 4]], "11 of 600 pixels .* no number: column 4"),
        ([np.s_[:10, 4]], "10 .* 10 pixels in rows 0 to 9, columns 4 to 4"),  # a half
        (
            [np.s_[8, :], np.s_[2, 2]],
            "31 .* row 8; 1 other in rows 2 to 2, columns 2 to 2",
        ),
        ([np.s_[:, 3:7]], "80 .* columns 3, 4, 5, 6"),
        ([np.s_[:, 3:8]], "100 .* columns 3, 4, 5, 6, ..."),
    ],
)
def test_defects_are_told_by_lines_and_the_extent_of_the_rest(places, words):
    defects = np.zeros((20, 30), bool)
    for place in places:
        defects[place] = True
    assert re.search(f"^{words}$", words_of(defects))


@pytest.mark.parametrize(
    ("sigma", "response", "responds"),
    [
        (0.01, 0.68, True),
        (0.01, 0.65, False),
        (0.01, 1.32, True),
        (0.01, 1.35, False),
        (0.06, 0.60, True),  # of pixels that differ by more, 8 of their deviations
        (0.06, 0.04, False),  # of the median, of a pixel that has no light
    ],
)
def test_a_pixel_responds_within_a_third_of_its_surroundings(sigma, response, responds):
    """Whatever their light: it falls off to a half."""
    light = np.linspace(2000, 1000, 4000).reshape(50, 80)
    plane = light * (1 + sigma * np.random.default_rng(1).standard_normal(light.shape))
    plane[40, 9] = response * light[40, 9]
    found = responding(plane, light)
    assert found[40, 9] == responds and found.sum() >= found.size - 1
    assert responding(0 * plane, light).all()  # nothing is lit
