# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The pool of lights: their energy, and that cameras meet them as grey cards do."""

import numpy as np
import pytest

from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from studies.cameras import CARDS, FILES, NUS, grey_cards
from studies.protocol import PROTOCOL
from studies.world.colorimetry import light_colours, observer
from studies.world.lights import FAMILIES, mccamy, on_grid
from studies.world.shots import (
    card_lights,
    card_weights,
    lit_by,
    load_world,
    second_light,
)


@pytest.mark.parametrize(
    "line", [436, 546, 548, 611]
)  # nm; mercury's, and off the grid
def test_a_line_keeps_its_energy_on_the_grid(line):
    nm = np.arange(380.0, 781.0)
    power = np.where(nm == line, 1.0, 0.0)[:, None]
    assert on_grid(nm, power).sum() * 5.0 == pytest.approx(1.0)
    assert (WAVELENGTHS @ on_grid(nm, power)) * 5.0 == pytest.approx(line)


def test_a_smooth_light_is_the_same_on_the_grid():
    nm = np.arange(380.0, 781.0)
    slope = on_grid(nm, nm[:, None])[:, 0]
    assert slope[1:-1] == pytest.approx(WAVELENGTHS[1:-1])


@pytest.mark.parametrize(
    ("word", "kelvin"), [("A", 2857), ("D65", 6505), ("D50", 5002)]
)
def test_colour_temperatures_are_those_of_the_cie(word, kelvin):
    found = mccamy(illuminant_spectrum(word)[None])[0]
    assert found == pytest.approx(kelvin, abs=15)  # the grid of 5 nm, and the formula


def test_all_lights_have_luminance_1(world):
    for pool in world.lights.values():
        assert pool.powers @ observer()[:, 1] == pytest.approx(1.0)
        assert pool.powers.min() >= 0.0


def test_families_have_their_shares(world):
    pool = world.lights["train"]
    weight = pool.weights(PROTOCOL.lights.shares)
    for number, name in enumerate(FAMILIES):
        share = weight[pool.family == number].sum()
        assert share == pytest.approx(PROTOCOL.lights.shares[name])


def test_no_daylight_by_night(world):
    pool = world.lights["test"]
    weight = pool.night_weights()
    assert weight.sum() == pytest.approx(1.0)
    assert weight[pool.family == FAMILIES.index("daylight")].sum() == 0.0
    kelvin = mccamy(pool.powers[weight > 0.0])
    assert kelvin.min() > 1900.0 and kelvin.max() < 5500.0


@pytest.mark.parametrize("half", ["train", "test"])
@pytest.mark.parametrize("name", NUS)
def test_a_camera_meets_lights_as_its_grey_cards_did(name, half, world, camera_of):
    """Log R/B has the cards' mean and sd; 0.05 is the bandwidth's share."""
    camera, pool = camera_of(name), world.lights[half]
    weight = card_weights(pool, camera.cards, PROTOCOL.lights)

    def warmth(rgb):
        return np.log(rgb[:, 0] / rgb[:, 2])

    found, cards = warmth(camera.neutrals(pool.powers)), warmth(camera.cards.neutrals)
    mean = weight @ found
    assert mean == pytest.approx(cards.mean(), abs=0.05)
    assert np.sqrt(weight @ (found - mean) ** 2) == pytest.approx(cards.std(), rel=0.1)


def test_grey_cards_are_red_green_and_blue_by_the_names_of_the_columns(
    camera_data, tmp_path
):
    table, name = tmp_path / CARDS, "canon-600d"
    table.parent.mkdir(parents=True)
    (tmp_path / FILES[name]).parent.mkdir(parents=True)
    (tmp_path / FILES[name]).symlink_to(camera_data / FILES[name])
    rows = ["b,camera,g,r", "0.9,NikonD40,0.1,0.1", f"0.3,{NUS[name]},0.8,0.4"]
    table.write_text("\n".join(rows))
    cards = grey_cards(name, tmp_path)
    assert cards.neutrals == pytest.approx(np.array([[0.5, 1.0, 0.375]]))
    own, blue = cards.sensitivities, observer()[:, 2]
    assert np.argmax(blue @ own / own.sum(axis=0)) == 2


def test_lights_of_a_seed_are_the_same_and_of_two_seeds_are_not(world, camera_of):
    cards = camera_of("canon-600d").cards
    first, again, other = (card_lights(world, "train", cards, 50, s) for s in (0, 0, 1))
    assert np.array_equal(first, again) and not np.array_equal(first, other)


def test_the_sky_is_bluer_than_daylight_and_spill_is_like_its_lamp(world):
    pool, rng = world.lights["test"], np.random.default_rng(0)
    blue = observer()[:, 2]
    for main in pool.powers[::40]:
        second = second_light(rng, pool, main)
        if main @ blue > 0.7:
            assert second @ blue >= main @ blue
        else:
            assert abs(second @ blue - main @ blue) < 0.35


def test_the_main_light_is_white_to_a_renderer(world):
    for light in world.lights["test"].powers[::100]:
        assert light_colours(light[None], light)[0] == pytest.approx(1.0)


def test_the_world_is_the_same_each_time():
    assert load_world(None).hashes() == load_world(None).hashes()


def test_leds_are_in_both_halves_and_can_be_held_out(world):
    """Of both sets of lamps more than a tenth are LEDs; no other light is."""
    for pool in world.lights.values():
        lamp = pool.family == FAMILIES.index("lamp")
        assert not pool.led[~lamp].any() and 0.1 < pool.led[lamp].mean() < 0.9
    without, alone = lit_by(world, leds=False), lit_by(world, leds=True)
    for half, pool in world.lights.items():
        kept, leds = without.lights[half].powers, alone.lights[half].powers
        assert len(kept) + len(leds) == len(pool.powers) and len(leds) > 0
        assert not (kept[:, None] == leds[None]).all(axis=2).any()


def test_phosphors_and_mixtures_of_colours_are_leds(world):
    """CIE's LED-B3 is one; its fluorescent FL11 and its HP1 are none."""
    whole = [np.concatenate([p.powers for p in world.lights.values()])]
    led = np.concatenate([pool.led for pool in world.lights.values()])
    for name, expected in (("LED-B3", True), ("FL11", False), ("HP1", False)):
        power = illuminant_spectrum(name)
        power = power / (power @ observer()[:, 1])
        found = np.abs(whole[0] - power).max(axis=1).argmin()
        assert led[found] == expected, name
