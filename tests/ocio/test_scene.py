# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Camera RGB -> scene by OCIO, and there and back; the unbounded twin."""

import numpy as np
import PyOpenColorIO as ocio
import pytest

from cg2raw import _core
from cg2raw_ocio import chain
from ocio.chain_runner import applied
from ocio.pixels import kinds_of_pixels
from oracles import camera_transform

MAX_DN = 0.25 / 65535.0
LIGHTS = ("A", "D65", "2000K", "9000K")
SAFE = 0.9  # highlights begin here


def transforms_of(profiles, convention):
    return [
        _core.camera_from_scene(profile, profile.illuminant(light), convention, 0.9)
        for profile in profiles
        for light in LIGHTS
    ]


def scale_of(transform):
    """Return how much the way back to the scene amplifies an error."""
    back = np.linalg.inv(np.asarray(transform.second) @ transform.first)
    return np.abs(back / transform.gains).sum(axis=1).max()


@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_to_the_scene_as_a_camera_goes(chains_of, profiles, convention):
    camera = np.concatenate(list(kinds_of_pixels(700).values()))
    transforms = transforms_of(profiles, convention)
    seen = chains_of("scene_from_camera", transforms, camera)
    for transform, scene in zip(transforms, seen, strict=True):
        expected = camera_transform.scene_from_camera(camera, transform)
        assert np.abs(scene - expected).max() <= MAX_DN * scale_of(transform)


@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_below_highlights_there_and_back_is_identity(profiles, convention):
    """And so for colours inside the camera's gamut alone: what it clips is lost."""
    rgb = np.random.default_rng(3).random((4000, 3)).astype(np.float32)
    for transform in transforms_of(profiles, convention):
        inner = rgb.astype(float) @ np.asarray(transform.first).T
        seen = inner @ np.asarray(transform.second).T
        steps = np.concatenate([inner, seen, seen * transform.gains], axis=1)
        kept = ((steps > 0.0) & (steps < 1.0)).all(axis=1)
        kept &= seen.mean(axis=1) < SAFE
        assert kept.mean() > 0.3
        camera = applied("camera_from_scene", transform, rgb)
        back = applied("scene_from_camera", transform, camera)
        assert np.abs(back - rgb)[kept].max() <= MAX_DN * scale_of(transform)


@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_the_unbounded_twin_has_an_inverse(profiles, convention):
    """Also of HDR and of negative values: 1e-6 of the brightest channel."""
    rng = np.random.default_rng(4)
    rgb = rng.uniform(-1.0, 1.0, (4000, 3)) * 10.0 ** rng.uniform(-3, 5, (4000, 1))
    rgb = rgb.astype(np.float32)
    largest = np.abs(rgb).max(axis=1, keepdims=True)
    for transform in transforms_of(profiles, convention):
        [matrix] = chain.camera_from_scene_unbounded(transform)
        there, back = (
            ocio.Config.CreateRaw().getProcessor(matrix, d).getDefaultCPUProcessor()
            for d in (ocio.TRANSFORM_DIR_FORWARD, ocio.TRANSFORM_DIR_INVERSE)
        )
        camera = rgb.copy()
        there.applyRGB(camera)
        product = np.diag(transform.gains) @ transform.second @ transform.first
        assert (np.abs(camera - rgb @ product.T) <= 1e-6 * largest).all()
        back.applyRGB(camera)
        assert (np.abs(camera - rgb) / largest).max() <= 5e-7 * scale_of(transform)


@pytest.mark.parametrize("convention", ["dng", "paper"])
def test_the_twin_is_the_raw_below_highlights(profiles, convention):
    rgb = np.random.default_rng(5).uniform(0.3, 0.6, (500, 3)).astype(np.float32)
    for transform in transforms_of(profiles, convention)[::9]:
        raw, twin = (
            applied(f"camera_from_scene{kind}", transform, rgb)
            for kind in ("", "_unbounded")
        )
        colour = rgb @ np.asarray(transform.first).T
        kept = ((colour > 0.0) & (colour < 1.0)).all(axis=1)
        seen = colour @ np.asarray(transform.second).T
        kept &= ((seen > 0.0) & (seen < 1.0)).all(axis=1)
        assert kept.mean() > 0.3
        assert np.abs(raw - twin)[kept].max() <= MAX_DN
