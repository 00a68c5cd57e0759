# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source translation: its translator's frames times neutrals, and nothing else."""

import numpy as np
import pytest

from studies.sources.frames import Frames, words_of
from studies.sources.ours import drawn, ours
from studies.sources.translation import balanced, translation
from studies.sources.upi import GAINS, upi
from studies.world.exposure import exposed
from studies.world.shots import card_lights

RNG = np.random.default_rng(3)
RENDERS = list(RNG.uniform(0.0, 3.0, (12, 24, 32, 3)).astype(np.float32))
for each in RENDERS:
    each[0, :2] = 30.0  # lamps: two pixels, which exposure clips
MATRIX = np.array([[0.6, 0.3, 0.1], [0.2, 0.7, 0.1], [0.1, 0.3, 0.6]], np.float32)


def by_matrix(images):
    """A translator of a known colour matrix."""
    return [image @ MATRIX.T for image in images]


@pytest.fixture(scope="module")
def told(world, camera_of):
    camera = camera_of("canon-600d")
    lights = card_lights(world, "train", camera.cards, 60)
    return camera.told(camera.neutrals(lights))


@pytest.mark.parametrize("lights", [(), drawn(len(RENDERS), 2)])
def test_frames_are_the_translators_times_the_neutral(told, lights):
    """To 1e-6 of float32. Scenes are what the sensor's matrices make of them."""
    frames = translation(RENDERS, by_matrix, told, lights=lights, seed=2)
    assert frames.sensors == ()
    words = words_of(frames.neutrals)
    for image, scene, neutral, word, render in zip(
        frames.images, frames.scenes, frames.neutrals, words, RENDERS, strict=True
    ):
        assert image.dtype == np.float32
        wanted = exposed(render) @ MATRIX.T * neutral
        np.testing.assert_allclose(image, wanted, atol=1e-6)
        developed = told.to_scene(image, illuminant=word)
        np.testing.assert_allclose(scene, developed, atol=1e-4)


def test_the_translator_sees_exposed_renders(told):
    seen = []

    def identity(images):
        seen.extend(images)
        return list(images)

    translation(RENDERS, identity, told)
    for image, render in zip(seen, RENDERS, strict=True):
        assert np.array_equal(image, exposed(render))


@pytest.mark.parametrize("gains", GAINS)
def test_gains_are_those_that_upi_draws(told, gains):
    for seed in (0, 1):
        frames = translation(RENDERS, by_matrix, told, gains, seed=seed)
        other = upi(RENDERS, told, gains, seed=seed)
        assert np.array_equal(frames.neutrals, other.neutrals)


def test_our_lights_are_those_that_ours_draws(told):
    lights = drawn(len(RENDERS), 1)
    frames = translation(RENDERS, by_matrix, told, lights=lights)
    assert np.array_equal(frames.neutrals, ours(RENDERS, told, seed=1).neutrals)


def test_balanced_captures_have_no_light_in_them():
    """A scene under two lights is the same once balanced."""
    neutrals = np.array([[0.4, 1.0, 0.7], [0.8, 1.0, 0.3]])
    scene = RENDERS[0]
    images = [(2.0 * scene * neutral).astype(np.float32) for neutral in neutrals]
    one, other = balanced(Frames(images, neutrals))
    np.testing.assert_allclose(one, exposed(scene), atol=1e-6)
    np.testing.assert_allclose(one, other, atol=1e-6)
