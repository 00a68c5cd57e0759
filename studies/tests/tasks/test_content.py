# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What frames show, of frames that were made to show it."""

from dataclasses import replace

import numpy as np
import pytest

from studies.results import appended
from studies.sources.frames import Frames
from studies.sources.sets import Draw, material, sources
from studies.tables_content import content_tables
from studies.tasks import content
from studies.tasks.isp import test_frames as isp_test_frames

NEUTRAL = np.array([0.5, 1.0, 0.7])


def frames(*balanced):
    """Return Frames whose balanced RGB are these."""
    images = [(image * NEUTRAL).astype(np.float32) for image in balanced]
    return Frames(images, np.tile(NEUTRAL, (len(images), 1)))


def halves(low, high):
    """Return an image of two halves, each of one colour."""
    image = np.empty((8, 10, 3))
    image[:, :5], image[:, 5:] = low, high
    return image


def test_brightness_saturation_and_steps_of_a_frame():
    grey = content.content_of(frames(halves([0.25] * 3, [1.0] * 3)))
    assert grey["brightness"] == pytest.approx(0.625)
    assert grey["saturation"] == pytest.approx(0.0, abs=1e-4)
    assert grey["steps"] == 0.0  # of 142 neighbours, 8 are at the edge
    red = content.content_of(frames(halves([0.8, 0.4, 0.4], [1.0, 0.5, 0.5])))
    assert red["saturation"] == pytest.approx(0.5, abs=1e-3)
    stripes = np.where(np.arange(10) % 2, 1.0, 0.25)[None, :, None] * np.ones((8, 1, 3))
    assert content.content_of(frames(stripes))["steps"] == pytest.approx(2.0, abs=1e-3)


def test_exposure_and_light_do_not_count():
    image = halves([0.2, 0.3, 0.1], [0.9, 0.7, 0.8])
    found = content.content_of(frames(image))
    assert content.content_of(frames(16.0 * image)) == found
    other = Frames([image.astype(np.float32)], np.ones((1, 3)))
    assert content.content_of(other) == pytest.approx(found, abs=0.05)


@pytest.mark.slow
def test_a_draw_has_all_sources_and_the_test_frames(world, camera_of):
    camera = camera_of("sony-a7s-ii")
    few = replace(world.protocol.isp, tests={"quick": 4})
    small = replace(world, protocol=replace(world.protocol, isp=few))
    tests = isp_test_frames(small, camera, "quick")
    entry = {}
    for seed in (0, 1):
        found = material(small, camera, "night", small.protocol.seeds, 6, seed)
        made = sources(found, camera, seed)
        draw = Draw(small, camera, "quick", seed)
        values = content.content_draw(draw, made, {"world": tests})
        entry = appended(entry, values["world"])
    assert list(entry)[0] == content.TESTS
    assert {len(v) for of in entry.values() for v in of.values()} == {2}
    real = np.mean(entry["real"]["brightness"])
    assert np.mean(entry["ours, dng"]["brightness"]) == pytest.approx(real, rel=0.5)
    text = content_tables({"sony-a7s-ii": entry})
    assert "2 draws" in text and "| ours, dng |" in text
