# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames: where tiles lie, and what is known of a capture."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.splits import third
from cg2raw.diagnose.frames.frame import (
    BORDER,
    UNIFORM_BORDER,
    camera_tiles,
    frame_of,
    planes_of_sites,
    source_of,
    warmth_of,
)
from cg2raw.diagnose.frames.tiling import (
    MARGIN,
    tiling,
)
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.noise_level import noise_models
from cg2raw.diagnose.scenes.predict import predict
from diagnose.planted import (
    SHAPE,
    capture_of,
    frames_of,
    model_of,
    scene_of,
    sensor_of,
)

SENSOR = sensor_of()
LARGE = (3000, 4000)


def inner(tiles):
    """Return (top, bottom, left, right) of the tiles."""
    rows, columns = tiles.rows_and_columns()
    return rows[:, 0, 0], rows[:, -1, 0] + 1, columns[:, 0, 0], columns[:, 0, -1] + 1


SIZES = [(480, 640), (640, 480), (1200, 1600), LARGE, (288, 4000), (6000, 9000)]
SIZES += [(260, 400), (700, 177), (400, 3000)]


@pytest.mark.parametrize("repeat", [2, 6])
@pytest.mark.parametrize("pixels", [8192, 65536, 10**6])
@pytest.mark.parametrize("shape", SIZES)
def test_tiles_lie_apart_in_all_corners_and_in_the_middle(shape, pixels, repeat):
    """Each starts a repeat. Sizes around those from which on a frame is not taken
    whole, too."""
    tiles = tiling(shape, pixels, repeat)
    assert (tiles.origins % repeat == 0).all() and tiles.margin % repeat == 0
    for places, size in ((tiles.origins, tiles.size), (tiles.blocks, tiles.block_size)):
        assert (places >= 0).all() and (places + size <= shape).all()
    covered = np.zeros(shape, np.uint8)
    for top, bottom, left, right in zip(*inner(tiles), strict=True):
        covered[top:bottom, left:right] += 1
    assert covered.max() == 1
    assert covered[:: shape[0] - repeat, :: shape[1] - repeat].all()  # the corners
    middle = covered[shape[0] // 2, shape[1] // 2]
    assert middle and covered[0, shape[1] // 2] and covered[shape[0] // 2, 0]
    if len(tiles.origins) > 1:
        assert 0.5 * pixels < covered.sum(dtype=int) < 1.6 * pixels
    else:
        assert covered.mean() > 0.95
    again = tiling(shape, pixels, repeat)
    assert (again.origins == tiles.origins).all()


@pytest.mark.parametrize("length", [*range(288, 600, 7), 1001, 3000])
@pytest.mark.parametrize("repeat", [2, 6])
def test_radii_between_centre_and_corner_are_seen(length, repeat):
    tiles = tiling((length, length * 4 // 3), 65536, repeat)
    u, v = tiles.field()
    radius = np.hypot(u, v)
    assert radius.min() < 0.02 and radius.max() > 0.985
    share, _ = np.histogram(radius, 10, (0, 1))
    assert (share > 100).sum() >= 7


def test_a_small_frame_is_one_tile():
    tiles = tiling(SHAPE, 65536)
    assert (tiles.size, tiles.margin, len(tiles.origins)) == (SHAPE, 0, 1)


@pytest.mark.parametrize("group", ["fit", "select", "report"])
def test_tiles_lie_where_a_mask_counts(group):
    wanted = np.zeros((1200, 1600), bool)
    wanted[500:620, 700:900] = third((120, 200), group)
    tiles = tiling(wanted.shape, 8192, 2, wanted)
    assert tiles.cut(wanted).sum() > 0.5 * min(8192, wanted.sum())
    assert tiles.cut(wanted).mean() > 1 / 9


def test_tiles_of_a_mask_that_lets_count_everywhere_lie_all_over():
    """A third of the pixels of all tiles: as many as hold what is wanted."""
    wanted = third((1200, 1600), "select")
    tiles = tiling(wanted.shape, 8192, 2, wanted)
    assert tiles.cut(wanted).sum() == pytest.approx(8192, rel=0.1)
    ends = np.add(tiles.origins.max(axis=0), tiles.size)
    assert (tiles.origins.min(axis=0) == 0).all() and (ends > (1180, 1570)).all()


def test_cut_and_field_agree_with_the_frame():
    tiles = tiling((600, 900), 32768)
    rows, columns = np.mgrid[:600, :900]
    u, v = tiles.field()
    half = np.hypot(600, 900) / 2
    np.testing.assert_allclose(tiles.cut((columns + 0.5 - 450) / half), u)
    np.testing.assert_allclose(tiles.cut((rows + 0.5 - 300) / half), v)
    wide = tiles.cut(rows, with_margin=True)
    middle = len(wide) // 2
    inside = wide[middle, MARGIN:-MARGIN, MARGIN:-MARGIN]
    assert (inside == tiles.cut(rows)[middle]).all()
    assert (tiles.inner(wide[:, None])[:, 0] == tiles.cut(rows)).all()
    assert (wide[0, 0, 0], wide[-1, -1, -1]) == (0, 599)  # moved into the frame


def test_light_is_cut_with_what_lies_around_each_tile():
    tiles = tiling((600, 900), 32768)
    image = np.random.default_rng(1).random((600, 900, 3), np.float32)
    found = camera_tiles(image, tiles)
    assert found.shape == (len(tiles.origins), 3, *tiles.block_size)
    for color in range(3):
        whole, inside = found[:, color], tiles.inner(found)[:, color]
        np.testing.assert_array_equal(inside, tiles.cut(image[..., color]))
        cut = tiles.cut(image[..., color], with_margin=True)
        np.testing.assert_array_equal(whole, cut)
    one = camera_tiles(np.float32([0.1, 0.2, 0.3]), tiles)
    assert one.shape == found.shape and (one[:, 1] == np.float32(0.2)).all()


@pytest.mark.parametrize("kind", ["scene", "flat", "dark"])
def test_the_frames_own_edges_count_wherever_tiles_lie(kind):
    shape = (320, 480)
    (frame,) = frames_of(SENSOR, [capture_of(kind, shape=shape)], 16384)
    border = BORDER if kind == "scene" else UNIFORM_BORDER
    assert len(frame.tiles.origins) > 1
    rows, columns = (
        np.broadcast_to(p, frame.keep.shape) for p in frame.tiles.rows_and_columns()
    )
    ends = np.minimum(
        np.minimum(rows, shape[0] - 1 - rows),
        np.minimum(columns, shape[1] - 1 - columns),
    )
    assert (frame.keep == (ends >= border)).all()


def test_planes_of_sites():
    site, color, values = planes_of_sites("GBRG", (4, 6), [1, 2, 3, 4])
    assert site[:2, :2].tolist() == [[0, 1], [2, 3]]
    assert color[:2, :2].tolist() == [[1, 2], [0, 1]]
    assert (values == site + 1).all()
    assert (planes_of_sites("GBRG", (4, 6), [7])[2] == 7).all()
    per_color = planes_of_sites("GBRG", (4, 6), [1, 2, 3])
    assert (per_color[2] == per_color[1] + 1).all()


def test_squares_of_slope_and_light_are_of_what_a_site_s_filter_passes():
    """Of a ramp down and across, a slope of each colour: both add to the square."""
    (frame,) = frames_of(SENSOR, [capture_of()])
    down, across = np.mgrid[: SHAPE[0], : SHAPE[1]] / 100
    ramps = np.stack([2 * down, 3 * down + 4 * across, 5 * across])[None]
    slope, light = replace(frame, camera=ramps, memo={}).squared_slope_and_light
    for site, color in (((0, 0), 0), ((0, 1), 1), ((1, 0), 1), ((1, 1), 2)):
        row, col = 20 + site[0], 30 + site[1]
        assert slope[0, row, col] == pytest.approx((2, 5, 5)[color] ** 2 / 1e4)
        assert light[0, row, col] == pytest.approx(ramps[0, color, row, col] ** 2)


def test_borders_of_a_whole_frame_and_masks_do_not_count():
    mask = np.ones(SHAPE, bool)
    mask[30:34, 40:44] = False
    (frame,) = frames_of(SENSOR, [capture_of(mask=lambda: mask)])
    assert not frame.keep[0, :BORDER].any() and not frame.keep[0, :, -BORDER:].any()
    assert not frame.keep[0, 30:34, 40:44].any()
    assert frame.keep.sum() == (SHAPE[0] - 16) * (SHAPE[1] - 16) - 16


def test_signal_and_ends_of_the_adc():
    raw = np.full(SHAPE, 1000, np.uint16)
    raw[10, 10], raw[10, 11] = 0, SENSOR.white_level
    (frame,) = frames_of(SENSOR, [capture_of(raw=lambda: raw)])
    black, white = SENSOR.black_level[0], SENSOR.white_level
    assert frame.signal[0, 20, 20] == pytest.approx((1000 - black) / (white - black))
    assert frame.at_zero.sum() == 1 and frame.at_zero[0, 10, 10]
    assert frame.at_white.sum() == 1 and frame.at_white[0, 10, 11]
    assert frame.range == pytest.approx(white - black)


@pytest.mark.parametrize("name", ["sony-a57", "fujifilm-x-m1"])
def test_a_flat_of_unknown_level_takes_its_own(name):
    sensor = Sensor(name)
    shape = (72, 108)
    rng = np.random.default_rng(3)
    color = planes_of_sites(sensor.cfa, shape, [0])[1]
    span = sensor.signal_range
    levels = np.array([0.2, 0.4, 0.3])
    dn = levels[color] * span + np.mean(sensor.black_level)
    raw = (dn + rng.normal(0, 5, shape)).astype(np.uint16)
    capture = capture_of("flat", shape=shape, scene=None, raw=lambda: raw, iso=None)
    captures = CaptureSet(sensor, [capture])
    tiles = tiling(shape, 65536, round(len(sensor.cfa) ** 0.5))
    frame = frame_of(
        source_of(captures, capture, capture.raw()), tiles, noise_models(captures)[None]
    )
    assert frame.level_free
    assert frame.camera[0, :, 30, 30] == pytest.approx(levels, rel=0.01)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (np.zeros((8, 9, 3)), "scene of 8 x 9 pixels, capture of 64 x 96; must be ali"),
        (
            np.full((*SHAPE, 3), np.nan),
            "the scene has values that are not finite; must",
        ),
        (
            np.array([1.0, np.inf, 1.0]),
            "the scene has values that are not finite; must",
        ),
    ],
)
def test_a_scene_is_finite_and_of_the_frame_s_size(scene, words):
    captures = CaptureSet(SENSOR, [capture_of(scene=lambda: scene)])
    with pytest.raises(ValueError) as error:
        source_of(captures, captures.captures[0], np.zeros(SHAPE, np.uint16))
    assert words in str(error.value)


@pytest.mark.parametrize(
    ("at", "frame", "times"), [(10.0, 16.0, 2), (10.0, 4.0, 0.5), (10.0, None, 1)]
)
def test_charge_gathers_twice_as_fast_every_6_kelvin(at, frame, times):
    assert warmth_of(capture_of("dark", temperature=frame), at) == times
    assert warmth_of(capture_of("dark", temperature=frame), None) == 1


def test_exposure_time_that_is_not_known_makes_rates_per_frame():
    (frame,) = frames_of(SENSOR, [capture_of(exposure_time=None)])
    assert frame.seconds == 1.0
    (frame,) = frames_of(SENSOR, [capture_of(exposure_time=0.25)])
    assert frame.seconds == 0.25


def test_a_bias_has_no_time_to_gather_charge():
    (frame,) = frames_of(SENSOR, [capture_of("dark", exposure_time=0.0)])
    assert frame.seconds == 0.0
    leaking = predict(model_of(SENSOR, dark_current=[0.01]), frame)
    assert (leaking.mean == predict(Model(SENSOR), frame).mean).all()


@pytest.mark.slow
def test_a_large_frame_is_kept_as_its_tiles():
    shape = (1000, 1400)
    scene = scene_of(2, shape)
    (frame,) = frames_of(
        SENSOR, [replace(capture_of(shape=shape), scene=lambda: scene)]
    )
    whole = sum(x.nbytes for x in vars(frame).values() if isinstance(x, np.ndarray))
    assert whole < 65536 * 1.6 * 80
    assert frame.camera.base is None or frame.camera.base.nbytes < 4 * 1400 * 1000
