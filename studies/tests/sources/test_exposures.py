# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies.sources.exposures: gains are the core's, or of the captures."""

from dataclasses import replace

import numpy as np
import pytest

from studies.sources import exposures
from studies.sources.frames import words_of
from studies.sources.sets import material
from studies.world.exposure import exposed

COUNT = 12


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("sony-a7s-ii")


@pytest.fixture(scope="module")
def found(world, camera):
    return material(world, camera, "night", world.protocol.seeds, COUNT, 0)


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


def test_a_match_gives_renders_the_levels_of_captures(found, camera):
    """The ends of a dozen lie within a tenth of a stop of others, and are drawn in."""
    compared = exposures.matching(camera.sensor, found.captures, found.as_rendered)
    made = exposures.by_exposure(found, camera, 0)["ours, match"]()
    pairs = zip(made.images, words_of(made.neutrals), strict=True)
    images = [camera.sensor.to_scene(image, illuminant=word) for image, word in pairs]
    levels = [np.log2(np.median(image @ exposures.REC709)) for image in images]
    captured = [frame.level for frame in compared.captures]
    assert np.median(levels) == pytest.approx(np.median(captured), abs=0.3)
    assert np.std(levels) == pytest.approx(np.std(captured), rel=0.15)


def test_arms_differ_by_exposure_alone(found, camera):
    made = exposures.by_exposure(found, camera, 0)
    frames = {name: make() for name, make in made.items() if name.startswith("ours")}
    assert len(frames) == 7
    own = frames.pop("ours, as rendered")
    for name, other in frames.items():
        assert np.array_equal(own.neutrals, other.neutrals), name
        assert not np.array_equal(own.own[0], other.own[0]), name
    plain = exposures.by_exposure(replace(found, as_rendered=found.renders), camera, 0)
    same = plain["ours, as rendered"]()
    assert np.array_equal(same.own[0], frames["ours, dng"].own[0])
