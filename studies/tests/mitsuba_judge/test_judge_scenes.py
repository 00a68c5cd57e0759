# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Scenes of the second judge: of their index alone, varied, of the test half alone."""

import json
from dataclasses import replace

import numpy as np
import pytest

from studies.mitsuba_judge.kit import MAIN
from studies.mitsuba_judge.scene import SKIES, scene
from studies.mitsuba_judge.things import Spot, Thing

COUNT = 40


@pytest.fixture(scope="module")
def scenes(world):
    return [scene(index, world) for index in range(COUNT)]


def test_an_index_is_a_scene(world, scenes):
    again = scene(3, world)
    assert json.dumps(again.as_json()) == json.dumps(scenes[3].as_json())
    assert len({json.dumps(each.as_json()) for each in scenes}) == COUNT


def test_scenes_are_varied(scenes):
    assert [each.kind for each in scenes[:4]] == ["street", "square"] * 2
    assert {each.sky for each in scenes} == {"glow", "moon", "dusk"}
    assert 10 < sum(each.wet for each in scenes) < 30
    mains = {each.spectra.ids[each.main] for each in scenes}
    assert len(mains) > COUNT / 3
    fields = [each.view.field for each in scenes]
    assert np.ptp(fields) > 15.0
    for each in scenes:
        shapes = {thing.shape for thing in each.things}
        assert shapes == {"box", "panel", "ball", "rod"}
        assert sum(thing.light is not None for thing in each.things) > 5


def test_things_are_made_of_what_the_scene_has(scenes):
    for each in scenes:
        for thing in each.things:
            assert (thing.material is None) != (thing.light is None)
            assert (thing.material or 0) < len(each.spectra.materials)
            assert (thing.light or 0) < len(each.spectra.lights)
            assert (thing.light is None) or thing.level > 0.0


def rows_of(array):
    return {row.tobytes() for row in np.ascontiguousarray(array)}


def test_lights_are_of_the_test_half_and_none_of_training(world, scenes):
    train, test = (world.lights[half].powers for half in ("train", "test"))
    for each in scenes:
        spectra = each.spectra
        bare = spectra.lights[[*range(spectra.lamps), spectra.sky]]
        assert (bare == test[list(spectra.ids)]).all()
        assert not rows_of(bare) & rows_of(train)


def test_nothing_of_a_scene_is_of_training(world, scenes):
    """What would be drawn of the training half would be no number here."""
    lights, reflectances = world.lights["train"], world.reflectances["train"]
    nothing = replace(lights, powers=np.full_like(lights.powers, np.nan))
    blind = replace(
        world,
        lights={**world.lights, "train": nothing},
        reflectances={
            **world.reflectances,
            "train": np.full_like(reflectances, np.nan),
        },
    )
    for index in (0, 1, 2, 3):
        found = json.dumps(scene(index, blind).as_json(), allow_nan=False)
        assert found == json.dumps(scenes[index].as_json())


def test_reflectances_are_possible(scenes):
    for each in scenes:
        rows = np.array([m.reflectance for m in each.spectra.materials])
        assert rows.min() > 0.0 and rows.max() < 0.96
        assert (each.spectra.lights >= 0.0).all()


def test_the_main_light_is_that_of_which_there_is_most(scenes):
    for each in scenes:
        flux = np.zeros(len(each.spectra.lights))
        for thing in each.things:
            if thing.light is not None:
                flux[thing.light] += thing.level * thing.area()
        assert each.main == np.argmax(flux[: each.spectra.lamps])
        share = np.sqrt(flux) / np.sqrt(flux).sum()
        assert each.mean_light() == pytest.approx(share @ each.spectra.lights)
    assert len({each.main for each in scenes}) > 1


def test_the_sky_is_as_bright_as_its_kind_and_glows_in_the_main_light(scenes):
    for each in scenes:
        low, high = SKIES[each.sky][0]
        assert low <= each.sky_level <= high
        of_the_sky = MAIN if each.sky == "glow" else each.spectra.sky
        assert each.sky_light == of_the_sky != each.spectra.lamps + 1


def test_a_spot_turns_what_stands_on_it():
    """A front that faces the camera has its right where the camera's left is."""
    spot = Spot((1.0, 0.0, 10.0), 180.0)
    assert spot.at(2.0, 3.0, 4.0) == pytest.approx((-1.0, 3.0, 6.0))
    right = Spot((5.0, 0.0, 0.0), -90.0)  # a house on the right faces left
    assert right.at(1.0, 0.0, 2.0) == pytest.approx((3.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("shape", "size", "area"),
    [
        ("ball", (0.5,), np.pi),
        ("rod", (0.5, 2.0), 2.0 * np.pi),
        ("panel", (2.0, 3.0), 6.0),
        ("box", (1.0, 2.0, 3.0), 22.0),
    ],
)
def test_area(shape, size, area):
    assert Thing(shape, (0.0, 0.0, 0.0), size).area() == pytest.approx(area)
