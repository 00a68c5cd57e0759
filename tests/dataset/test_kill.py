# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Killed at any moment, the same command goes on to the same data set."""

import random
import shutil
import signal
import time

import pytest

from dataset.data_sets import (
    check_agreement,
    contents,
    environment_where,
    files_in,
    rows,
    scene,
    start,
    workers_of,
    write_image,
)

OPTIONS = (
    "--sensors samsung-s20fe,nikon-d850 --illuminants 3 --iso clean,400 "
    "--crop 96x64 --patches 2 --workers 2"
).split()
COUNT = 6  # images
PLAIN = {"dataset.json", "manifest.jsonl", "manifest.parquet"}


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    """Return a folder of images."""
    folder = tmp_path_factory.mktemp("several")
    for number in range(COUNT):
        write_image(folder / f"{number}.exr", scene((160, 240), number))
    return folder


def finish(images, out):
    """Let the command end."""
    process = start(images, out, *OPTIONS)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors


def kill_at(files, seconds, images, out):
    """Kill the command, not its workers, @seconds after it has made @files."""
    process = start(images, out, *OPTIONS)
    while len(files_in(out)) < files and process.poll() is None:
        time.sleep(0.002)
    time.sleep(seconds)
    process.kill()
    process.communicate(timeout=60)


def check_unfinished(out, whole):
    """Assert that every file that has a name is the one that it is to be."""
    found = contents(out)
    assert all(whole[path] == digest for path, digest in found.items())
    return len(found.keys() - PLAIN)


def kill_many(images, tmp_path, kills):
    """Kill at @kills random moments, then finish; return how many files each left.

    A data set that is nearly complete is finished, compared and begun anew."""
    finish(images, tmp_path / "whole")
    whole = contents(tmp_path / "whole")
    total = len(rows(tmp_path / "whole"))
    assert total == COUNT * 2 * 2 * 3 * 2
    draw = random.Random(5)
    out, counts, had = tmp_path / "out", [], 0
    for _ in range(kills):
        files = draw.randrange(had, min(had + total // 3, total))
        kill_at(files, draw.uniform(0, 0.02), images, out)
        had = check_unfinished(out, whole) if out.exists() else 0
        counts.append(had)
        if had > 0.9 * total:
            finish(images, out)
            assert contents(out) == whole
            shutil.rmtree(out)
            had = 0
    finish(images, out)
    assert contents(out) == whole
    check_agreement(out)
    return counts


def test_killed_twice(several, tmp_path):
    assert any(kill_many(several, tmp_path, 2))


@pytest.mark.slow
def test_killed_twenty_times(several, tmp_path):
    counts = kill_many(several, tmp_path, 20)
    assert len(set(counts)) > 10, counts  # at many different moments


def test_workers_die_with_the_command(tmp_path):
    for number in range(2):
        write_image(tmp_path / f"in/{number}.exr", scene())
    env = environment_where(tmp_path, ".exr", "time.sleep(600)")
    process = start(tmp_path / "in", tmp_path / "out", *OPTIONS, env=env)
    workers = []
    while len(workers) < 2:
        workers = workers_of(process)
        time.sleep(0.01)
    time.sleep(1.5)  # they have begun to wait
    process.kill()
    process.communicate(timeout=60)
    end = time.monotonic() + 10
    while any(map(is_alive, workers)):
        assert time.monotonic() < end
        time.sleep(0.01)


def is_alive(process_id):
    """Return whether a process runs; one that nobody has waited for does not."""
    try:
        with open(f"/proc/{process_id}/stat") as stream:
            return stream.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_interrupted_it_says_how_to_go_on(several, tmp_path):
    out = tmp_path / "out"
    process = start(several, out, *OPTIONS)
    while not files_in(out):
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=60)
    assert (process.returncode, output) == (130, "")
    assert errors == "cg2raw dataset: stopped; run the same command again to resume\n"
    assert not (out / "manifest.jsonl").exists()
    finish(several, out)
    check_agreement(out)
