# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Draws of a study: each is there once, whatever interrupted the run before."""

from dataclasses import replace

import pytest

from studies import draws
from studies.results import read_results
from studies.sources.frames import Frames


@pytest.fixture
def ran(monkeypatch):
    """(what a study was asked, in its order: (seed, tests); seeds at which it stops)"""
    asked, stops = [], set()

    def draw(of, _sources, tests):
        asked.append((of.seed, sorted(tests)))
        if of.seed in stops:
            raise KeyboardInterrupt
        return {name: {"real": {"psnr": [float(of.seed)]}} for name in tests}

    learned = draws.Learned("isp", "night", lambda *_: Frames([], None), draw)
    monkeypatch.setattr(draws, "LEARNED", {"isp": learned})
    monkeypatch.setattr(draws, "sources_of", lambda *_: {})
    monkeypatch.setattr(draws, "made_by_of", lambda *_: {"core": "a"})
    return asked, stops


@pytest.fixture
def run(world, tmp_path):
    """A run of three draws."""
    rules = replace(world.protocol.isp, draws={"quick": 3})
    small = replace(world, protocol=replace(world.protocol, isp=rules))
    return draws.Run(small, "quick", {}, tmp_path, lambda _: None)


def test_an_interrupted_run_goes_on(run, ran, camera_of, tmp_path):
    asked, stops = ran
    camera = camera_of("sony-a7s-ii")
    stops.add(1)
    with pytest.raises(KeyboardInterrupt):
        draws.go_on(run, "isp", camera)
    stops.clear()
    results = read_results(tmp_path)
    draws.go_on(replace(run, results=results), "isp", camera)
    assert [seed for seed, _ in asked] == [0, 1, 1, 2]
    entry = draws.entry_of(results, camera, "isp")
    assert entry == {"real": {"psnr": [[0.0], [1.0], [2.0]]}}
    draws.go_on(replace(run, results=results), "isp", camera)
    assert len(asked) == 4


def test_more_test_frames_are_entries_of_their_own(run, ran, camera_of):
    asked, _ = ran
    camera = camera_of("sony-a7s-ii")
    draws.go_on(run, "isp", camera)
    draws.go_on(replace(run, judge=lambda _: Frames([], None)), "isp", camera)
    # The world's frames are not asked of a second time.
    assert asked[3:] == [(seed, [draws.JUDGE]) for seed in range(3)]
    for name in ("isp", f"isp, {draws.JUDGE}"):
        assert draws.draws_of(draws.entry_of(run.results, camera, name)) == 3


def test_held_out_leds_are_in_no_training_frame(run, camera_of, monkeypatch):
    """By the neutrals of main lights; the illuminant study's have them."""
    camera, learned = camera_of("canon-600d"), draws.LEARNED["held_out_leds"]
    rules = replace(run.world.protocol.illuminant, frames={"quick": 6})
    world = replace(run.world, protocol=replace(run.world.protocol, illuminant=rules))
    small = replace(run, world=world)
    pool = world.lights["train"]
    leds = {tuple(n) for n in camera.neutrals(pool.powers[pool.led]).round(9)}
    met = {
        name: {
            tuple(n)
            for n in draws.material_of(small, of, camera, 0).captures.neutrals.round(9)
        }
        for name, of in (("held out", learned), ("all", draws.LEARNED["light_draws"]))
    }
    assert met["all"] & leds and not met["held out"] & leds
