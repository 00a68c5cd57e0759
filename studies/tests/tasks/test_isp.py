# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 3: the picture that is learnt, by whose metadata, and a small run."""

from dataclasses import replace

import numpy as np
import pytest

from studies.results import appended
from studies.sources.exposures import by_exposure
from studies.sources.frames import Frames
from studies.sources.ours import ours
from studies.sources.real import real
from studies.sources.sets import Draw, material
from studies.sources.upi import upi
from studies.summaries import reduced
from studies.tables_night import night_tables
from studies.tasks import isp as study
from studies.tasks.isp_unet import unet_learner
from studies.world.shots import night_shots


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("sony-a7s-ii")


@pytest.fixture(scope="module")
def small(world):
    """The world with few frames and features."""
    few = {"frames": {"quick": 10}, "tests": {"quick": 4}, "samples": {"quick": 3000}}
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
    """A render comes back from UPI's RAW by UPI's matrix, and not by the camera's; the
    goal XYZ is the render itself, whoever makes RAW of it."""
    rules = replace(small.protocol.isp, step=1)
    render = np.random.default_rng(1).uniform(0.05, 0.6, (24, 32, 3)).astype(np.float32)
    made = upi([render], camera.sensor, "published", seed=1)
    own = study.pairs(made, camera.sensor, rules).pictures
    others = Frames(made.images, made.neutrals)
    wrong = study.pairs(others, camera.sensor, rules).pictures
    assert list(own) == list(study.GOALS) and list(wrong) == [study.CAMERA]
    dull = (render > 0.1).all(axis=2) & (render < 0.4).all(axis=2)
    near, far = (
        np.abs(found[study.CAMERA][0] - own[study.XYZ][0])[dull]
        for found in (own, wrong)
    )
    assert near.max() < 0.02 and far.mean() > 3 * near.mean()


def test_the_goal_of_spectra_knows_no_camera(small, camera_of):
    """Two cameras that see one scene have one goal, but for its scale."""
    shots = night_shots(small, "test", small.protocol.isp.first, 3)
    found = []
    for name in ("sony-a7s-ii", "nikon-d850"):
        frames = real(shots, camera_of(name).sensitivities)
        found.append([scene / np.median(scene) for scene in frames.scenes])
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-3, atol=1e-4)


def test_a_clipped_render_is_white_to_the_learner(small, camera):
    """Half of the frame is clipped: it is as bright as its white in input and goal."""
    image = np.full((8, 8, 3), 0.25, np.float32)
    image[4:] = 8.0
    rules = replace(small.protocol.isp, step=1)
    made = ours([image], camera.sensor, lights=["D50"])
    shown = study.pairs(made, camera.sensor, rules)
    assert shown.inputs[0, 4:] == pytest.approx(1.0, abs=1e-3)
    assert shown.inputs[0, :4] == pytest.approx(0.5, abs=0.02)
    for pictures in shown.pictures.values():
        assert pictures[0, 4:] == pytest.approx(1.0, abs=1e-3)


def drawn(small, camera, seed, learner=None):
    """Return the entry of a draw of 10 frames, and of the sources that it had."""
    found = material(small, camera, "night", small.protocol.seeds, 10, seed)
    made = by_exposure(found, camera, seed)
    black = [image * np.float32(0.0) for image in found.captures.images]
    unlit = replace(found.captures, images=black)
    few = ("real", "real, other scenes", "ours, match", "upi, match")
    arms = {name: made[name] for name in few} | {"unlit": lambda: unlit}
    tests = {"world": study.test_frames(small, camera, "quick")}
    draw = Draw(small, camera, "quick", seed)
    return study.isp_draw(draw, arms, tests, learner)["world"]


@pytest.mark.slow
def test_a_draw_has_each_goal_source_measure_and_frame(small, camera):
    """Captures that are black at the exposure of their source teach nothing."""
    entry = {}
    for seed in (0, 1):
        entry = appended(entry, drawn(small, camera, seed))
    assert list(entry) == list(study.GOALS)
    for of_sources in entry.values():
        shapes = {m: np.shape(v) for m, v in of_sources["real"].items()}
        assert shapes == dict.fromkeys(("difference", "psnr", "ssim"), (2, 4))
        mean = {s: np.mean(e["difference"]) for s, e in of_sources.items()}
        assert mean["unlit"] > 3 * mean["real"]
    matrices = entry[study.CAMERA]
    ours_, upis = (
        np.mean(matrices[f"{of}, match"]["difference"]) for of in ("ours", "upi")
    )
    assert ours_ < 0.8 * upis
    text = night_tables({"sony-a7s-ii": reduced(entry)}, "Neural ISP")
    assert text.count("| ours, match - upi, match |") == 2
    real_, own = (
        np.mean(entry[study.XYZ][source]["difference"])
        for source in ("real", "ours, match")
    )
    assert f"| ours, match - real | {own - real_:+.2f} (" in text


@pytest.mark.slow
def test_a_unet_learns_both_goals(small, camera, tmp_path):
    pytest.importorskip("torch")
    rules = replace(small.protocol.isp_unet, steps={"quick": 60}, size=16, width=8)
    learner = unet_learner(rules, small.protocol.isp, "quick", tmp_path)
    found = drawn(small, camera, 0, learner)
    for of_sources in found.values():
        mean = {s: np.mean(e["difference"]) for s, e in of_sources.items()}
        assert mean["real"] < 0.5 * mean["unlit"]
    assert len(list(tmp_path.glob("*.pt"))) == 5
