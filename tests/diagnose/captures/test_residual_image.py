# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Residual images: planted ones are found in the dark that has them, and no other."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.captures.residual_image import Blocks, residual_images
from diagnose import capture_files as files
from diagnose.planted import capture_of, x_trans
from oracles import cameras

SENSOR = Sensor("canon-70d")
BLACK, READ, WHITE = float(np.mean(SENSOR.black_level)), 8.0, 15000.0  # DN
SHAPE, LEAST = (120, 160), 8.0


def picture(seed):
    """Return light of soft edges, 0 to 3000 DN."""
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(0, 3000, (SHAPE[0] // 10, SHAPE[1] // 10))
    return np.kron(coarse, np.ones((10, 10)))


def shot(kind, name, level, seed, **given):
    rng = np.random.default_rng(seed)
    noise = rng.normal(0, READ, SHAPE) + rng.normal(0, 2, (SHAPE[0], 1))
    raw = np.rint(BLACK + level + noise).clip(0, WHITE).astype(np.uint16)
    capture = replace(capture_of(kind, 1), name=name, shape=SHAPE, raw=lambda: raw)
    return replace(capture, **given)


MONO = Sensor.from_json(cameras.mono_text(id="mono"))


@pytest.mark.parametrize(("sensor", "side"), [(SENSOR, 4), (x_trans(), 6), (MONO, 4)])
def test_blocks_are_whole_repeats_of_the_cfa(sensor, side):
    assert Blocks(sensor).side == side


def found(lags, scenes=(1, 2), first=10):
    """Return what is found in darks whose levels have shares of scenes: (scene, share)
    or None each."""
    pictures = {n: picture(n) for n in (1, 2)}
    shots = [
        shot("scene", f"scene {n}", pictures[n], n, set=f"set {n}") for n in scenes
    ]
    darks = [
        shot("dark", f"dark {n}", lag[1] * pictures[lag[0]] if lag else 0.0, first + n)
        for n, lag in enumerate(lags)
    ]
    blocks = Blocks(SENSOR)
    for dark in darks:
        blocks.watched(dark).raw()
    images = residual_images([*shots, *darks], darks, blocks, LEAST)
    return [(one.dark, one.picture, one.share) for one in images]


@pytest.mark.parametrize("share", [1e-3, 1e-2, 0.1])
def test_a_dark_that_has_one_is_named_with_the_picture_and_the_share(share):
    [(dark, name, measured)] = found([None, (2, share), None, None])
    assert (dark, name) == ("dark 1", "scene 2")
    assert measured == pytest.approx(share, rel=0.25)


def test_of_two_darks_the_one_that_has_it():
    """What the other lacks is like a negative of it."""
    assert [one[:2] for one in found([None, (1, 0.01)])] == [("dark 1", "scene 1")]


def test_several_that_fade():
    lags = [(1, 0.02), (1, 0.01), (1, 0.005), None, None]
    assert [one[0] for one in found(lags)] == ["dark 0", "dark 1", "dark 2"]


@pytest.mark.parametrize(
    ("lags", "scenes"),
    [
        ([None] * 4, (1, 2)),
        ([(1, 1e-5), None, None], (1, 2)),  # less than matters
        ([(1, 0.01), None], ()),  # of nothing that was captured
        ([(1, 0.01)], (1,)),  # without a repeat
    ],
)
def test_nothing_is_found_where_nothing_is_shown(lags, scenes):
    assert found(lags, scenes) == []


@pytest.mark.parametrize("share", [0.0, 1e-3])
def test_pictures_are_read_for_darks_that_may_have_one(share):
    """Of 4 MP, of which means of large blocks tell that: of noise none is read."""

    def unread():
        raise EOFError

    scene = shot("scene", "scene", 0.0, 1, raw=unread)
    darks = [shot("dark", f"dark {n}", 0.0, n) for n in range(3)]
    rng, blocks = np.random.default_rng(5), Blocks(SENSOR)
    for dark in darks:
        blocks.means[dark.name] = rng.normal(0, READ / 4, (500, 500))
    blocks.means["dark 1"] += share * np.kron(picture(1)[:50, :50], np.ones((10, 10)))
    if share:
        with pytest.raises(EOFError):
            residual_images([scene], darks, blocks, LEAST)
    else:
        assert residual_images([scene], darks, blocks, LEAST) == []


@pytest.mark.parametrize(
    ("moved", "power", "is_found"),
    [(0.04, 9, False), (0.0625, 9, True), (0.1, 1, True)],
)
def test_a_residual_image_that_hardly_moves_a_mean_is_none(moved, power, is_found):
    """By less than a twentieth of the noise of a block: a quarter of a million of them
    show it of a picture with few bright places."""
    rng, blocks, noise, level = np.random.default_rng(6), Blocks(SENSOR), 2.0, 1000.0
    light = np.kron(rng.random((32, 32)) ** power, np.ones((16, 16)))
    light *= level / light.mean()
    scene = shot("scene", "scene", 0.0, 1)
    other = shot("scene", "of another size", 0.0, 1, set="of another size")
    darks = [shot("dark", f"dark {n}", 0.0, n) for n in range(3)]
    blocks.means.update({scene.name: light, other.name: light[1:]})
    for dark in darks:
        blocks.means[dark.name] = rng.normal(0, noise, light.shape)
    blocks.means["dark 1"] += moved * noise / level * light
    images = residual_images([other, scene, *darks], darks, blocks, LEAST)
    found = [(one.dark, one.picture) for one in images]
    assert found == is_found * [("dark 1", "scene")]


def test_chance_is_no_residual_image():
    """Of 40 darks in all, with row noise."""
    assert [one for n in range(10) for one in found([None] * 4, first=100 * n)] == []


def test_the_check_says_it(tmp_path):
    """Of DNGs: 2 % of a scene in one of three darks."""
    rgb = files.picture(seed=3)
    np.save(tmp_path / "render.npy", rgb)
    files.frame(tmp_path, "shot.dng", rgb, frame=9)
    lines = ["{file: shot.dng, kind: scene, scene: render.npy}"]
    for n, share in enumerate((0.0, 0.02, 0.0)):
        files.frame(tmp_path, f"{n}.dng", np.float32(share) * rgb, frame=n)
        lines.append(f"{{file: {n}.dng, kind: dark}}")
    [words] = files.checked(tmp_path, lines).complaints
    assert words.startswith("1.dng: has a residual image of shot.dng, 2 % of its light")
    assert "leave it out" in words
