# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies.sources.exposures: gains are the core's, or of the captures."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from studies.sources import exposures
from studies.sources.frames import words_of
from studies.sources.sets import material
from studies.sources.upi import drawn_global_gains
from studies.world.exposure import exposed

COUNT = 12


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("sony-a7s-ii")


@pytest.fixture(scope="module")
def found(world, camera):
    return material(world, camera, "night", world.protocol.seeds, COUNT, 0)


@pytest.fixture(scope="module")
def made(found, camera):
    """Return {source: make}; what is made once is given again."""
    by_source = exposures.by_exposure(found, camera, 0)
    return {name: cache(make) for name, make in by_source.items()}


def stops(found, camera, exposure, seed=0):
    """Return the stops of each render, at whatever exposure it comes."""
    images = exposures.exposed_by(camera.sensor, found.as_rendered, exposure, seed)
    pairs = zip(images, found.as_rendered, strict=True)
    return np.array([np.log2(image.sum() / own.sum()) for image, own in pairs])


def test_each_frame_has_a_gain_of_its_own_by_seed(found, camera):
    assert stops(found, camera, "0") == pytest.approx(0.0, abs=1e-5)
    assert stops(found, camera, "1.5") == pytest.approx(1.5, abs=1e-4)
    drawn = stops(found, camera, "random:0:2")
    assert len(set(drawn.round(3))) == COUNT and 0.0 <= drawn.min() < drawn.max() <= 2.0
    assert np.array_equal(drawn, stops(found, camera, "random:0:2"))
    assert not np.isin(drawn, stops(found, camera, "random:0:2", seed=1)).any()
    assert np.ptp(stops(found, camera, "auto")) > 0.5


def test_renders_are_as_bright_as_captures_in_the_median(found, camera):
    """Renders that are the captures themselves, 3 stops darker, need 3 stops."""
    developed = [
        camera.sensor.to_scene(exposed(image), illuminant=word) / np.float32(8.0)
        for image, word in zip(
            found.captures.images, words_of(found.captures.neutrals), strict=True
        )
    ]
    stops = exposures.darker(camera.sensor, found.captures, developed)
    assert stops == pytest.approx(3.0, abs=1e-4)


def test_a_match_gives_renders_the_levels_of_captures(found, camera, made):
    """The ends of a dozen lie within a tenth of a stop of others, and are drawn in."""
    compared = exposures.matching(camera.sensor, found.captures, found.as_rendered)
    frames = made["ours, match"]()
    pairs = zip(frames.images, words_of(frames.neutrals), strict=True)
    images = [camera.sensor.to_scene(image, illuminant=word) for image, word in pairs]
    levels = [np.log2(np.median(image @ exposures.REC709)) for image in images]
    captured = [frame.level for frame in compared.captures]
    assert np.median(levels) == pytest.approx(np.median(captured), abs=0.3)
    assert np.std(levels) == pytest.approx(np.std(captured), rel=0.15)


def test_methods_get_the_same_exposed_renders(found, made):
    """By scenes, which are the renders as they were exposed: ours' are UPI's."""
    frames = {name: make() for name, make in made.items()}
    for name in (*exposures.EXPOSURES, exposures.MATCH):
        ours_, upis = frames[f"ours, {name}"], frames[f"upi, {name}"]
        assert np.array_equal(ours_.scenes, upis.scenes), name
        assert not np.array_equal(ours_.images, upis.images), name
    names = [
        name for name in frames if name.startswith("ours") and "global" not in name
    ]
    own = frames["ours, own"]
    assert np.array_equal(own.scenes, found.as_rendered)
    for name in set(names) - {"ours, own"}:
        assert np.array_equal(own.neutrals, frames[name].neutrals), name
        assert not np.array_equal(own.images[0], frames[name].images[0]), name


def test_global_gains_are_upis_in_both_of_a_pair(found, camera, made):
    gains = drawn_global_gains(COUNT, camera.told(found.captures.neutrals), 0)
    assert np.mean(gains) == pytest.approx(0.8, abs=0.1) and np.std(gains) > 0.03
    for method in ("ours", "upi"):
        plain, dark = (made[f"{method}, match{of}"]() for of in ("", ", global gains"))
        for gain, bright, image, scene, before in zip(
            gains, plain.images, dark.images, dark.scenes, plain.scenes, strict=True
        ):
            assert np.allclose(scene, gain * before, rtol=1e-5, atol=0)
            low = (bright.max(axis=2) < 0.3) & (bright.min(axis=2) > 1e-3)
            assert np.allclose(image[low], gain * bright[low], rtol=0.02)


def test_without_a_matrix_a_render_is_multiplied_by_the_neutral(made):
    frames, ours_ = made["no matrix, match"](), made["ours, match"]()
    assert np.array_equal(frames.neutrals, ours_.neutrals)
    for image, scene, neutral in zip(
        frames.images, ours_.scenes, frames.neutrals, strict=True
    ):
        assert np.allclose(image, scene * neutral, rtol=1e-5, atol=0)


@pytest.mark.slow
def test_the_worlds_scenes_are_a_source_if_renders_are_others(found, camera, made):
    other = replace(found, as_rendered=[image * 2 for image in found.as_rendered])
    name = "ours, match, world's scenes"
    assert name not in made
    of_others = exposures.by_exposure(other, camera, 0)
    # Twice as bright, the same images are at the same levels once they match, to the
    # bins of the match's levels.
    both = of_others[name]().images, of_others["ours, match"]().images
    pairs = zip(*both, strict=True)
    ratios = [np.median(one) / np.median(same) for one, same in pairs]
    assert ratios == pytest.approx(np.ones(COUNT), rel=0.02)
