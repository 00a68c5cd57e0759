# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a frame looks like, of frames that are known."""

import json

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.match.frame import binned, colours, details, neutral_of_all, thumbnail
from cg2raw.match.renders import Model, simulated
from dng import dng_files
from match.match_sets import scene, toned
from oracles import cameras

SENSORS = ("canon-700d", "samsung-s20fe", "nikon-d40", "fujifilm-x-m1")


def seen(image, sensor="canon-700d", light="D65", iso=None):
    """Return the Frame of an image."""
    image = np.ascontiguousarray(image, np.float32)
    return simulated("a.exr", image, 0, Model(Sensor(sensor), (light,), iso))


def blurred(image):
    """Return an image that is smooth over nine pixels."""
    shifts = [(row, col) for row in range(9) for col in range(9)]
    return sum(np.roll(image, shift, (0, 1)) for shift in shifts) / len(shifts)


@pytest.mark.parametrize("sensor", SENSORS)
@pytest.mark.parametrize("light", ["D65", "A"])
def test_grey_lies_as_many_stops_below_white_as_it_does(sensor, light):
    frame = seen(np.full((96, 144, 3), 0.18), sensor, light)
    assert frame.level == pytest.approx(np.log2(0.18), abs=0.01)
    assert frame.red == pytest.approx(0, abs=0.02)
    assert frame.blue == pytest.approx(0, abs=0.02)
    assert (frame.clipped, frame.black, frame.white_bins) == (0, 0, 0)


@pytest.mark.parametrize("sensor", SENSORS)
def test_the_level_is_luminance_whatever_the_colour_and_the_light(sensor):
    """Of the green samples alone it would be off by a stop."""
    for rgb in ((0.3, 0.05, 0.02), (0.02, 0.05, 0.3), (0.05, 0.2, 0.04)):
        luminance = np.dot(rgb, (0.2126, 0.7152, 0.0722))
        for light in ("D65", "A"):
            frame = seen(np.full((96, 144, 3), rgb), sensor, light)
            assert frame.level == pytest.approx(np.log2(luminance), abs=0.1)


def test_exposure_moves_levels_and_tone_and_saturation_do_not():
    rng = np.random.default_rng(1)
    for _ in range(4):
        image = scene(rng, 0.5)
        plain, brighter = seen(image), seen(image * 4)
        other = seen(toned(image, 1.3, 1.5), light="A", iso=800)
        assert brighter.level - plain.level == pytest.approx(2, abs=0.01)
        assert other.level == pytest.approx(plain.level, abs=0.1)
        assert other.contrast / plain.contrast == pytest.approx(1.3, abs=0.05)


def test_saturation_is_that_of_the_image():
    image = blurred(scene(np.random.default_rng(2), 0.1, -3))
    half = seen(toned(image, saturation=0.5)).saturation / seen(image).saturation
    assert half == pytest.approx(0.5, abs=0.1)


def test_shares_of_clipped_and_black_samples():
    image = np.full((96, 144, 3), 0.2)
    image[:24] = 3.0
    frame = seen(image)
    assert frame.clipped == frame.white_bins == pytest.approx(0.25, abs=0.02)
    assert frame.level == pytest.approx(np.log2(0.2), abs=0.01)
    image[:60] = 3.0
    assert seen(image).white_bins > 0.5
    dark = seen(np.zeros((96, 144, 3)))
    assert (dark.black, dark.black_bins) == (1, 1)


def test_noise_is_that_of_the_sensor_and_not_the_texture():
    image = blurred(scene(np.random.default_rng(3), 0.1, -3, (384, 576)))
    assert seen(image).noise < 0.3 * seen(image, iso=3200).noise
    ratio = seen(image, iso=6400).noise / seen(image, iso=1600).noise
    assert ratio == pytest.approx(2, rel=0.15)  # of photons: the square root of 4


def test_blur_is_less_sharp():
    image = scene(np.random.default_rng(4), 0.1, -3, (384, 576))
    assert seen(blurred(image)).sharpness < 0.85 * seen(image).sharpness


def test_a_light_that_is_not_stated_is_grey_in_the_mean():
    sensor = Sensor("canon-700d")
    image = scene(np.random.default_rng(5), 0.1)
    image *= (0.1 / image.mean((0, 1))).astype(np.float32)
    raw = np.asarray(sensor.simulate(image, illuminant="3200K"))
    stated = sensor.illuminant("3200K").neutral
    assert neutral_of_all(raw, sensor) == pytest.approx(tuple(stated), rel=0.08)


def test_a_sensor_without_filters():
    sensor = Sensor.from_json(cameras.mono_text(), "mono.json")
    image = np.full((64, 96, 3), 0.25, np.float32)
    frame = simulated("mono.exr", image, 0, Model(sensor, ()))
    assert frame.level == pytest.approx(-2, abs=0.01)
    assert np.isnan(frame.saturation)


@pytest.mark.parametrize("id", ["samsung-s20fe", "fujifilm-x-m1"])
def test_bins_are_means_of_filters_and_shares_of_samples(id):
    """Of whole repeats alone, two in each bin of a frame that is wider than 1024 of
    them; levels differ by site."""
    sensor = Sensor(id)
    side = 6 if id.startswith("fuji") else 2
    rng, (height, width) = np.random.default_rng(6), (33 * side + 1, 1030 * side)
    raw = rng.integers(0, sensor.white_level + 1, (height, width), np.uint16)
    black = np.resize(np.array(sensor.black_level, float), (side, side))
    span, step = sensor.white_level - black, 2 * side
    used = raw[: 32 * side, :width]
    signal = (used - np.tile(black, (32, 1030))) / np.tile(span, (32, 1030))
    colors = np.resize(list(sensor.cfa.upper()), (side, side))
    bins, shape = binned(raw, sensor), (16, step, 515, step)
    assert bins.side == step
    for index, letter in enumerate("RGB"):
        own = np.where(np.tile(colors == letter, (32, 1030)), signal, np.nan)
        means = np.nanmean(own.reshape(shape), axis=(1, 3))
        np.testing.assert_allclose(bins.means[..., index], means, atol=1e-9)
    white = (signal > 0.99 - 0.5 / span.min()).reshape(shape).mean((1, 3))
    np.testing.assert_allclose(bins.white, white, atol=0.03)
    assert bins.clipped == pytest.approx(bins.white.mean())
    assert bins.black == pytest.approx((signal <= 0).mean(), abs=1e-4)


def test_a_thumbnail_has_the_means_of_cells_that_are_mostly_known():
    stops = np.random.default_rng(7).normal(size=(80, 160))
    stops[:4, :6], stops[:5, 10:15] = np.nan, np.nan  # 24 and 25 of 50
    expected = np.nanmean(stops.reshape(16, 5, 16, 10), axis=(1, 3))
    expected[0, 1] = np.nan
    np.testing.assert_allclose(thumbnail(stops), expected, atol=2e-3)  # half floats


def test_colours_are_medians_over_cells_that_are_lit_as_a_whole():
    """Cells are 8 px along a side: of five, one is red, and two have a dark bin."""
    bins = np.ones((2, 10, 3))
    bins[:, :, 0], bins[:, :, 2] = 2.0**0.3, 2.0**-0.4
    bins[:, 4:8, 0] = 8.0
    lit = np.ones((2, 10), bool)
    lit[0, 4] = lit[0, 9] = False
    bins[0, 9] = -1.0
    expected = (0.3, -0.4, 0.5)
    assert colours(bins, lit, (4, 80)) == pytest.approx(expected)
    assert np.isnan(colours(bins, ~lit, (4, 80))).all()


def plane_of(root, sensor):
    """Return a frame whose green samples have a root of their signal."""
    level = (np.repeat(np.repeat(root, 2, 0), 2, 1)) ** 2
    black = np.mean(sensor.black_level)
    return np.rint(black + (sensor.white_level - black) * level).astype(np.uint16)


@pytest.mark.parametrize(
    ("profile", "sharpness"),
    [
        (lambda x, rng: 0.1 + 0.8 * x / 512, 1 / 8),
        (lambda x, rng: 0.3 + 0.4 * (x // 64 % 2), 8**-0.5),  # one step of eight
        (lambda x, rng: rng.uniform(0.2, 0.9, (x < 0).shape), 1.0),
    ],
    ids=["ramp", "edges", "each sample its own"],
)
def test_sharpness_is_of_the_gradient_over_one_repeat_and_over_eight(
    profile, sharpness
):
    """Of rows that are alike; a part is flat, and nothing is taken for noise."""
    sensor, x = Sensor("nikon-d850"), np.arange(512.0)
    columns = profile(x, np.random.default_rng(8))
    columns[:80] = columns[80]
    found, noise = details(plane_of(np.tile(columns, (256, 1)), sensor), sensor)
    assert found == pytest.approx(sharpness, rel=0.1)
    assert noise < 1e-3


def test_noise_is_that_of_the_root_of_the_signal():
    """Of the flattest tenth of cells of 256 samples, a little less than that of all."""
    sensor, rng = Sensor("canon-700d"), np.random.default_rng(9)
    root = 0.5 + 0.01 * rng.standard_normal((384, 512))
    root[:, 256:] = rng.uniform(0.2, 0.9, (384, 256))
    _, noise = details(plane_of(root, sensor), sensor)
    assert 0.85 * 0.01 < noise < 0.01
    _, noise = details(plane_of(1.01 + root, sensor), sensor)
    assert np.isnan(noise)


@pytest.mark.parametrize(
    ("shape", "known"),
    [((16, 162), True), ((16, 161), False), ((15, 700), False), ((64, 17), False)],
)
def test_noise_is_known_of_ten_cells_or_more(shape, known):
    """Of 16 samples a side, beside a sample on the left and on the right."""
    sensor, rng = Sensor("canon-700d"), np.random.default_rng(9)
    root = 0.5 + 0.01 * rng.standard_normal(shape)
    assert np.isfinite(details(plane_of(root, sensor), sensor)).all() == known


@pytest.mark.parametrize("cfa", ["rggb", "grbg"])
def test_each_site_has_its_own_black_level(cfa):
    """In shares of the range from there to white, a frame is the same."""
    fields = dng_files.fields_of("canon-700d") | {"cfa": cfa}
    sensors = [
        Sensor.from_json(json.dumps(fields | {"black_level": black}))
        for black in ([2048] * 4, [1500, 2000, 2500, 3000])
    ]
    rng = np.random.default_rng(10)
    share = rng.uniform(0.1, 0.8, (64, 400)) ** 2
    found, seen = [], []
    for sensor in sensors:
        black = np.tile(np.reshape(sensor.black_level, (2, 2)), (32, 200))
        dn = np.rint(black + share * (sensor.white_level - black)).astype(np.uint16)
        found.append(details(dn, sensor))
        seen.append((neutral_of_all(dn, sensor), binned(dn, sensor).means))
    assert found[0] == pytest.approx(found[1], rel=2e-3)  # DN are whole
    assert seen[0][0] == pytest.approx(seen[1][0], rel=1e-3)
    assert seen[0][1] == pytest.approx(seen[1][1], abs=2e-4)


@pytest.mark.filterwarnings("error")
def test_a_frame_that_is_black_or_white_is_taken_for_grey():
    sensor = Sensor("canon-700d")
    black = np.full((64, 64), sensor.black_level[0], np.uint16)
    for plane in (black, black - 5, np.full_like(black, sensor.white_level)):
        assert neutral_of_all(plane, sensor) == (1, 1, 1)
