# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A full disk, a quota, too little memory, files that may not grow: one line, and all
that was there before. What the plugin says: tests/plugin/test_failure.py."""

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from cg2raw import _core
from cg2raw.io import image_facts, image_file
from conftest import mounted
from dataset.data_sets import contents, scene, write_image
from faults.injector import Injector
from python.commands import write_dng
from tiers import slow

LIGHT = ("--sensor", "nikon-d40", "--illuminant", "D65")
NO_SPACE, QUOTA, TOO_LARGE = "No space left", "Disk quota exceeded", "File too large"
LONGEST = 2000  # letters of what is said
# Bytes of address space: enough to start, not for 48 MP with all that they take.
LITTLE = 600 << 20


def command(*words, env=None, **keywords):
    """Run cg2raw as a process; return what subprocess.run() does."""
    return subprocess.run(
        [sys.executable, "-m", "cg2raw", *map(str, words)],
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", **(env or {})},
        capture_output=True,
        text=True,
        **keywords,
    )


def said(done, name):
    """Return the one line of a command that failed."""
    assert done.returncode == 1, done
    assert done.stderr.startswith(f"cg2raw {name}: ") and len(done.stderr) < LONGEST
    assert done.stderr.count("\n") == 1, done.stderr
    return done.stderr


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """Return a folder with what the commands read."""
    folder = tmp_path_factory.mktemp("source")
    write_image(folder / "images/0.exr", scene((120, 180), 1))
    write_image(folder / "images/1.exr", scene((120, 180), 2))
    write_dng(folder / "shot.dng", shape=(64, 96))
    return folder


def words_of(name, source, out):
    """Return the words of a command, and the path that it writes."""
    plan = ("--sensors", "nikon-d40", "--illuminants", "2", "--workers", 1)
    sensors = ("--sensors", "all", "--illuminants", "A,D65")
    return {
        "convert": (source / "images/0.exr", "-o", out / "shot.dng", *LIGHT),
        "dataset": (source / "images", out / "set", *plan),
        "profile": (source / "shot.dng", "-o", out / "camera.json"),
        "ocio": (*sensors, "-o", out / "config.ocio"),
    }[name]


SIZES = {"convert": "16k", "dataset": "64k", "profile": "", "ocio": "16k"}


@pytest.mark.parametrize("name", ["convert", "dataset", "ocio"])
def test_a_full_disk_is_said_and_gone_on_from(source, tmp_path, name):
    with mounted(tmp_path / "small", "-o", f"size={SIZES[name]}") as disk:
        done = command(name, *words_of(name, source, disk))
        line = said(done, name)
        assert NO_SPACE in line and str(disk) in line
        if name != "dataset":
            assert list(disk.iterdir()) == []
            return
        remount = ["mount", "-o", "remount,size=4m", disk]
        subprocess.run(remount, check=True)
        again = command(name, *words_of(name, source, disk))
        assert again.returncode == 0, again.stderr
        whole = command(name, *words_of(name, source, tmp_path))
        assert whole.returncode == 0
        assert contents(disk / "set") == contents(tmp_path / "set")


@pytest.mark.parametrize("name", SIZES)
def test_a_quota_is_said(source, library, tmp_path, name):
    (tmp_path / "out").mkdir()
    injector = Injector(library, tmp_path / "out", tmp_path)
    faults = injector.environment("pwrite", 122, sticky=True)  # EDQUOT
    done = command(name, *words_of(name, source, tmp_path / "out"), env=faults)
    assert QUOTA in said(done, name) and injector.fired
    if name != "dataset":
        assert list((tmp_path / "out").iterdir()) == []


def small_files():
    """Let no file grow beyond 4 kB; a write fails instead of killing the process."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


@pytest.mark.parametrize("name", SIZES)
def test_files_that_may_not_grow(source, tmp_path, name):
    if name == "profile":
        pytest.skip("its file is smaller")
    words = words_of(name, source, tmp_path)
    line = said(command(name, *words, preexec_fn=small_files), name)
    assert TOO_LARGE in line and str(tmp_path) in line
    if name != "dataset":
        assert list(tmp_path.iterdir()) == []


def little_memory():
    """Let the process have little address space."""
    resource.setrlimit(resource.RLIMIT_AS, (LITTLE, LITTLE))


@pytest.mark.slow  # seconds to write it
def test_too_little_memory_for_an_image(tmp_path):
    path = tmp_path / "large.npy.exr"
    write_image(path, np.zeros((7000, 9000, 3), np.float16))
    old = tmp_path / "shot.dng"
    old.write_bytes(b"old")
    words = ("convert", path, "-o", old, *LIGHT, "--quiet")
    line = said(command(*words, preexec_fn=little_memory), "convert")
    assert str(path) in line
    assert "memory" in line or "allocate" in line
    assert old.read_bytes() == b"old"
    assert {item.name for item in tmp_path.iterdir()} == {path.name, "shot.dng"}


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_dev_full_takes_no_report(source, tmp_path, unbuffered):
    with Path("/dev/full").open("w") as full:
        words = words_of("profile", source, tmp_path)[:1]
        done = subprocess.run(
            [sys.executable, "-m", "cg2raw", "profile", *words],
            env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 1 and NO_SPACE in done.stderr
    assert "Traceback" not in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    "words", [["--help"], slow(["sensors", "--help"]), slow(["--version"])]
)
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_dev_full_takes_no_help(words, unbuffered):
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "cg2raw", *words],
            env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert (done.returncode, done.stderr) == (1, f"cg2raw: {NO_SPACE} on device\n")


def values_of_the_core(folder):
    """Return objects of each kind that has properties."""
    sensor = cg2raw.Sensor("nikon-d40")
    raw = sensor.simulate(np.full((16, 24, 3), 0.2, np.float32), illuminant="D65")
    simulation = raw.simulation
    light = sensor.profile.illuminant("D65")
    metadata = cg2raw.read_dng_metadata(str(write_dng(folder / "shot.dng")))
    facts = image_facts.facts([oiio.ImageSpec(24, 16, 3, "float")])
    options = _core.ExportOptions({}, image_file.COMMAND)
    decided = _core.resolve_picture(facts, options, image_file.COMMAND)
    return [sensor.profile, simulation, light, metadata, decided, decided.layer]


def test_no_value_of_the_core_keeps_another_alive(tmp_path):
    """pybind11 notes that in memory of its own; where there is none, it ends the
    process: as the light of a simulation did."""
    for value in values_of_the_core(tmp_path):
        kind = type(value)
        names = [n for n in dir(kind) if isinstance(getattr(kind, n), property)]
        before = sys.getrefcount(value)
        kept = [getattr(value, name) for name in names]
        assert kept and sys.getrefcount(value) == before, kind
