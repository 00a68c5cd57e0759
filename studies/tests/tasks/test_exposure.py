# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the exposure of renders is worth: white of clipped renders, and a small run."""

from dataclasses import replace

import numpy as np
import pytest

from studies.results import appended
from studies.sources.exposures import by_exposure
from studies.sources.ours import ours
from studies.sources.sets import Draw, material
from studies.tables_exposure import exposure_tables
from studies.tasks import isp
from studies.tasks.exposure import ISP, exposure_draw


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("sony-a7s-ii")


@pytest.fixture(scope="module")
def small(world):
    """The world with few frames and features."""
    protocol = world.protocol
    few = {"frames": {"quick": 10}, "tests": {"quick": 3}}
    rules = replace(protocol.isp, **few, features=40, step=8)
    patches = replace(protocol.denoising, features=40, samples={"quick": 2000})
    arms = replace(protocol.exposures, isos=(3200,))
    own = replace(protocol, isp=rules, denoising=patches, exposures=arms)
    return replace(world, protocol=own)


def test_a_clipped_render_is_white_to_the_learner(world, camera):
    """Half of the frame is clipped: it is as bright as its white in input and goal."""
    image = np.full((8, 8, 3), 0.25, np.float32)
    image[4:] = 8.0
    made = ours([image], camera.sensor, lights=["D50"])
    rules = replace(world.protocol.isp, step=1)
    shown = isp.pairs(made, camera.sensor, rules, own_exposure=True)
    assert shown.inputs[0, 4:] == pytest.approx(1.0, abs=1e-3)
    assert shown.inputs[0, :4] == pytest.approx(0.5, abs=0.02)
    assert shown.pictures[0, 4:] == pytest.approx(1.0, abs=1e-3)
    exposed = isp.pairs(made, camera.sensor, rules)
    assert np.abs(exposed.inputs[0, 4:] - 1.0).max() > 0.05


def test_a_draw_has_both_tasks_and_each_source_at_its_exposure(small, camera):
    """Captures that are black at the exposure of their source teach no ISP."""
    entry, tests = {}, {"world": isp.test_frames(small, camera, "quick")}
    for seed in (0, 1):
        found = material(small, camera, "night", small.protocol.seeds, 10, seed)
        arms = by_exposure(found, camera, seed)
        black = tuple(image * np.float32(0.0) for image in found.captures.images)
        unlit = replace(found.captures, own=black)
        made = {name: arms[name] for name in ("real", "ours, auto")}
        made["unlit"] = lambda unlit=unlit: unlit
        errors = exposure_draw(Draw(small, camera, "quick", seed), made, tests)
        entry = appended(entry, errors["world"])
    denoising = "ISO 3200, brightness 0.35, own exposure"
    assert list(entry) == [ISP, denoising]
    assert set(entry[ISP]) == set(entry[denoising]) == set(made)
    assert np.shape(entry[denoising]["real"]["psnr"]) == (2, 3)
    mean = {source: np.mean(of["difference"]) for source, of in entry[ISP].items()}
    assert mean["unlit"] > 5 * mean["real"]
    text = exposure_tables({"sony-a7s-ii": entry})
    assert text.count("| ours, auto - real |") == 2
    gap = mean["ours, auto"] - mean["real"]
    assert f"| ours, auto - real | {gap:+.2f} (" in text
