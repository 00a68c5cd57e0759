# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies.sources.sets: what the sources of a seed share, and seeds do not."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from studies.sources import sets
from studies.sources.renders import Renders
from studies.world.shots import KINDS

COUNT = 4


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("canon-600d")


@pytest.fixture(scope="module")
def material(world, camera):
    """Return material(seed, kind): what all sources of a seed share, made once."""

    @cache
    def make(seed, kind="day"):
        return sets.material(world, camera, kind, world.protocol.seeds, COUNT, seed)

    return make


@pytest.mark.parametrize("kind", KINDS)
def test_seeds_share_no_frame(material, kind):
    first, second = (material(seed, kind) for seed in (0, 1))
    for a in (*first.captures.images, *first.other_captures.images):
        for b in (*second.captures.images, *second.other_captures.images):
            assert not np.array_equal(a, b)
    for a in first.captures.images:
        assert not any(np.array_equal(a, b) for b in first.other_captures.images)


def test_all_sources_have_as_many_frames_of_one_size(material, camera):
    found = material(0)
    for name, make in sets.sources(found, camera, 0).items():
        made = make()
        assert len(made.images) == len(made.neutrals) == COUNT, name
        assert {image.shape for image in made.images} == {(48, 64, 3)}, name
        assert np.isfinite(np.stack(made.images)).all(), name


def test_renders_are_exposed_before_any_source_saturates(material):
    """What a source clips is little: the highlights of the renders themselves."""
    for kind in KINDS:
        found = material(0, kind)
        shares = [(image > 1.0).any(axis=2).mean() for image in found.renders]
        assert max(shares) < 0.006


def test_renders_of_a_folder_take_the_place_of_the_worlds(world, material, camera):
    images = [np.full((50, 66, 3), level, np.float16) for level in (1.0, 4.0, 8.0)]
    seeds = world.protocol.seeds
    given = Renders(images, (48, 64), "")
    found = sets.material(world, camera, "night", seeds, 3, 0, rendered_images=given)
    own = material(0, "night")
    assert np.array_equal(found.captures.images[0], own.captures.images[0])
    assert {image.shape for image in found.renders} == {(48, 64, 3)}
    assert np.ptp(np.stack(found.renders)) < 1e-6  # each at its own exposure


def test_ours_knows_the_neutrals_of_captures_alone(material, camera):
    """Planted ones, in a corner that no capture is in, are where all lights are drawn;
    what is no number is never looked at."""
    found = material(0)
    low, high = np.array([0.30, 1.0, 0.40]), np.array([0.34, 1.0, 0.44])
    own = found.captures.neutrals
    assert not ((own > low - 0.01) & (own < high + 0.01))[:, [0, 2]].all(axis=1).any()
    planted = np.random.default_rng(8).uniform(low, high, own.shape)
    told = replace(
        found,
        captures=replace(found.captures, images=[], neutrals=planted),
        other_captures=replace(
            found.other_captures, neutrals=np.full_like(own, np.nan)
        ),
    )
    drawn = sets.sources(told, camera, 0)["ours, dng"]().neutrals
    assert ((drawn > low - 0.01) & (drawn < high + 0.01))[:, [0, 2]].all()
    assert len(np.unique(drawn, axis=0)) == COUNT
