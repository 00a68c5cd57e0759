# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The U-net: crops that keep the mosaic, a planted map, going on after a stop."""

from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

from studies.learners import unet as learner  # noqa: E402
from studies.learners.lesson import Lesson  # noqa: E402
from studies.learners.unet_denoiser import SITES, file_name, unet_learner  # noqa: E402
from studies.learners.unet_network import layers  # noqa: E402
from studies.protocol import PROTOCOL  # noqa: E402

RULES = replace(
    PROTOCOL.unet, width=16, levels=2, size=16, batch=4, rate=3e-3, every=40
)


def planted(count=8, seed=1):
    """Images (count, 3, 20, 24), and a map of them: channels turned, and squared."""
    rng = np.random.default_rng(seed)
    patches = rng.random((count, 3, 5, 6), dtype=np.float32)
    images = patches.repeat(4, axis=2).repeat(4, axis=3)
    return learner.Examples(images, images[:, [2, 0, 1]] ** 2, count // 4)


@pytest.fixture(scope="module")
def trained():
    return learner.train(planted(), RULES, 240, seed=3)


def test_it_learns_a_planted_map(trained):
    new = planted(4, seed=7)
    error = ((trained(new.inputs) - new.goals) ** 2).mean()
    assert error < 0.1 * new.goals.var()


def test_the_weights_are_those_that_were_best(trained):
    examples = planted()
    last = trained(examples.inputs[-2:])
    error = ((last - examples.goals[-2:]) ** 2).mean()
    assert error == pytest.approx(min(trained.validation), rel=1e-5)
    assert trained.validation[trained.step // 40 - 1] == min(trained.validation)
    assert len(trained.validation) == 6


def test_images_of_any_size_keep_it(trained):
    images = planted(1).inputs[:, :, :19, :21]
    assert trained(images).shape == images.shape


def test_the_protocols_network_starts_at_nothing():
    rules = PROTOCOL.unet
    parts = layers(4, 4, rules.width, rules.levels, 0)
    found = learner.applied(parts, torch.rand(1, 4, 48, 64), False)
    assert found.shape == (1, 4, 48, 64) and not found.any()
    assert [p[0].out_channels for p in parts["down"]] == [32, 64, 128]


def test_a_stopped_training_goes_on_bit_by_bit(trained, tmp_path, monkeypatch):
    path = tmp_path / "unet.pt"
    steps = []
    go_on = learner.Training.go_on

    def stopped(training, count):
        if training.step == 120:
            raise KeyboardInterrupt
        steps.append(training.step)
        go_on(training, count)

    monkeypatch.setattr(learner.Training, "go_on", stopped)
    with pytest.raises(KeyboardInterrupt):
        learner.train(planted(), RULES, 240, 3, path)
    monkeypatch.setattr(
        learner.Training,
        "go_on",
        lambda training, count: (steps.append(training.step), go_on(training, count)),
    )
    again = learner.train(planted(), RULES, 240, 3, path)
    assert steps == [0, 40, 80, 120, 160, 200]
    images = planted(2, 5).inputs
    assert np.array_equal(again(images), trained(images))
    assert (again.validation, again.step) == (trained.validation, trained.step)
    # What is done is read, and only where it is of the same examples and settings.
    assert np.array_equal(
        learner.train(planted(), RULES, 240, 3, path)(images), again(images)
    )
    assert len(steps) == 6
    learner.train(planted(), RULES, 40, 4, path)
    assert len(steps) == 7


def test_a_flip_leaves_sites_as_they_are_in_the_mosaic():
    """Planes of a mosaic's rows and columns: each crop is a mosaic that counts evenly,
    up or down, from a site of red."""
    rows, columns = np.mgrid[:20, :24].astype(np.float32)
    mosaic = np.stack([rows, columns])
    planes = np.stack([mosaic[:, row::2, column::2] for row, column in SITES])
    images = np.moveaxis(planes, 0, 1).reshape(2, 4, 10, 12)
    examples = learner.Examples(images, images, 1, sites=SITES)
    ways = set()
    for seed in range(40):
        crop = learner.drawn_crop(examples, 8, np.random.default_rng(seed))
        found = np.empty((2, 16, 16))
        for part, image in zip(found, images, strict=True):
            for plane, (row, column) in zip(crop(image), SITES, strict=True):
                part[row::2, column::2] = plane
        down, along = np.diff(found[0], axis=0), np.diff(found[1], axis=1)
        assert np.ptp(down) == np.ptp(along) == 0.0
        assert (
            not np.diff(found[0], axis=1).any() and not np.diff(found[1], axis=0).any()
        )
        ways.add((down[0, 0], along[0, 0]))
    assert ways == {(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)}


def test_crops_need_room():
    images = np.zeros((2, 4, 16, 16), np.float32)
    with pytest.raises(ValueError, match="16x16 are too small for crops of 17"):
        learner.train(
            learner.Examples(images, images, 1, sites=SITES), RULES, 1, seed=0
        )


def test_it_denoises_what_is_smooth(tmp_path):
    rng = np.random.default_rng(1)
    ramp = np.linspace(0.2, 0.8, 32) * rng.uniform(0.5, 1.0, (12, 4, 1, 1))
    clean = 0.1 * np.broadcast_to(ramp, (12, 4, 24, 32)).astype(np.float32)

    def noisy(planes, rng):
        noise = 0.003 * rng.standard_normal(planes.shape)
        return np.asarray(planes + noise, np.float32)

    rules = replace(RULES, steps={"quick": 160})
    lesson = Lesson(clean, noisy, 0.1, 3, 0, "a7s, ISO 1600/own")
    denoise = unet_learner(rules, "quick", tmp_path)(lesson)
    dirty = noisy(clean, np.random.default_rng(5))
    assert ((denoise(dirty) - clean) ** 2).mean() < 0.5 * 0.003**2
    assert [p.name for p in tmp_path.iterdir()] == [file_name(lesson.name) + ".pt"]
    assert file_name(lesson.name) == "a7s__ISO_1600_own"
