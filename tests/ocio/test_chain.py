# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Scene -> camera RGB by OCIO against float64, in DN of 16 bits."""

import itertools
import types

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from ocio.pixels import BLACK_AND_WHITE, kinds_of_pixels
from oracles import camera_transform

FULL_SCALE_DN = 65535.0
MAX_DN, MEAN_DN = 0.25, 0.01
# Float32 as such: the core, which computes in it without OCIO, has 0.020 DN there.
NEAR_HIGHLIGHTS_MEAN_DN = 0.025
LIGHTS = ("A", "D50", "D65", "2000K", "9000K", "sample:1")
DIGITAL_GAINS = (1.0, 0.6, 0.93, 1.2)
GAINS = (0.05, 0.999, 0.9999, 1.0, 1.3)


def transforms_of(profiles, convention, every_gain):
    """Return {what: CameraTransform}; each light has one digital gain, or every one."""
    gains = itertools.cycle(DIGITAL_GAINS)
    found = {}
    for profile, light in itertools.product(profiles, LIGHTS):
        for gain in DIGITAL_GAINS if every_gain else [next(gains)]:
            what = f"{profile.id} {light} {convention} x{gain}"
            found[what] = _core.camera_from_scene(
                profile, profile.illuminant(light), convention, gain, True
            )
        next(gains)
    return found


def by_hand(like, gains, **fields):
    """Return the CameraTransform like, with other gains and fields."""
    names = ("first", "two_steps", "second", "keep_highlights", "clip_result")
    copied = {name: getattr(like, name) for name in names}
    return types.SimpleNamespace(**{**copied, "gains": gains, **fields})


def check(chains_of, transforms, count):
    """Compare the chains of transforms with float64 on all kinds of pixels."""
    kinds = kinds_of_pixels(count)
    rgb = np.concatenate(list(kinds.values()))
    seen = chains_of("camera_from_scene", list(transforms.values()), rgb)
    cuts = np.cumsum([len(kind) for kind in kinds.values()])[:-1]
    for (what, transform), camera in zip(transforms.items(), seen, strict=True):
        expected = camera_transform.camera_from_scene(rgb, transform)
        error = np.abs(camera - expected) * FULL_SCALE_DN
        for kind, part in zip(kinds, np.split(error, cuts), strict=True):
            assert part.max() <= MAX_DN, f"{what}, {kind}"
            if kind == "near highlights":
                assert part.mean() <= NEAR_HIGHLIGHTS_MEAN_DN, f"{what}, {kind}"
        assert error.mean() <= MEAN_DN, what


@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_chain_is_the_transform(chains_of, profiles, convention):
    check(chains_of, transforms_of(profiles, convention, False), 700)


@pytest.mark.slow
@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_chain_is_the_transform_in_depth(chains_of, profiles, convention):
    check(chains_of, transforms_of(profiles, convention, True), 4000)


def test_any_gains(chains_of, profiles):
    """All triples: which channel is parked, which come first, and none to do."""
    like = [
        _core.camera_from_scene(profiles[0], profiles[0].illuminant("D65"), convention)
        for convention in ("dng", "paper")
    ]
    transforms = {
        f"{gains} {number}": by_hand(like[number % 2], gains)
        for number, gains in enumerate(itertools.product(GAINS, repeat=3))
    }
    check(chains_of, transforms, 700)


@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_highlights_need_not_be_kept(chains_of, profiles, convention):
    transforms = {
        profile.id: _core.camera_from_scene(
            profile, profile.illuminant("A"), convention, 1.0, False
        )
        for profile in profiles[:3]
    }
    check(chains_of, transforms, 700)


@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("words", ["neutral:1.3:0.05", "neutral:0.05:0.999"])
def test_impossible_lights_are_no_worse_than_in_the_core(
    chains_of, profiles, words, convention
):
    """Their matrices have entries of 20 and more: float32 itself is off by 1 DN."""
    rgb = np.concatenate(list(kinds_of_pixels(700).values()))
    transforms = [
        _core.camera_from_scene(p, p.illuminant(words), convention) for p in profiles
    ]
    seen = chains_of("camera_from_scene", transforms, rgb)
    for profile, transform, camera in zip(profiles, transforms, seen, strict=True):
        expected = camera_transform.camera_from_scene(rgb, transform)
        core = cg2raw.Sensor(profile.id).to_camera(
            rgb[None], illuminant=words, convention=convention
        )[0]
        limit = MAX_DN + np.abs(core - expected).max() * FULL_SCALE_DN
        assert np.abs(camera - expected).max() * FULL_SCALE_DN <= limit, profile.id


@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_what_is_no_radiance_is_black_or_white(chains_of, profiles, convention):
    rgb = np.array(sum(BLACK_AND_WHITE.values(), []), np.float32)
    blacks = len(BLACK_AND_WHITE["black"])
    transforms = transforms_of(profiles, convention, False).values()
    for camera in chains_of("camera_from_scene", list(transforms), rgb):
        white = camera[-1]  # of a scene at 2, which is legal
        assert white.min() > 0.5
        assert np.abs(camera[:blacks]).max() * FULL_SCALE_DN <= MAX_DN
        assert np.abs(camera[blacks:] - white).max() * FULL_SCALE_DN <= MAX_DN
