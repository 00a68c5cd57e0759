# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Saved statistics of darks and flats, in the place of their frames."""

import json
import os
import sys
from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.constant_statistics import saved_statistics
from cg2raw.diagnose.captures.reader import read_captures
from cg2raw.diagnose.pipeline import diagnose
from diagnose.capture_files import manifest
from oracles import cameras
from python.commands import fails, run

SHAPE, BLACK, GAIN, READ = (48, 64), 100, 2.0, 3.0  # DN, e-/DN, DN


@pytest.fixture
def path(tmp_path):
    """Return the manifest of darks and flats of a monochrome camera."""
    profile = cameras.mono_text(id="mono", black_level=BLACK, noise=[])
    (tmp_path / "sensor.json").write_text(profile)
    lines = []
    for number in range(18):
        light = (0, 400, 1200)[number % 3]
        taken(tmp_path / f"{number}.npy", light, number)
        said = "flat, scene: unknown" if light else "dark, exposure_time: 1"
        lines.append(f"{{file: {number}.npy, iso: 100, kind: {said}}}")
    return manifest(tmp_path, lines, "sensor: ./sensor.json")


def taken(path, light, seed):
    rng = np.random.default_rng(seed)
    fall = 1 - 0.2 * np.linspace(-1, 1, SHAPE[1]) ** 2  # its size is of mean images
    charge = rng.poisson(light * GAIN * fall, SHAPE) / GAIN
    noise = READ * rng.standard_normal(SHAPE)
    np.save(path, np.rint(BLACK + charge + noise).clip(0).astype(np.uint16))


def saved(path):
    """Return the file of their statistics, by the captures as they are."""
    captures = read_captures(path)
    saved_statistics(path.parent / "kept.npz", captures.captures, captures.sensor)
    return path.parent / "kept.npz"


def ran(path, *more):
    """Return verdict.json without its seconds."""
    report = path.parent / "report"
    done = run("diagnose", "run", path, "-o", report, "-q", *more)
    assert (done.code, done.err) == (0, "")
    found = json.loads((report / "verdict.json").read_text())
    del found["seconds"]
    return found


def refused(path, file):
    return fails("diagnose", "run", path, "-o", path.parent / "r", "--statistics", file)


def test_a_report_of_them_is_that_of_the_frames(path, monkeypatch):
    expected = ran(path)
    assert "lens_shading" in [one["name"] for one in expected["effects"]]
    file = path.parent / "kept.npz"
    assert ran(path, "--statistics", file) == expected
    assert 4 < file.stat().st_size / (18 / 2 * SHAPE[0] * SHAPE[1])
    written = file.stat().st_mtime_ns
    reads = "cg2raw.diagnose.captures.constant_statistics.statistics_by_split"
    monkeypatch.setattr(reads, None)
    assert ran(path, "--statistics", file) == expected
    assert file.stat().st_mtime_ns == written


def exposed_longer(path):
    path.write_text(path.read_text().replace("time: 1}", "time: 9}", 1))


def masked(path):
    mask = np.ones(SHAPE, bool)
    mask[3, 5] = False
    np.save(path.parent / "mask.npy", mask)
    path.write_text("mask: mask.npy\n" + path.read_text())


def retaken(path):
    taken(path.parent / "0.npy", 0, 77)


@pytest.mark.parametrize("change", [exposed_longer, masked, retaken])
def test_frames_that_have_changed_are_refused(path, change):
    file = saved(path)
    before = file.read_bytes()
    change(path)
    words = f"{file}: statistics of other frames: 0.npy has changed; remove"
    assert words in refused(path, file)
    assert file.read_bytes() == before


def test_another_file_is_refused_and_left(path):
    """Also where scenes could be diagnosed without darks and flats."""
    file = path.parent / "kept.npz"
    file.write_bytes(b"no archive")
    assert f"{file}: no statistics of frames" in refused(path, file)
    assert "kept.png: must end in .npz" in refused(path, path.parent / "kept.png")
    assert f"{path.parent}: must be a file that" in refused(path, path.parent)
    np.save(path.parent / "render.npy", np.zeros((*SHAPE, 3), np.float32))
    taken(path.parent / "scene.npy", 0, 18)
    scene = "{file: scene.npy, iso: 100, kind: scene, scene: render.npy}"
    path.write_text(f"{path.read_text()}\n  - {scene}")
    assert f"{file}: no statistics of frames" in refused(path, file)
    assert file.read_bytes() == b"no archive"
    path = manifest(path.parent, [scene], "sensor: ./sensor.json")
    assert f"{file}: statistics are of darks and flats: none" in refused(path, file)


def test_an_interruption_leaves_no_file(path, monkeypatch):
    """During the work on the frames, and while the file is put together."""

    def stop(*_, **__):
        raise KeyboardInterrupt

    module = sys.modules["cg2raw.statistics.frame_statistics"]
    for place, name in ((module, "dark_rates"), (np, "savez")):
        with monkeypatch.context() as patch:
            patch.setattr(place, name, stop)
            file = path.parent / "kept.npz"
            found = diagnose(read_captures(path), statistics=file)
        assert found.interrupted
        assert not [name for name in os.listdir(path.parent) if "npz" in name]


def test_captures_without_files_have_none(path):
    found = read_captures(path)
    bare = [replace(capture, digest="") for capture in found.captures]
    with pytest.raises(ValueError, match=r"0\.npy: is of no file"):
        diagnose(replace(found, captures=bare), statistics=path.parent / "kept.npz")
