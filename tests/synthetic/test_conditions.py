# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is wrong with captures, and no camera, is as large as is stated."""

import numpy as np
import pytest

from cg2raw.synthetic import captures as synthetic_captures
from cg2raw.synthetic import conditions, light
from cg2raw.synthetic.captures import simulate_captures

SHAPE = (48, 64)


@pytest.mark.parametrize(
    ("shift", "residual"), [(2.0, 0.0), (0.0, 0.2), (2.0, 0.2), (0.0, 0.0)]
)
def test_a_camera_stands_aside_by_no_more_than_is_stated(shift, residual):
    """Of ramps of a pixel a step: what they are moved by is what they change by."""
    field = light.Field((40, 50), 10)
    ramps = np.stack([100 + field.x, 100 + field.y, np.full(field.x.shape, 9.0)], -1)
    nuisances = {"shift": shift, "residual": residual}
    farthest = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        moved = conditions.misregistered(rng, ramps, field, nuisances)
        by = (moved - ramps)[field.inner]
        assert by[..., 2] == pytest.approx(0, abs=1e-9)  # no structure, no change
        aside = np.hypot(by[..., 0], by[..., 1])
        assert aside.max() <= shift + residual + 1e-3
        farthest.append(aside.max())
        if not residual:
            assert aside == pytest.approx(aside.max(), abs=1e-3)  # all alike
    assert max(farthest) >= 0.6 * (shift + residual)


def test_nuisances_change_the_capture_and_are_declared(sensor):
    clean = simulate_captures(sensor, {}, seed=11, shape=SHAPE)
    studio = simulate_captures(
        sensor, {}, seed=11, shape=SHAPE, nuisances=conditions.STUDIO
    )
    assert studio.nuisances == {"light", "exposure", "registration", "radiance"}
    assert clean.nuisances == frozenset() and clean.uncertainty == {}
    for one, other in zip(clean.captures, studio.captures, strict=True):
        if one.kind == "scene":
            ratio = other.scene() / one.scene()
            assert 0.005 < ratio.std() < 0.02
        if one.kind == "flat":
            black = sensor.black_level[0]
            factor = (other.raw().mean() - black) / (one.raw().mean() - black)
            assert 0.78 < factor < 1.22 and abs(factor - 1) > 1e-3
        if one.kind == "dark":
            np.testing.assert_array_equal(one.raw(), other.raw())


def test_a_render_is_off_by_what_is_stated():
    """Smoothly, rms of a set's render, and by grain, rms of a pixel."""
    scene = np.full((200, 300, 3), 0.5)
    for radiance, grain in ((0.01, 0.0), (0.0, 0.005), (0.01, 0.005)):
        nuisances = {"radiance": radiance, "render_noise": grain}
        off = (
            conditions.rendered(np.random.default_rng(1), scene, nuisances) / scene - 1
        )
        assert np.ptp(off, axis=2).max() < 1e-6  # of all colours alike
        off = off[..., 0]
        assert off.std() == pytest.approx(np.hypot(radiance, grain), rel=0.02)
        steps = np.diff(off, axis=1).std() / np.sqrt(2)
        assert steps == pytest.approx(grain, rel=0.02, abs=2e-4)


@pytest.mark.parametrize("studio", [True, False])
def test_captures_of_a_studio_say_what_may_be_off(studio):
    files = synthetic_captures.Synthesis(
        "canon-70d", "prnu", 1, "64x48", "D65", None, None, None, studio
    ).folder()
    name, text = next(iter(files.items()))
    assert name == "captures.yaml"
    for line in (
        b"nuisance: [exposure, light, radiance, registration]\n",
        b"uncertainty: {light: 0.005, radiance: 0.01}\n",
    ):
        assert (line in text) == studio
