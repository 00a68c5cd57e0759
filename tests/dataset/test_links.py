# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A stranger's data set: what its links and pipes lead to stays as it is."""

import hashlib
import os

import pytest

from cg2raw.dataset import job
from cg2raw.dataset.target import Job
from dataset.data_sets import (
    FILES,
    OPTIONS,
    check_agreement,
    contents,
    scene,
    write_image,
)
from python.commands import fails, run

GROUP = hashlib.blake2b(b"a.exr", digest_size=16).hexdigest()[:2]  # journal.path_of
FOLDERS = [".cg2raw", ".cg2raw/parts", ".cg2raw/journal", f".cg2raw/journal/{GROUP}"]


def journal_of(out):
    return next((out / ".cg2raw/journal").rglob("*.jsonl"))


@pytest.mark.parametrize("name", [*FOLDERS, "a"])
def test_nothing_is_written_into_a_linked_folder(image, tmp_path, name):
    elsewhere, out = tmp_path / "elsewhere", tmp_path / "out"
    elsewhere.mkdir()
    (out / name).parent.mkdir(parents=True, exist_ok=True)
    (out / ".cg2raw").mkdir(exist_ok=True) if name != ".cg2raw" else None
    (out / name).symlink_to(elsewhere)
    if name == "a":  # else the folder is of no data set
        start_of_a_data_set(image, out)
    line = fails("dataset", image, out, *OPTIONS)
    assert f"{out / name}: is a link, which is not ours; remove it" in line
    assert list(elsewhere.iterdir()) == []


def start_of_a_data_set(image, out):
    """Add a dataset.json to a folder."""
    plain = out.parent / "plain"
    assert run("dataset", image, plain, *OPTIONS).code == 0
    (out / "dataset.json").write_bytes((plain / "dataset.json").read_bytes())


def test_a_folder_of_a_folder_of_images_is_no_link_either(tmp_path):
    write_image(tmp_path / "in/sub/a.exr", scene())
    elsewhere, out = tmp_path / "elsewhere", tmp_path / "out"
    elsewhere.mkdir()
    out.mkdir()
    start_of_a_data_set(tmp_path / "in", out)
    (out / "sub").symlink_to(elsewhere)
    assert "sub: is a link" in fails("dataset", tmp_path / "in", out, *OPTIONS)
    assert list(elsewhere.iterdir()) == []


@pytest.mark.parametrize("changed", [False, True])
def test_files_behind_a_link_are_neither_kept_nor_removed(image, out, changed):
    """A resumed run takes a link for no file of its own, also if the bytes agree."""
    elsewhere = out.parent / "elsewhere"
    (out / "a").rename(elsewhere)
    (out / "a").symlink_to(elsewhere)
    before = contents(elsewhere)
    if changed:
        write_image(image, scene() * 0.5)
    assert "a: is a link" in fails("dataset", image, out, *OPTIONS)
    assert contents(elsewhere) == before and before


def test_a_link_in_the_place_of_a_file_is_replaced(image, out):
    before = contents(out)
    path = next((out / "a").iterdir())
    path.rename(out.parent / "elsewhere")
    path.symlink_to(out.parent / "elsewhere")
    assert run("dataset", image, out, *OPTIONS).code == 0
    check_agreement(out)
    assert contents(out) == before and not path.is_symlink()


@pytest.mark.parametrize("kind", ["dng", "npy", "exr"])
def test_parts_that_become_a_link_gain_nothing(image, tmp_path, monkeypatch, kind):
    """A stranger swaps the folder while a file is being made."""
    out, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    elsewhere.mkdir()
    assert run("dataset", image, out, *OPTIONS, "--format", kind).code == 0
    before = contents(out)
    for path in (out / "a").iterdir():
        path.unlink()
    (out / ".cg2raw/parts").mkdir()
    simulated = job.simulated

    def with_swap(*arguments):
        write, row = simulated(*arguments)

        def swapped(path):
            (out / ".cg2raw/parts").rename(out / ".cg2raw/moved")
            (out / ".cg2raw/parts").symlink_to(elsewhere)
            write(path)
            (out / ".cg2raw/parts").unlink()
            (out / ".cg2raw/moved").rename(out / ".cg2raw/parts")

        return swapped, row

    monkeypatch.setattr(job, "simulated", with_swap)
    plan = hashlib.sha256((out / "dataset.json").read_bytes()).hexdigest()
    made = job.make(Job(str(out), plan, "a.exr", str(image), 0))
    assert made == {"image": "a.exr", "made": FILES, "kept": 0, "reason": None}
    assert list(elsewhere.iterdir()) == []
    os.rmdir(out / ".cg2raw/parts")  # nothing is left in it
    assert contents(out) == before


@pytest.mark.parametrize("kind", ["link", "pipe"])
@pytest.mark.parametrize("name", ["dataset.json", "journal"])
def test_a_record_that_is_a_link_or_a_pipe_is_refused(image, out, name, kind):
    """A pipe that nobody writes to would have been waited for."""
    path = journal_of(out) if name == "journal" else out / name
    precious = out.parent / "precious"
    path.rename(precious)
    before = precious.read_bytes()
    if kind == "link":
        path.symlink_to(precious)
    else:
        os.mkfifo(path)
    line = fails("dataset", image, out, *OPTIONS)
    words = "is a link, which is not ours" if kind == "link" else "is no regular file"
    assert f"{path}: {words}; remove it" in line
    assert precious.read_bytes() == before


def test_the_folder_that_was_named_may_be_a_link(image, tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "out").symlink_to(tmp_path / "real")
    assert run("dataset", image, tmp_path / "out", *OPTIONS).code == 0
    check_agreement(tmp_path / "real")
