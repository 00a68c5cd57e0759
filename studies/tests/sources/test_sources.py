# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Laws of the sources: white is white, ours knows no sensitivities, draws repeat."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import cg2raw
from cg2raw.upi import gain_ranges
from studies.sources.frames import words_of
from studies.sources.ours import drawn, ours
from studies.sources.real import real
from studies.sources.upi import GAINS, upi
from studies.tasks.angles import degrees
from studies.world.colouring import rendered
from studies.world.scene import Shot
from studies.world.shots import card_lights, day_shots
from tiers import first_fast

CAMERAS = ("canon-600d", "nikon-d40", "sony-a7s-ii")
LEVELS = np.linspace(0.05, 0.8, 16, dtype=np.float32)
GREYS = np.repeat(LEVELS[None, :, None], 3, axis=2)


@pytest.fixture(scope="module")
def shots(world, camera_of):
    mains = card_lights(world, "test", camera_of("canon-600d").cards, 4)
    return day_shots(world, "test", 300, mains)


def sources(camera, found):
    """Return each source of renders, as it is used for training."""
    told = camera.told(found)
    return {
        **{
            f"ours, {convention}": partial(ours, sensor=told, convention=convention)
            for convention in ("dng", "paper")
        },
        "ours, spectral": partial(
            ours, sensor=camera.with_sensitivities(), convention="spectral"
        ),
        **{f"upi, {gains}": partial(upi, sensor=told, gains=gains) for gains in GAINS},
    }


@pytest.mark.parametrize("name", CAMERAS)
def test_white_is_the_neutral_in_all_sources(name, world, camera_of):
    """Greys of a render are the neutral that the source tells, to 1e-4 degrees of
    float32 pixels and of words of 6 digits."""
    camera = camera_of(name)
    found = camera.neutrals(card_lights(world, "train", camera.cards, 60))
    words = words_of(found[:5])
    for source, make in sources(camera, found).items():
        for lights in ([], words):
            if "spectral" in source and not lights:
                continue  # draws of a profile that was told no neutrals
            frames = make([GREYS] * 5, lights=lights)
            for image, neutral in zip(frames.images, frames.neutrals, strict=True):
                assert degrees(image / neutral, np.ones(3)).max() < 1e-2, source
                level = (image / neutral)[0, :, 1] / GREYS[0, :, 1]
                assert level == pytest.approx(level[0], rel=1e-4), source
            if lights:
                assert frames.neutrals == pytest.approx(found[:5], abs=2e-6), source


@pytest.mark.parametrize("name", CAMERAS)
def test_white_is_the_neutral_in_real(name, shots, camera_of):
    camera = camera_of(name)
    frames = real([white(shot) for shot in shots], camera.sensitivities)
    for image, neutral in zip(frames.images, frames.neutrals, strict=True):
        assert degrees(image / neutral, np.ones(3)).max() < 1e-3


def white(shot):
    """Return a shot of one grey under the main light alone."""
    materials = np.full_like(shot.scene.materials, 0.6)
    lights = np.broadcast_to(shot.lights[0], shot.lights.shape)
    return Shot(replace(shot.scene, materials=materials), lights)


@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("name", ["canon-600d", "nikon-d850"])
def test_ours_knows_no_sensitivities(name, convention, shots, camera_of):
    """Matrices and the neutral decide: other sensitivities change no bit."""
    camera = camera_of(name)
    profile = json.loads(camera.sensor.to_json())
    assert profile.pop("spectral_sensitivities")
    without = cg2raw.Sensor.from_json(json.dumps(profile), name)
    renders = [rendered(shot) for shot in shots]
    words = words_of(camera.neutrals(np.array([shot.lights[0] for shot in shots])))
    for lights in (words, []):
        one, other = (
            ours(renders, told, convention, lights=lights)
            for told in (sensor_told(camera.sensor, words), sensor_told(without, words))
        )
        assert np.array_equal(one.images, other.images)
        assert np.array_equal(one.neutrals, other.neutrals)


def sensor_told(sensor, words):
    profile = json.loads(sensor.to_json())
    ratios = [[float(value) for value in word.split(":")[1:]] for word in words]
    profile["illuminants"] = {"neutrals": ratios}
    return cg2raw.Sensor.from_json(json.dumps(profile), sensor.id)


def test_draws_of_two_seeds_share_none():
    assert not set(drawn(40, 0)) & set(drawn(40, 1))
    assert drawn(40, 3) == drawn(40, 3)


@pytest.mark.parametrize("gains", first_fast(GAINS, 1))
def test_upi_draws_within_its_ranges_and_repeats(gains, world, camera_of):
    camera = camera_of("canon-600d")
    found = camera.neutrals(card_lights(world, "train", camera.cards, 60))
    told = camera.told(found)
    ranges = {
        "published": ((1.9, 2.4), (1.5, 1.9)),
        "camera": gain_ranges(told),
        "graphics2raw": ((1.0, 3.3), (1.3, 4.4)),
    }[gains]
    one, again, other = (upi([GREYS] * 200, told, gains, seed=s) for s in (0, 0, 1))
    assert np.array_equal(one.neutrals, again.neutrals)
    assert np.array_equal(one.images, again.images)
    assert not np.array_equal(one.neutrals, other.neutrals)
    for channel, (low, high) in zip((0, 2), ranges, strict=True):
        drawn_gains = 1.0 / one.neutrals[:, channel]
        assert low - 1e-4 <= drawn_gains.min() and drawn_gains.max() <= high + 1e-4
        # The two ends are met: 200 draws leave 5 % at an end with chance 4e-5.
        margin = 0.05 * (high - low)
        assert drawn_gains.min() < low + margin and drawn_gains.max() > high - margin


def test_ours_draws_what_it_was_told(world, camera_of):
    """Drawn neutrals lie where those told do: their mean is within a quarter of the sd,
    since a profile draws from a normal distribution that their hull cuts off."""
    camera = camera_of("nikon-d40")
    found = camera.neutrals(card_lights(world, "train", camera.cards, 200))
    frames = ours([GREYS] * 300, camera.told(found))
    apart = np.abs(frames.neutrals.mean(axis=0) - found.mean(axis=0))
    assert np.all(apart <= 0.25 * found.std(axis=0))


def test_a_lower_frame_count_draws_the_same_lights_first():
    assert drawn(10, 0) == drawn(40, 0)[:10]
