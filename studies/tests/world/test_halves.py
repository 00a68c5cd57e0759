# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Training and tests share no reflectance, light or scene."""

import numpy as np
import pytest

from studies.spectra.data import SAME, distance
from studies.world.halves import HALVES, generator, halved
from studies.world.materials import LEAST, MOST
from studies.world.shots import (
    card_lights,
    day_shots,
    load_world,
    neutrals,
    night_shots,
)


def rows_of(array):
    return {row.tobytes() for row in np.ascontiguousarray(array)}


@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_halves_are_disjoint_and_whole(count):
    parts = halved(count, key=1)
    both = np.concatenate([parts[half] for half in HALVES])
    assert sorted(both) == list(range(count))
    assert abs(len(parts["train"]) - len(parts["test"])) <= 1


def test_generators_of_the_halves_differ():
    draws = {generator(half, seed, 3).random() for half in HALVES for seed in range(50)}
    assert len(draws) == 100


def small_world():
    return load_world(None)


@pytest.mark.parametrize("which", ["found", "small"])
def test_no_reflectance_is_in_both_halves(which, world):
    found = (world if which == "found" else small_world()).reflectances
    for rows in found.values():
        assert len(rows_of(rows)) == len(rows) > 50  # nor twice in one
    assert not rows_of(found["train"]) & rows_of(found["test"])
    # Nor one that is almost the same: paints of one series are in one half.
    assert distance(found["train"], found["test"]).min() > SAME


def test_no_reflectance_is_one_that_profiles_were_fitted_to(world):
    from cg2raw.profile.matrix_fit import training_reflectances

    fitted = np.array(training_reflectances())
    for half in HALVES:
        assert distance(world.reflectances[half], fitted).min() > 0.9 * SAME  # clipped


@pytest.mark.parametrize("which", ["found", "small"])
def test_no_light_is_in_both_halves(which, world):
    found = (world if which == "found" else small_world()).lights
    train, test = (rows_of(found[half].powers) for half in HALVES)
    assert len(train) == len(found["train"].powers)  # nor twice in one
    assert not train & test


def shots_of(world, half, cards):
    mains = card_lights(world, half, cards, 8)
    return day_shots(world, half, 40, mains) + night_shots(world, half, 40, 8)


@pytest.fixture(scope="module")
def shots(world, camera_of):
    """Return {half: its shots}."""
    cards = camera_of("canon-600d").cards
    return {half: shots_of(world, half, cards) for half in HALVES}


def test_all_lights_of_shots_are_of_their_half(world, shots):
    for half in HALVES:
        pool = rows_of(world.lights[half].powers)
        for shot in shots[half]:
            assert rows_of(shot.lights) <= pool


def test_materials_are_of_their_half(world, shots):
    """A faded object is its measured one, times a share, plus a constant: of each
    material some reflectance of its half must be left once both are taken off."""
    for half in HALVES:
        centred = world.reflectances[half] - world.reflectances[half].mean(1)[:, None]
        shapes = centred / np.linalg.norm(centred, axis=1)[:, None]
        for material in shots[half][0].scene.materials:
            inside = (material > LEAST) & (material < MOST)  # not clipped
            if not inside.all() or np.ptp(np.diff(material)) < 1e-9:
                continue  # a grey is of no half
            shape = material - material.mean()
            assert (shapes @ shape).max() == pytest.approx(np.linalg.norm(shape))


def test_scenes_of_a_seed_differ_between_the_halves(shots):
    for one, other in zip(*shots.values(), strict=True):
        same = one.scene.shades.shape == other.scene.shades.shape
        assert not (same and np.allclose(one.scene.shades, other.scene.shades))


def test_neutrals_of_the_training_captures_are_of_training_lights(world, camera_of):
    camera = camera_of("nikon-d40")
    mains = card_lights(world, "train", camera.cards, 200)
    told = rows_of(neutrals(mains, camera.sensitivities))
    test = neutrals(world.lights["test"].powers, camera.sensitivities)
    assert not told & rows_of(test)
