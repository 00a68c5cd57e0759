# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hidden effects of colour and lens, by laws of optics."""

import numpy as np
import pytest

from cg2raw.synthetic import dust, light
from cg2raw.synthetic.captures import draw_hidden


def test_what_is_moved_stands_beside():
    """Of a ramp, that cubic splines keep but for its mirrored edges."""
    field = light.Field((40, 50), 10)
    ramp = 200 + 2 * field.x + 3 * field.y
    moved = field.moved(ramp, np.full(ramp.shape, 1.5), np.full(ramp.shape, -0.5))
    assert moved[field.inner] == pytest.approx(ramp[field.inner] + 1.5, abs=1e-4)


def test_colours_turn_about_grey():
    still = {"hue": 0.0, "saturation": 0.0, "red_as_green": 0.0}
    scene = np.array([[0.2, 0.2, 0.2], [0.5, 0.1, 0.3]])

    def seen(**values):
        return light.recolored(scene, {"color_matrix": still | values})

    for values in ({"hue": 0.3}, {"saturation": 0.5}, {"red_as_green": 0.1}):
        assert seen(**values)[0] == pytest.approx(scene[0])
    assert seen() == pytest.approx(scene)
    assert seen(saturation=-1.0)[1] == pytest.approx(0.3)
    assert seen(saturation=1.0)[1] == pytest.approx([0.7, -0.1, 0.3])
    assert seen(hue=2 * np.pi / 3)[1] == pytest.approx([0.3, 0.5, 0.1])
    assert seen(red_as_green=0.1)[1] == pytest.approx([0.5, 0.13, 0.3])
    hidden = {
        "exposure": {"stops": 1.0},
        "white_balance": {"red_stops": 1.0, "blue_stops": -2.0},
    }
    assert light.gained(np.ones(3), hidden) == pytest.approx([4, 2, 0.5])


def test_a_lens_moves_mirrors_and_spreads():
    field = light.Field((41, 61), 12)
    ramps = np.stack([200 + field.x, 200 + field.y, np.full(field.x.shape, 200)], -1)
    plain = ramps[field.inner]
    found = light.through_lens(ramps, {"lens_distortion": {"corner_px": -2.0}}, field)
    assert found[20, 30] == pytest.approx(plain[20, 30])
    corner = found[0, 0, :2] - plain[0, 0, :2]  # moved along the radius
    assert corner == pytest.approx(2 * np.array([30, 20]) / np.hypot(30, 20), abs=0.01)
    values = {"red_px": 1.5, "blue_px": -1.0, "bend": 0.5}
    hidden = {"lateral_chromatic_aberration": values}
    same = np.repeat(200 + field.x[..., None], 3, -1)
    moved = light.through_lens(same, hidden, field)[20, -1] - same[field.inner][20, -1]
    ratio = 30 / np.hypot(30, 20)
    bend = 0.5 * ratio + 0.5 * ratio**3
    assert moved == pytest.approx([1.5 * bend, 0, -bend], abs=0.01)
    spot = np.zeros_like(ramps)
    spot[12 + 5, 12 + 10] = 1
    ghost = {"ghost_image": {"share": 0.05, "disc_px": 0.01}}
    found = light.through_lens(spot, ghost, field)
    assert found[40 - 5, 60 - 10] == pytest.approx(0.05, abs=1e-4)
    shading = {
        **{"corner_degrees": 20.0, "red_power": 2.0, "blue_power": -1.0},
        **{"axis_x": 0.0, "axis_y": 0.0},
    }
    cast = light.through_lens(np.ones_like(ramps), {"color_shading": shading}, field)
    cosine = np.cos(np.radians(20))
    assert cast[0, 0] == pytest.approx([cosine**2, 1, 1 / cosine])


def test_stray_light_fades_exponentially_or_is_even():
    field = light.Field((121, 121), 0)
    spot = np.zeros((121, 121, 3))
    spot[60, 60] = 1
    for even in (0.0, 1.0):
        values = {"share": 0.1, "even": even, "wing_length": 10 / 121}
        found = light.through_lens(spot, {"veiling_glare": values}, field)[..., 1]
        assert found.sum() == pytest.approx(1)
        fading = np.exp((30 - 10) / 10) if not even else 1
        assert found[60, 70] / found[60, 90] == pytest.approx(fading, rel=0.02)
        assert found[60, 70] / found[80, 60] == pytest.approx(fading**0.5, rel=0.02)


def test_transfer_functions_are_those_of_optics():
    """A disc's first zero lies at 3.8317 / (2 pi r); an aperture passes 0.391 of half
    its cutoff, nothing from there on (Goodman, section 6.3)."""
    f = np.array([0.0, 3.8317 / (2 * np.pi * 2.5), 0.5, 0.4, 0.2])
    assert light.disc(f, 2.5)[:2] == pytest.approx([1, 0], abs=1e-4)
    assert light.airy(f, 0.4)[[0, 2, 3, 4]] == pytest.approx([1, 0, 0, 0.391], abs=1e-3)


def test_fall_off_is_the_fourth_power_of_the_cosine():
    field = light.Field((101, 101), 0)
    values = {"corner_loss": 0.4, "axis_x": 0.0, "axis_y": 0.0}
    rgb = light.through_lens(np.ones((101, 101, 3)), {"lens_shading": values}, field)
    assert rgb[50, 50] == pytest.approx(1)
    assert rgb[0, 0] == pytest.approx(0.6)
    tangent = np.sqrt(0.6**-0.5 - 1)
    half_way = np.cos(np.arctan(tangent / 2)) ** 4
    assert rgb[25, 25] == pytest.approx(half_way)


@pytest.mark.parametrize("name", ["blur", "motion_blur", "veiling_glare"])
def test_spread_light_is_kept(sensor, name):
    hidden = draw_hidden(sensor, {name: None}, seed=9)
    field = light.Field((64, 64), 12)
    rows, cols = np.mgrid[-44:44, -44:44]
    spot = np.exp(-(rows**2 + cols**2) / 4)  # as sharp as a render, nearly
    image = np.repeat(spot[..., None], 3, axis=-1)
    after = light.through_lens(image, hidden, field)
    assert after.sum((0, 1)) == pytest.approx(image.sum((0, 1)), rel=0.02)
    assert after.max() < 0.995


def test_flakes_of_dust_are_as_dense_as_is_stated():
    """Of 2 radii around the frame, too: 300 x 320 px."""
    means = []

    class Recorded(np.random.Generator):
        def poisson(self, mean):
            means.append(mean)
            return 1

    hidden = {"per_megapixel": 50.0, "radius_px": 50.0, "loss": 0.1, "soft_px": 1.0}
    dust.transmission(Recorded(np.random.PCG64(1)), (100, 120), {"dust": hidden})
    assert means == pytest.approx([50.0 * 0.3 * 0.32])
