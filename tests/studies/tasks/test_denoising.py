# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 2: the noise that is added, what is packed and learnt, and a small run."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from studies.protocol import PROTOCOL
from studies.sources.frames import Frames
from studies.tables_denoising import denoising_tables
from studies.tasks import denoising as study

NOISE = study.Noise(2e-3, 1e-4)


def test_noise_has_the_variance_that_is_stated():
    planes = np.full((4, 4, 200, 200), 0.3, np.float32)
    noisy = NOISE.added(planes, np.random.default_rng(1))
    assert noisy.mean() == pytest.approx(0.3, abs=2e-4)
    assert noisy.var() == pytest.approx(2e-3 * 0.3 + 1e-4, rel=0.01)
    assert NOISE.added(-planes, np.random.default_rng(1)).var() == pytest.approx(
        1e-4, rel=0.01
    )


def test_noise_is_the_sensors_mean_over_sites():
    noise = study.noise_of(Sensor("samsung-s20fe"), 3200)
    known = Sensor("samsung-s20fe").noise_at(3200)
    assert noise.of_signal == pytest.approx(np.mean(known["beta1"]))
    assert noise.constant == pytest.approx(np.mean(known["beta2"]))


def test_packing_takes_the_sites_of_rggb():
    image = np.arange(4 * 6 * 3, dtype=np.float32).reshape(4, 6, 3) / 72
    planes = study.packed(Frames([image], np.ones((1, 3))))
    kept = study.exposed(image)
    assert planes.shape == (1, 4, 2, 3)
    assert np.array_equal(planes[0, 0], kept[::2, ::2, 0])
    assert np.array_equal(planes[0, 1], kept[::2, 1::2, 1])
    assert np.array_equal(planes[0, 2], kept[1::2, ::2, 1])
    assert np.array_equal(planes[0, 3], kept[1::2, 1::2, 2])


def test_patches_are_centred():
    planes = np.random.default_rng(2).random((2, 4, 9, 8), dtype=np.float32)
    inner = planes[:, :, 2:-2, 2:-2].transpose(0, 2, 3, 1).reshape(-1, 4)
    assert np.array_equal(study.centres(study.patches(planes)), inner)


def smooth(count, seed):
    """Planes (count, 4, 24, 32) without detail."""
    rng = np.random.default_rng(seed)
    ramp = np.linspace(0.2, 0.8, 32) * rng.uniform(0.5, 1.0, (count, 4, 1, 1))
    return np.broadcast_to(ramp, (count, 4, 24, 32)).astype(np.float32)


def test_it_denoises_what_is_smooth():
    draw = study.Draw(replace(PROTOCOL.denoising, features=100), 8000, 0)
    clean = smooth(4, 9)
    found = np.mean(study.psnr_of(smooth(30, 1), clean, NOISE, draw))
    noisy = NOISE.added(clean, np.random.default_rng(3))
    before = -10 * np.log10(((noisy - clean) ** 2).mean())
    assert found > before + 6.0


def test_a_run_has_each_condition_draw_and_frame(world, camera_of):
    few = {"frames": {"quick": 10}, "tests": {"quick": 3}, "draws": {"quick": 2}}
    rules = replace(
        world.protocol.denoising,
        **few,
        features=40,
        samples={"quick": 2000},
        isos=(3200,),
    )
    small = replace(world, protocol=replace(world.protocol, denoising=rules))
    found = study.denoising(small, camera_of("sony-a7s-ii"), "quick")
    assert list(found) == ["ISO 3200, brightness 0.35", "ISO 3200, brightness 0.03"]
    for entry in found.values():
        assert {np.shape(values) for values in entry.values()} == {(2, 3)}
    text = denoising_tables({"sony-a7s-ii": found})
    assert text.count("| ours, dng - upi, camera |") == 2
