# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 3: the picture that is learnt, by whose metadata, and a small run."""

from dataclasses import replace

import numpy as np
import pytest

from studies.results import appended
from studies.sources.frames import Frames
from studies.sources.sets import Draw, material, sources
from studies.sources.upi import upi
from studies.tables_isp import isp_tables
from studies.tasks import isp as study


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("sony-a7s-ii")


@pytest.fixture(scope="module")
def small(world):
    """The world with few frames and features."""
    few = {"frames": {"quick": 10}, "tests": {"quick": 4}}
    rules = replace(world.protocol.isp, **few, features=60, step=4)
    return replace(world, protocol=replace(world.protocol, isp=rules))


def test_the_tone_curve_rises_and_white_is_white():
    grey = np.linspace(0.0, 3.0, 400, dtype=np.float32)
    toned = study.toned(np.repeat(grey[:, None], 3, axis=1)[None])[0]
    rising = np.diff(toned[:, 0])
    assert (rising >= 0.0).all() and (rising[toned[1:, 0] < 1.0] > 0.0).all()
    assert toned[0, 0] == 0.0
    assert study.toned(np.ones((1, 1, 3), np.float32)) == pytest.approx(1.0, abs=1e-4)
    assert study.toned(np.full((1, 1, 3), -1.0, np.float32)).max() == 0.0


def test_frames_are_developed_by_their_own_matrices(small, camera):
    """A render comes back from UPI's RAW by UPI's matrix, and not by the camera's."""
    rules = replace(small.protocol.isp, step=1)
    render = np.random.default_rng(1).uniform(0.05, 0.6, (24, 32, 3)).astype(np.float32)
    made = upi([render], camera.sensor, "published", seed=1)
    goal = study.toned(study.scaled(render))
    own = study.pairs(made, camera.sensor, rules).pictures[0]
    others = Frames(made.images, made.neutrals)
    wrong = study.pairs(others, camera.sensor, rules).pictures[0]
    dull = (render > 0.1).all(axis=2) & (render < 0.4).all(axis=2)
    assert np.abs(own - goal)[dull].max() < 0.02
    assert np.abs(wrong - goal)[dull].mean() > 3 * np.abs(own - goal)[dull].mean()


def test_a_draw_has_each_source_measure_and_frame(small, camera):
    entry = {}
    tests = study.test_frames(small, camera, "quick")
    for seed in (0, 1):
        found = material(small, camera, "night", small.protocol.seeds, 10, seed)
        made = sources(found, camera, seed)
        draw = Draw(small, camera, "quick", seed)
        errors = study.isp_draw(draw, made, {"world": tests})["world"]
        entry = appended(entry, errors)
    shapes = {m: np.shape(v) for m, v in entry["real"].items()}
    assert shapes == {"difference": (2, 4), "psnr": (2, 4)}
    mean = {s: np.mean(e["difference"]) for s, e in entry.items()}
    assert mean["ours, dng"] < 0.8 * mean["upi, camera"]
    text = isp_tables({"sony-a7s-ii": entry})
    assert "| ours, dng - upi, camera |" in text
