# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""--dry-run says how large a data set will be, and writes nothing."""

import os
import re

import pytest

from dataset.data_sets import files_in, rows, scene, write_image, write_spectra
from python.commands import fails, run

CASES = {
    "dng": "--sensors samsung-s20fe,nikon-d40 --illuminants 3 --digital-gain 1,0.8",
    "noise": "--sensors samsung-s20fe,nikon-d850 --illuminants A,D65 --iso clean,3200",
    "npy": "--sensors samsung-s20fe --illuminants 2 --format npy --type uint16",
    "exr": "--sensors samsung-s20fe --illuminants 1 --format exr --iso 800",
    "crops": "--sensors nikon-d850 --illuminants 1 --patches 40 --patch-size 32",
    "upi": "--sensors nikon-d850 --illuminants 2 --method upi --compression none",
}
SPECTRAL = "--illuminants FL2 --convention spectral --white-luminance 40000"


@pytest.fixture(scope="module")
def renders(tmp_path_factory):
    """Return a folder of images of two sizes, larger than what is measured."""
    folder = tmp_path_factory.mktemp("renders")
    write_image(folder / "a.exr", scene((300, 400), 1))
    write_image(folder / "b.exr", scene((500, 600), 2))
    write_image(folder / "more/c.png", scene((300, 400), 3), "uint8")
    return folder


def state(folder):
    """Return {path: (size, time)} of all that is in a folder."""
    return {
        path: (path.stat().st_size, path.stat().st_mtime_ns)
        for path in sorted(folder.rglob("*"))
    }


def said(*words):
    """Return (rows, files, bytes) that a dry run prints."""
    done = run("dataset", *words, "--dry-run")
    assert (done.code, done.err) == (0, ""), done
    count = re.search(r"^rows +(\d+): ", done.out, re.MULTILINE)[1]
    files = re.search(r"^files +(\d+): ", done.out, re.MULTILINE)[1]
    size = re.search(r"^size +about ([\d.]+) (bytes|[kMG]B)", done.out, re.MULTILINE)
    unit = {"bytes": 1, "kB": 1e3, "MB": 1e6, "GB": 1e9}[size[2]]
    assert "nothing was written" in done.out
    return int(count), int(files), float(size[1]) * unit


@pytest.mark.parametrize("name", CASES)
def test_what_it_says_is_what_is_made(renders, tmp_path, name):
    out, words = tmp_path / "out", CASES[name].split()
    before = state(tmp_path)
    count, files, size = said(renders, out, *words)
    assert state(tmp_path) == before and not out.exists()
    assert run("dataset", renders, out, *words).code == 0
    assert count == len(rows(out)) == len(files_in(out))
    visible = [p for p in out.rglob("*") if p.is_file() and ".cg2raw" not in p.parts]
    assert files == len(visible)
    found = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    # Crops of one of three images, which are alike; a DNG has 3 kB besides its pixels.
    assert size == pytest.approx(found, rel=0.15)


def test_spectra_and_layers_are_counted_by_their_own_size(tmp_path):
    write_spectra(tmp_path / "in.exr", shape=(300, 280))
    words = ["--sensors", "canon-600d", *SPECTRAL.split()]
    count, _, size = said(tmp_path / "in.exr", tmp_path / "out", *words)
    assert run("dataset", tmp_path / "in.exr", tmp_path / "out", *words).code == 0
    [row] = rows(tmp_path / "out")
    assert count == 1 and size == pytest.approx(row["bytes"], rel=0.25)
    words = ["--sensors", "nikon-d40", "--illuminants", "D65", "--layer", "none"]
    done = run("dataset", tmp_path / "in.exr", tmp_path / "out2", *words, "--dry-run")
    assert done.code == 0 and "no layer of that name" in done.err


def test_a_data_set_that_is_there_stays_as_it_is(renders, tmp_path):
    out, words = tmp_path / "out", CASES["npy"].split()
    assert run("dataset", renders, out, *words).code == 0
    before, folder = state(out), os.stat(out).st_mtime_ns
    assert said(renders, out, *words)[0] == len(rows(out))
    assert (state(out), os.stat(out).st_mtime_ns) == (before, folder)
    message = fails("dataset", renders, out, *words, "--seed", "3", "--dry-run")
    assert "was begun with --seed 0, not 3" in message
    (tmp_path / "other").mkdir()
    (tmp_path / "other/notes.txt").write_text("mine")
    message = fails("dataset", renders, tmp_path / "other", *words, "--dry-run")
    assert "holds files of no data set" in message


def test_images_that_cannot_be_used_are_named_and_not_counted(renders, tmp_path):
    write_image(tmp_path / "in/b.exr", scene((40, 60)))
    write_image(tmp_path / "in/small.exr", scene((10, 10)))
    (tmp_path / "in/a.exr").write_text("no image")
    words = "--sensors nikon-d40 --illuminants 1 --patches 2 --patch-size 32".split()
    done = run("dataset", tmp_path / "in", tmp_path / "out", *words, "--dry-run")
    assert done.code == 0 and "rows      2: 1 image, 2 files of each" in done.out
    assert "skipped: a.exr: " in done.err and "skipped: small.exr: is 10x10" in done.err
    assert "crops of b.exr" in done.out
    (tmp_path / "in/b.exr").unlink()
    done = run("dataset", tmp_path / "in", tmp_path / "out", *words, "--dry-run")
    assert done.code == 0 and "unknown: no image could be used" in done.out
    (tmp_path / "empty").mkdir()
    message = fails(
        "dataset", tmp_path / "empty", tmp_path / "out", *words, "--dry-run"
    )
    assert "holds no EXR" in message
    assert not (tmp_path / "out").exists()
