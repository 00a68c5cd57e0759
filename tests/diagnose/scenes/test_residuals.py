# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is left is said, and nothing of noise."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import STRUCTURE
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.pictures import histogram, pictures_of, scale_of
from cg2raw.diagnose.scenes.point import Excess, point_of
from cg2raw.diagnose.scenes.predict import photon_gain, predict
from cg2raw.diagnose.scenes.residuals import Residuals
from cg2raw.diagnose.scenes.view import views_of
from diagnose.planted import BY_NAME, capture_of, drawn, frames_of, scene_of, sensor_of

SENSOR = sensor_of()


def asked_of(extra, seed=1, kinds=("flat", "scene", "scene"), of_noise=None):
    captures = [
        capture_of(kind, n, set=f"{kind}{n}", name=f"{kind}{n}{again}")
        for n, kind in enumerate(kinds)
        for again in range(2)
    ]
    frames = drawn(frames_of(SENSOR, captures), Model(SENSOR), seed, extra)
    asked = Residuals(of_noise)
    for view in views_of(frames):
        asked.add(point_of(view, view.frame, Model(SENSOR), Excess()), [])
    return {test.name: test for test in asked.tests()}


def test_noise_leaves_nothing():
    chances = [
        test.p_value for seed in range(8) for test in asked_of(0.0, seed).values()
    ]
    assert len(chances) == 8 * 13
    assert min(chances) > STRUCTURE / 13
    assert 0.35 < np.mean(chances) < 0.65


def rows(frame, rng):
    return 3e-3 * rng.standard_normal((1, frame.signal.shape[1], 1))


def columns(frame, rng):
    return 3e-3 * rng.standard_normal((1, 1, frame.signal.shape[2]))


def bump(frame, rng):
    v, u = frame.tiles.field()
    return 1e-2 * np.exp(-((u - 0.3) ** 2 + v**2) / 0.01)


def blended(frame, rng):
    noise = 4e-3 * rng.standard_normal(frame.signal.shape)
    return noise + np.roll(noise, 2, 2)


def light(frame):
    return predict(Model(SENSOR), frame).mean


def smeared(frame, rng):
    return 0.02 * light(frame).mean(axis=1, keepdims=True)


def moved_across(frame, rng):
    """Blurred across, and as much sharper down: no blur of a lens."""
    mean = light(frame)
    wider = [np.roll(mean, n, axis) for axis in (1, 2) for n in (-2, 2)]
    return 0.03 * (wider[2] + wider[3] - wider[0] - wider[1])


def of_one_site(frame, rng):
    return 1e-3 * (frame.site == 1)


def radius(frame):
    return np.hypot(*frame.tiles.field())


def tilted(frame, rng):
    return 0.02 * light(frame) * frame.tiles.field()[0]


def ringed(frame, rng):
    return 0.02 * light(frame) * (np.abs(radius(frame) - 0.5) < 0.1)


def bent(frame, rng):
    return 0.01 * np.sin(12 * light(frame))


def noisy_corners(frame, rng):
    return 8e-3 * radius(frame) ** 2 * rng.standard_normal(frame.signal.shape)


@pytest.mark.parametrize(
    ("extra", "name"),
    [
        (of_one_site, "sites"),
        (tilted, "fields"),
        (ringed, "radius"),
        (bent, "level"),
        (noisy_corners, "variance by radius"),
        (smeared, "streaks"),
        (moved_across, "edges"),
        (rows, "rows"),
        (columns, "columns"),
        (bump, "blocks"),
        (blended, "neighbours"),
        (blended, "variance by level"),
        (blended, "repeats"),
    ],
)
def test_what_is_planted_is_said(extra, name):
    found = asked_of(extra)[name]
    assert found.p_value < 1e-6
    assert found.nats_per_pixel > 2e-4
    assert found.where


def brighter_noise(frame, rng):
    """A tenth more of the variance of light."""
    more = 0.1 * photon_gain(Model(SENSOR), frame) * light(frame)
    return np.sqrt(more) * rng.standard_normal(frame.signal.shape)


@pytest.mark.parametrize(
    ("of_noise", "is_left"),
    [
        (None, True),
        (np.diag([20.0, 1e9]), False),  # of light it is known to a fifth alone
        (np.diag([1e9, 20.0]), True),
    ],
)
def test_noise_may_be_off_by_the_error_of_its_fit(of_noise, is_left):
    asked = asked_of(brighter_noise, of_noise=of_noise)
    for name in ("variance by level", "variance by radius", "repeats"):
        assert (asked[name].p_value < 1e-4) == is_left


def test_levels_are_parts_of_the_light_that_there_is():
    """More noise where it is darker, and less elsewhere: as much in all."""
    asked, dim = Residuals(), np.float32(0.05) * scene_of(1)
    captures = 2 * [capture_of(scene=lambda: dim)]
    for frame in drawn(frames_of(SENSOR, captures), Model(SENSOR), 1):
        mean = light(frame)
        size = np.where(mean < np.median(mean), 1.1, 0.9)
        other = replace(frame, signal=mean + size * (frame.signal - mean))
        [view] = views_of([other])
        asked.add(point_of(view, other, Model(SENSOR), Excess()), [])
    found = {test.name: test.p_value for test in asked.tests()}
    assert found["variance by level"] < 1e-6 < found["variance by radius"]


@pytest.mark.parametrize(
    ("shape", "cfa", "side"),
    [
        ((300, 400), "RGGB", 1),
        ((512, 512), "RGGB", 1),
        ((1200, 1600), "RGGB", 4),
        ((1200, 1800), 9 * "RGGB", 6),
    ],
)
def test_a_large_picture_is_of_cells_of_whole_repeats(shape, cfa, side):
    assert scale_of(shape, cfa) == side


def test_tiles_are_mounted_where_they_lie():
    """Of a ramp that is another at each pixel; demosaicing keeps what was measured."""
    shape = (320, 480)
    rows, cols = np.mgrid[: shape[0], : shape[1]]
    raw = 300 + 20 * rows + 7 * cols
    capture = capture_of(shape=shape, raw=lambda: raw.astype(np.uint16))
    (view,) = views_of(frames_of(SENSOR, [capture], 16384))
    point = point_of(view, view.frame, Model(SENSOR), Excess())
    (picture,) = pictures_of([point], [point])
    shown = picture.measured
    seen = np.isfinite(shown[..., 1])
    assert 0.05 < seen.mean() < 0.9
    for site, letter in enumerate(SENSOR.cfa):
        own = seen & (rows % 2 == site // 2) & (cols % 2 == site % 2)
        expected = (raw - 256) / (16383 - 256)
        found = shown[..., "RGB".index(letter)]
        np.testing.assert_allclose(found[own], expected[own], rtol=1e-5)


def test_residual_maps_have_the_noise_of_a_frame():
    """A cell is the mean of so many standard deviates, times its side: such a one."""
    [frame] = drawn(frames_of(SENSOR, [capture_of("flat", 3)]), Model(SENSOR), 3)
    [view] = views_of([frame])
    brighter = Model(SENSOR).with_effect(BY_NAME["exposure"], [0.02])
    first, last = (
        point_of(view, view.frame, model, Excess())
        for model in (brighter, Model(SENSOR))
    )
    (picture,) = pictures_of([first], [last])
    assert np.isfinite(picture.z_after).mean() > 0.5
    assert np.nanstd(picture.z_after) == pytest.approx(1, abs=0.15)
    assert abs(np.nanmean(picture.z_after)) < 0.3
    assert np.nanmean(picture.z_before) < -2  # less light than predicted


def test_residuals_are_counted_where_they_count_the_farthest_at_the_ends():
    z, root = np.array([[-99.0, 0.01, 99.0, 5.0]]), np.array([[1.0, 2.0, 1.0, 0.0]])
    edges, counts = histogram([SimpleNamespace(z=z, root=root)] * 2)
    at = [0, np.searchsorted(edges, 0.01) - 1, len(counts) - 1]
    assert counts.sum() == 6 and counts[at].tolist() == [2, 2, 2]
    assert histogram([])[1].sum() == 0
