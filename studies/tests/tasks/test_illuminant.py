# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 1: thumbnails, what is missing without PyTorch, a run of a few frames."""

import importlib.util
from dataclasses import replace

import numpy as np
import pytest

from studies.results import appended
from studies.sources.frames import Frames
from studies.sources.sets import Draw, material, sources
from studies.summaries import reduced
from studies.tables_illuminant import illuminant_tables, light_tables
from studies.tasks import illuminant as study


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("canon-600d")


@pytest.fixture(scope="module")
def small(world):
    """The world with few frames and epochs."""
    few = {"frames": {"quick": 12}, "tests": {"quick": 8}}
    rules = replace(world.protocol.illuminant, **few, epochs={"quick": 2}, batch=8)
    return replace(world, protocol=replace(world.protocol, illuminant=rules))


def test_thumbnails_are_means_of_what_the_sensor_keeps(small, camera):
    tests = study.test_frames(small, camera, "quick")
    small_images = study.thumbnails(tests, 3)
    assert small_images.shape == (8, 16, 21, 3)
    assert small_images.min() >= 0.0 and small_images.max() <= 1.0


def test_test_frames_are_sorted_by_their_main_lights(small, camera):
    """Each of them is once in a range; LEDs are lit by other lights."""
    whole = study.test_frames(small, camera, "quick")
    found = study.tests_by_light(small, camera, "quick")
    leds = found.pop(study.LEDS)
    neutrals = np.concatenate([frames.neutrals for frames in found.values()])
    assert sorted(neutrals.tolist()) == sorted(whole.neutrals.tolist())
    assert len(leds.images) == 8
    assert not {tuple(n) for n in leds.neutrals} & {tuple(n) for n in whole.neutrals}
    # Red over blue falls from warm lights to cold ones.
    warmth = [np.median(f.neutrals[:, 0] / f.neutrals[:, 2]) for f in found.values()]
    assert warmth == sorted(warmth, reverse=True)


def test_means_stand_by_light_with_leds_in_training_and_without():
    def entry(degrees):
        return reduced({"real": np.full((2, 4), degrees).tolist()})

    with_leds = {"below 3500 K": {"a": entry(1.0)}, "LED lamps": {"a": entry(2.0)}}
    without = {"below 3500 K": {"a": entry(3.0)}, "LED lamps": {"a": entry(4.0)}}
    text = light_tables(with_leds, without)
    assert "| real | 1.00 | 2.00 |" in text
    assert "| real, no LEDs | 3.00 | 4.00 |" in text


@pytest.mark.skipif(
    importlib.util.find_spec("torch") is not None, reason="PyTorch is installed"
)
def test_without_torch_one_line_says_what_to_install():
    with pytest.raises(ValueError, match="need PyTorch, which ./scripts/evidence"):
        study.need_torch()


def test_a_draw_has_each_source_and_frame(small, camera):
    pytest.importorskip("torch", reason="PyTorch is not installed")
    tests = study.test_frames(small, camera, "quick")
    two = {"all": tests, "few": Frames(tests.images[:3], tests.neutrals[:3])}
    entry = {}
    for seed in (0, 1):
        draw = Draw(small, camera, "quick", seed)
        made = sources(
            material(small, camera, "day", small.protocol.seeds, 12, seed), camera, seed
        )
        found = study.illuminant_draw(draw, made, two)
        assert found["few"] == {source: e[:3] for source, e in found["all"].items()}
        assert study.illuminant_draw(draw, made, two) == found
        entry = appended(entry, found["all"])
    assert {np.shape(e) for e in entry.values()} == {(2, 8)}
    text = illuminant_tables({"canon-600d": reduced(entry)})
    assert "| share of the gap of upi, camera left (goal 0.3) |" in text
