# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Registration finds where a render lies, and how bright it is."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from cg2raw.diagnose.inference.registration import Registration, _first_guess
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import capture_of, drawn, frames_of, scene_of, sensor_of

SENSOR = sensor_of()
SHAPE = (96, 128)


def moved(scene, affine):
    """Return what the camera sees at x: the render at x + shift + linear @ (v, u)."""
    rows, cols = np.mgrid[: scene.shape[0], : scene.shape[1]].astype(float)
    half = np.hypot(*scene.shape[:2]) / 2
    v = (rows + 0.5 - scene.shape[0] / 2) / half
    u = (cols + 0.5 - scene.shape[1] / 2) / half
    places = [
        r + affine[i][0] + affine[i][1] * v + affine[i][2] * u
        for i, r in enumerate((rows, cols))
    ]
    planes = [
        map_coordinates(scene[..., i].astype(float), places, order=3, mode="mirror")
        for i in range(3)
    ]
    return np.stack(planes, -1).astype(np.float32)


def misplaced(affine, gain, seed=5, repeats=2):
    """Return frames of a render, drawn of one that lies elsewhere."""
    scene = scene_of(seed, SHAPE)
    captures = [
        capture_of(shape=SHAPE, set="a", name=f"a{n}", scene=lambda: scene)
        for n in range(repeats)
    ]
    seen = gain * moved(scene, affine)
    true = [replace(c, scene=lambda: seen) for c in captures]
    shown = drawn(frames_of(SENSOR, true), Model(SENSOR), seed)
    rendered = frames_of(SENSOR, captures)
    return [
        replace(
            frame,
            camera=other.camera,
            glare_context=other.glare_context,
            rendered=other.rendered,
        )
        for frame, other in zip(shown, rendered, strict=True)
    ]


@pytest.mark.parametrize(
    ("affine", "gain"),
    [
        ([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]], 1.0),
        ([[0.3, 0.0, 0.0], [-0.2, 0.0, 0.0]], 1.2),
        ([[-2.7, 0.2, -0.1], [1.4, 0.1, 0.3]], 0.8),
        ([[3.0, -0.3, 0.2], [-3.0, 0.3, 0.1]], 1.1),
    ],
)
def test_planted_shifts_and_gains_are_found(affine, gain):
    frames = misplaced(affine, gain)
    registration = Registration(frames, shift=True, exposure=True)
    registration.first(Model(SENSOR), frames)
    row, col, brightness = registration.found()["a"]
    assert (row, col) == pytest.approx((affine[0][0], affine[1][0]), abs=0.02)
    assert brightness == pytest.approx(gain, rel=0.002)
    for frame in map(registration.placed, frames):
        p = predict(Model(SENSOR), frame)
        used = frame.keep & (p.mean < 0.95)
        z = ((frame.signal - p.mean) / np.sqrt(p.variance))[used]
        assert np.mean(z**2) < 1.1
    before = registration.found()
    registration.again(Model(SENSOR), frames)
    after = registration.found()
    assert after["a"] == pytest.approx(before["a"], abs=2e-3)


def test_what_does_not_float_is_left_alone():
    frames = misplaced([[0.4, 0, 0], [0.3, 0, 0]], 1.1)
    registration = Registration(frames, shift=False, exposure=True)
    registration.first(Model(SENSOR), frames)
    row, col, gain = registration.found()["a"]
    assert (row, col) == (0, 0) and gain == pytest.approx(1.1, rel=0.03)
    placed = registration.placed(frames[0])
    assert placed.camera == pytest.approx(gain * frames[0].camera, rel=1e-5)
    still = misplaced([[0.4, 0, 0], [0.3, 0, 0]], 1.1)
    registration = Registration(still, shift=True, exposure=False)
    registration.first(Model(SENSOR), still)
    assert registration.found()["a"][2] == 1.0


def test_darks_and_flats_of_unknown_level_have_no_place():
    frames = frames_of(SENSOR, [capture_of("dark"), capture_of("flat", scene=None)])
    registration = Registration(frames, shift=True, exposure=True)
    registration.first(Model(SENSOR), frames)
    assert registration.found() == {}
    assert all(registration.placed(frame) is frame for frame in frames)


def test_a_frame_is_placed_by_its_render_however_often():
    frames = misplaced([[1.2, 0.1, 0], [-0.6, 0, 0.2]], 1.1)
    registration = Registration(frames, shift=True, exposure=True)
    registration.first(Model(SENSOR), frames)
    once = registration.placed(frames[0])
    twice = registration.placed(once)
    assert (once.camera != frames[0].camera).any()
    assert (twice.camera == once.camera).all()
    assert (twice.glare_context.wide == once.glare_context.wide).all()


def test_what_scatters_far_is_as_bright_as_the_render():
    frames = misplaced([[0.0, 0, 0], [0.0, 0, 0]], 1.2)
    before = frames[0].glare_context
    registration = Registration(frames, shift=False, exposure=True)
    registration.first(Model(SENSOR), frames)
    registration.again(Model(SENSOR), frames)  # of what was rendered, not once more
    gain = registration.found()["a"][2]
    assert gain == pytest.approx(1.2, rel=0.002)
    for frame in map(registration.placed, frames):
        assert frame.glare_context.wide == pytest.approx(gain * before.wide, rel=1e-5)
        assert frame.glare_context.mean == pytest.approx(gain * np.array(before.mean))


@pytest.mark.parametrize("shift", [(2, -2), (-4, 0), (0, 4)])
def test_the_first_guess_is_the_nearest_pair_of_pixels(shift):
    row, col = shift
    (frame,) = misplaced([[row, 0, 0], [col, 0, 0]], 1.1, repeats=1)
    assert _first_guess(frame, Model(SENSOR)).tolist() == [row, col]
