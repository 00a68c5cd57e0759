# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The full well, and photons that are counted."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.effects.catalogue import effect
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.point import Excess, point_of
from cg2raw.diagnose.scenes.predict import predict
from cg2raw.diagnose.scenes.shapes import _gain, full_well, photons
from cg2raw.diagnose.scenes.view import views_of
from diagnose.planted import (
    FULL_WELL,
    READ,
    SHAPE,
    capture_of,
    drawn,
    frames_of,
    sensor_of,
    shown,
)

SENSOR = sensor_of()


def points(seed, level=None, kind="scene", count=4, **more):
    """Return points of frames whose charge is cut at a level."""
    captures = [capture_of(kind, n, **more) for n in range(seed, seed + count)]
    frames = drawn(frames_of(SENSOR, captures), Model(SENSOR), seed)
    if level is not None:
        rng = np.random.default_rng(seed)
        for n, frame in enumerate(frames):
            wells = level + READ * rng.normal(size=frame.signal.shape)
            frames[n] = replace(frame, signal=np.minimum(frame.signal, wells))
    return points_of(frames)


def points_of(frames, sensor=SENSOR):
    views = views_of(frames)
    return [point_of(view, view.frame, Model(sensor), Excess()) for view in views]


@pytest.mark.parametrize("level", [0.35, 0.45])
def test_a_well_is_found(level):
    found, error, gain = full_well(points(1, level), points(11, level))
    assert found == pytest.approx(level, abs=2e-3)
    assert 0 < error < 1e-3
    assert gain > 100


def blended(seed):
    """Return points of scenes with highlights of 4 x 4 px that clip; each pixel takes
    2 % of the four next ones of its colour."""
    found = []
    for n in range(seed, seed + 4):
        scene = np.full((*SHAPE, 3), 0.3, np.float32)
        for row, column in np.random.default_rng(n).integers(0, 60, (60, 2)):
            scene[row : row + 4, column : column + 4] = 3.0
        [frame] = frames_of(SENSOR, [capture_of(seed=n, scene=lambda s=scene: s)])
        [frame] = drawn([frame], Model(SENSOR), n)
        turned = [np.roll(frame.signal, by, axis) for by in (-2, 2) for axis in (1, 2)]
        found.append(shown(frame, 0.98 * frame.signal + 0.02 * np.mean(turned, axis=0)))
    return points_of(found)


def test_white_that_is_blended_with_darker_pixels_is_no_well():
    train, validation = blended(1), blended(11)
    assert full_well(train, validation)[2] > 100
    assert full_well(train, validation, are_blended=True)[2] <= 0
    well = full_well(points(1, 0.35), points(11, 0.35), are_blended=True)
    assert well[0] == pytest.approx(0.35, abs=2e-3) and well[2] > 100


def test_no_well_is_none():
    _, _, gain = full_well(points(1), points(11))
    assert gain <= 0


def counted(seed, is_counted, dark_current=(), levels=6 * (0.003,)):
    """Return (points, residuals) of dim flats, drawn by Poisson's law or a normal.

    dark_current : (rate, log_sigma) by which pixels differ, the same in all frames."""
    name = "dark_current_nonuniformity"
    values = dict(zip(("rate", "log_sigma"), dark_current, strict=False))
    sensor = sensor_of(effects={name: values} if values else None)
    captures = [capture_of("flat", n, level=x) for n, x in enumerate(levels)]
    frames, rng = frames_of(sensor, captures), np.random.default_rng(seed)
    normal = rng.standard_normal(frames[0].signal.shape)
    for n, frame in enumerate(frames):
        own, light = 0.0, predict(Model(SENSOR), frame).mean
        if values:
            own = values["rate"] * np.expm1(values["log_sigma"] * normal)
        if is_counted:
            charge = rng.poisson(light * FULL_WELL) / FULL_WELL
        else:
            noise = np.sqrt(light / FULL_WELL)
            charge = light + noise * rng.standard_normal(normal.shape)
        read = READ * rng.standard_normal(normal.shape)
        frames[n] = replace(frame, signal=charge + own + read)
    found = points_of(frames, sensor)
    return found, [point.view.signal - point.mean for point in found]


def test_photons_that_are_counted():
    assert photons(*counted(1, True)) > 10
    assert photons(*counted(1, False)) < -10


def test_dark_current_that_differs_is_no_counted_light():
    """It is as skewed, and the same in all frames; light of several levels is not."""
    uneven = 1.2e-4, 1.0
    assert photons(*counted(2, False, uneven)) < 0
    assert photons(*counted(1, True, uneven, levels=0.001 * 2.0 ** np.arange(6))) > 5


def test_photons_gain_what_is_expected_of_them():
    """Of some 60, within three times the root of twice that."""
    points, residuals = counted(1, True)
    seen = [(point.frame, predict(Model(SENSOR), point.frame)) for point in points]
    expected = effect("poisson_shot_noise").expected_gain(seen)
    assert photons(points, residuals) == pytest.approx(
        expected(1.0), abs=3 * np.sqrt(2 * expected(1.0))
    )
    assert expected(0.5) == pytest.approx(expected(1.0) / 4)


def test_samples_at_white_tell_a_well_by_their_chance_to_be_there():
    """As bright as white, and a well at white: half of them would be there, and of
    those half again."""
    x, white = np.ones(8), np.full(8, 0.01)
    samples = x, x, white, white, white > 0, x, np.full(8, np.inf)
    assert _gain(samples, 1.0) == pytest.approx(8 * np.log(0.5))
