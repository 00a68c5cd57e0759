# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Laws of both colourings: exact integrals, energy adds, white is white."""

from dataclasses import replace

import numpy as np
import pytest

from studies.world.colorimetry import albedos, d65, light_colours, observer
from studies.world.colouring import observed, rendered, seen
from studies.world.exposure import exposed
from studies.world.scene import Shot
from studies.world.shots import day_shots, night_shots

COLOURINGS = ("spectra", "render")


@pytest.fixture(scope="module")
def shots(world):
    mains = world.lights["test"].powers[:3]
    return day_shots(world, "test", 90, mains) + night_shots(world, "test", 90, 3)


@pytest.fixture(scope="module")
def sensitivities(camera_of):
    return camera_of("canon-600d").sensitivities


def test_a_pixel_is_the_integral_of_its_spectrum(shots, sensitivities):
    for shot in shots:
        image, scene = seen(shot, sensitivities), shot.scene
        for at in [(0, 0), (15, 38), (47, 63), (30, 20)]:
            mix = scene.leaves.mix[at]
            first, second = (
                scene.materials[index[at]]
                for index in (scene.leaves.first, scene.leaves.second)
            )
            bounce = 1.0 + scene.bounce[at] * scene.materials[scene.bounced]
            reflected = ((1.0 - mix) * first + mix * second) * bounce
            spectrum = sum(
                light * (shade[at] * reflected + emission[at])
                for light, shade, emission in zip(
                    shot.lights, scene.shades, scene.emission, strict=True
                )
            )
            assert image[at] == pytest.approx(spectrum @ sensitivities, rel=1e-5)


def test_an_observer_sees_the_main_light_as_white(shots):
    """A grey that it alone lights is as bright as it reflects, whatever the light."""
    for shot in shots:
        grey = np.full_like(shot.scene.materials, 0.5)
        lights = np.broadcast_to(shot.lights[0], shot.lights.shape)
        image = observed(Shot(replace(shot.scene, materials=grey), lights))
        xyz = seen(Shot(replace(shot.scene, materials=grey), lights), observer())
        np.testing.assert_allclose(image, xyz[..., [1, 1, 1]], rtol=1e-4, atol=1e-6)


def test_colours_under_d65_are_those_of_the_cie(shots):
    """Under D65 itself nothing is adapted: XYZ to Rec. 709."""
    import colour

    under = np.broadcast_to(d65(), shots[0].lights.shape)
    shot = Shot(shots[0].scene, under)
    xyz = seen(shot, observer())
    wanted = colour.XYZ_to_RGB(xyz, "sRGB")
    np.testing.assert_allclose(observed(shot), wanted, atol=2e-3 * wanted.max())


def test_a_render_multiplies_triples(shots):
    for shot in shots:
        image, scene, at = rendered(shot), shot.scene, (25, 10)
        light = light_colours(shot.lights, shot.lights[0])
        albedo = albedos(scene.materials)
        mix, bounced = scene.leaves.mix[at], albedo[scene.bounced]
        colour = (1 - mix) * albedo[scene.leaves.first[at]]
        colour = colour + mix * albedo[scene.leaves.second[at]]
        colour = colour * (1 + scene.bounce[at] * bounced)
        parts = zip(light, scene.shades, scene.emission, strict=True)
        expected = sum(rgb * (s[at] * colour + e[at]) for rgb, s, e in parts)
        assert image[at] == pytest.approx(expected, rel=1e-5)


def coloured(shot, colouring, sensitivities):
    return seen(shot, sensitivities) if colouring == "spectra" else rendered(shot)


@pytest.mark.parametrize("colouring", COLOURINGS)
def test_energy_adds(colouring, shots, sensitivities):
    """A frame under all lights is the sum of those under each."""
    for shot in shots:
        whole = coloured(shot, colouring, sensitivities)
        parts = 0.0
        for number in range(len(shot.lights)):
            alone = np.zeros_like(shot.scene.shades)
            seen_alone = alone.copy()
            alone[number] = shot.scene.shades[number]
            seen_alone[number] = shot.scene.emission[number]
            scene = replace(shot.scene, shades=alone, emission=seen_alone)
            parts = parts + coloured(
                replace(shot, scene=scene), colouring, sensitivities
            )
        np.testing.assert_allclose(whole, parts, rtol=1e-4, atol=1e-6)


def flat(shot):
    """Return a shot of greys under the main light alone."""
    grey = np.linspace(0.05, 0.9, len(shot.scene.materials))[:, None]
    materials = np.broadcast_to(grey, shot.scene.materials.shape)
    lights = np.broadcast_to(shot.lights[0], shot.lights.shape)
    return replace(shot, scene=replace(shot.scene, materials=materials), lights=lights)


def test_greys_under_one_light_are_neutral(shots, sensitivities):
    for shot in map(flat, shots):
        neutral = shot.lights[0] @ sensitivities
        balanced = seen(shot, sensitivities) / neutral
        for image in (balanced, rendered(shot)):
            np.testing.assert_allclose(image, image[..., [1, 1, 1]], rtol=1e-5)


def test_a_white_reflectance_is_white_to_a_renderer():
    grey = np.full((1, 81), 0.5)
    assert albedos(grey)[0] == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("colouring", COLOURINGS)
def test_frames_are_the_same_each_time(colouring, world, sensitivities):
    def frame():
        shots = day_shots(world, "train", 7, world.lights["train"].powers[:1])
        return coloured(shots[0], colouring, sensitivities)

    assert np.array_equal(frame(), frame())


def test_exposure_reaches_its_level_and_clips(shots, sensitivities):
    for shot in shots:
        image = exposed(seen(shot, sensitivities))
        assert image.dtype == np.float32
        assert 0.0 <= image.min() and image.max() <= 1.0
    for shot in shots[:3]:  # by day: a lamp's edge may be the quantile itself
        image = exposed(seen(shot, sensitivities))
        assert np.quantile(image.max(axis=2), 0.995) == pytest.approx(0.9, rel=1e-3)


def test_shapes_and_ranges_of_scenes(shots):
    for shot in shots:
        scene = shot.scene
        size = scene.leaves.mix.shape
        assert size == (48, 64)
        assert scene.shades.shape == scene.emission.shape == (len(shot.lights), *size)
        assert scene.shades.min() >= 0.0 and scene.emission.min() >= 0.0
        assert 0.0 <= scene.leaves.mix.min() and scene.leaves.mix.max() <= 1.0
        assert 0.0 < scene.materials.min() and scene.materials.max() < 1.0
        assert scene.bounce.min() >= 0.0
        # What hides the leaves is seen alone.
        hidden = scene.emission[1] > 0.0
        assert scene.shades[:, hidden].max(initial=0.0) == 0.0
