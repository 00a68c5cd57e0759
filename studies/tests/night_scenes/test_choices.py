# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The 292 descriptions, without Blender: what stands where, and that it varies."""

import ast
import itertools
import json
import math
from pathlib import Path

import pytest

from studies.night_scenes import choices
from studies.night_scenes.choices import crowd, draws, floor, scenes, street
from studies.night_scenes.choices.description import Person, Vehicle

ALL = [scenes.scene(index) for index in range(scenes.COUNT)]
PARTS = Path(choices.__file__).parents[1] / "parts"
# What spans others: a railing, bridges, and what stands beyond the water.
SPANNING = {"rail", "arch", "arch_bridge", "suspension_bridge", "wheel", "crane"}


def footprints(scene):
    """Return [(name, rectangle)] of all that stands on the ground of a scene."""
    found = []
    for vehicle in scene.vehicles:
        found.append(
            (vehicle.body, floor.of(vehicle.body, *vehicle.place[:2], vehicle.turn))
        )
    for person in scene.people:
        if person.pose != "sitting":
            found.append(("person", floor.of("person", *person.place[:2], person.turn)))
    for thing in scene.things:
        if thing.name not in SPANNING:
            x, y, _ = thing.place
            found.append(
                (thing.name, floor.Rectangle(x, y, *thing.size[:2], thing.turn))
            )
    return found


def collisions(scene):
    """Return the pairs of names that stand in one another."""
    return [
        (a[0], b[0])
        for a, b in itertools.combinations(footprints(scene), 2)
        if floor.overlap(a[1], b[1])
    ]


@pytest.mark.parametrize("scene", ALL, ids=lambda scene: str(scene.index))
def test_nothing_stands_in_another(scene):
    assert collisions(scene) == []


def test_a_collision_would_be_found():
    class Planted:
        vehicles = (
            Vehicle("saloon", (2.0, 10.0, 0.0), 0.0, (0, 0, 0), True),
            Vehicle("van", (2.4, 14.0, 0.0), math.pi, (0, 0, 0), False),
        )
        people = (Person("standing", (2.0, 12.0, 0), 0.0, 1.7, (0, 0, 0), (0, 0, 0)),)
        things = ()

    assert collisions(Planted) == [
        ("saloon", "van"),
        ("saloon", "person"),
        ("van", "person"),
    ]


@pytest.mark.parametrize("scene", ALL[:64], ids=lambda scene: str(scene.index))
def test_nobody_stands_close_before_the_camera(scene):
    for person in scene.people:
        if person.pose != "sitting":
            assert (
                math.dist(person.place[:2], scene.camera.place[:2]) > crowd.NEAR - 1.0
            )


def test_the_same_index_is_the_same_scene():
    for index in (0, 17, 101, 291):
        assert scenes.scene(index) == ALL[index]


def test_no_two_scenes_are_alike():
    texts = {json.dumps({**scene.as_json(), "index": 0}) for scene in ALL}
    assert len(texts) == scenes.COUNT
    assert len({scene.camera for scene in ALL}) == scenes.COUNT


def test_all_kinds_and_layouts_take_turns():
    names = [scenes.kind_and_layout(index) for index in range(32)]
    assert len(set(names)) == 32
    assert [scene.kind for scene in ALL[:4]] == list(scenes.KINDS)
    assert all(len(kind.LAYOUTS) == 8 for kind in scenes.KINDS.values())
    for scene in ALL:
        assert (scene.kind, scene.layout) == scenes.kind_and_layout(scene.index)


def test_lamps_are_of_2000_to_6500_kelvin_and_use_that_range():
    kelvin = [lamp.kelvin for scene in ALL for lamp in scene.lamps]
    assert min(kelvin) >= draws.WARMEST and max(kelvin) <= draws.COOLEST
    assert min(kelvin) < 2050 and max(kelvin) > 6000
    assert all(scene.lamps for scene in ALL)


def test_neon_has_hues_of_the_whole_circle():
    hues = [sign.hue for scene in ALL for sign in scene.signs]
    for tenth in range(10):
        share = sum(tenth / 10 <= hue < (tenth + 1) / 10 for hue in hues) / len(hues)
        assert share > 0.05  # even would be 0.1


def test_wet_and_dry_haze_moon_and_dusk_all_occur():
    outdoors = [scene for scene in ALL if scene.kind != "interior"]
    wet = sum(scene.weather.wet > 0 for scene in outdoors) / len(outdoors)
    haze = sum(scene.weather.haze > 0 for scene in outdoors) / len(outdoors)
    assert 0.45 < wet < 0.75
    assert 0.01 < haze < 0.10  # dear to render, hence rare
    assert len({scene.sky.name for scene in outdoors}) == 6


def test_three_cars_a_bus_and_people_occur():
    bodies = {vehicle.body for scene in ALL for vehicle in scene.vehicles}
    assert bodies == {"hatchback", "saloon", "van", "bus"}
    assert sum(len(scene.people) for scene in ALL) > 4 * scenes.COUNT


def test_signs_of_a_wall_do_not_overlap():
    for scene in ALL:
        if scene.kind != "street":
            continue
        for side in (-1, 1):
            wall = [
                floor.Rectangle(
                    s.place[1], s.place[2], *draws.sign_size(s.name, s.text, s.size)
                )
                for s in scene.signs
                if s.turn == street.facing(side)
            ]
            pairs = itertools.combinations(wall, 2)
            assert not [pair for pair in pairs if floor.overlap(*pair)]


def test_a_description_is_json():
    for scene in ALL[:32]:
        again = json.loads(json.dumps(scene.as_json()))
        assert again["kind"] == scene.kind and again["index"] == scene.index


def keys_of(module, table):
    """Return the keys of a dictionary at the top of a part, without importing bpy."""
    for node in ast.parse((PARTS / f"{module}.py").read_text()).body:
        names = [getattr(t, "id", "") for t in getattr(node, "targets", ())]
        if names == [table]:
            return {key.value for key in node.value.keys}
    raise AssertionError(f"{module}.py has no {table}")


def test_all_that_is_chosen_can_be_built():
    things = {thing.name for scene in ALL for thing in scene.things}
    known = set()
    for module in PARTS.glob("*_things.py"):
        known |= keys_of(module.stem, "THINGS")
    assert things <= known
    assert known - things == set()  # and all that can be built is chosen
    lamps = {lamp.name for scene in ALL for lamp in scene.lamps}
    assert lamps == keys_of("lamps", "LAMPS")
    signs = {sign.name for scene in ALL for sign in scene.signs}
    assert signs == keys_of("signs", "SIGNS")
    poses = {person.pose for scene in ALL for person in scene.people}
    assert poses == keys_of("people", "POSES")
    cars = {"bus"} | keys_of("vehicles", "CARS")
    assert {v.body for scene in ALL for v in scene.vehicles} == cars
