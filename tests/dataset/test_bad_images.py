# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Images that cannot be used are listed with a reason; the rest is done."""

import os
import shutil
import signal
import struct
import time
import zlib

import pytest

from dataset.data_sets import (
    OPTIONS,
    check_agreement,
    contents,
    environment_where,
    files_in,
    folder_of_images,
    scene,
    start,
    workers_of,
    write_deep,
    write_image,
)
from python.commands import run


def png_of_no_size():
    """Return a PNG of 0x0 pixels."""
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", 0, 0, 8, 2, 0, 0, 0)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data))
        + name
        + data
        + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks
    )


def test_images_smaller_than_the_cfa_are_listed(tmp_path):
    write_image(tmp_path / "in/rows.exr", scene((5, 40)))
    write_image(tmp_path / "in/six.exr", scene((6, 40)))
    options = "--sensors nikon-d40,fujifilm-x-m1 --illuminants A".split()
    done = run("dataset", tmp_path / "in", tmp_path / "out", *options)
    assert done.code == 1
    assert (
        "rows.exr: 40x5 pixels: the CFA of fujifilm-x-m1 repeats after 6, and each "
        "side must have as many; leave fujifilm-x-m1 out of --sensors"
    ) in done.err
    folders = {path.parent.name for path in (tmp_path / "out").glob("*/*.dng")}
    assert folders == {"six"}


@pytest.fixture
def mixed(tmp_path, repository):
    """Return a folder of five good and eleven bad images."""
    folder = folder_of_images(tmp_path / "in")
    whole = (repository / "tests/data/interior.exr").read_bytes()
    (folder / "cut.exr").write_bytes(whole[: len(whole) // 2])
    (folder / "cut_header.exr").write_bytes(whole[:200])
    (folder / "text.exr").write_text("this is no image")
    (folder / "nothing.png").write_bytes(b"")
    (folder / "zero.png").write_bytes(png_of_no_size())
    (folder / "gone.exr").symlink_to(folder / "nowhere.exr")
    write_deep(folder / "deep.exr")
    write_image(folder / "one.exr", scene()[..., :1].copy())
    write_image(folder / "row.exr", scene((1, 30000)))
    write_image(folder / "col.exr", scene((30000, 1)))
    bins = {"R.wavelength": 6e-7, "G.wavelength": 5.5e-7}
    write_image(folder / "spectral.exr", scene(), **bins)
    return folder


REASONS = {
    "col.exr": "is 1x30000 pixels",
    "cut.exr": "missing or corrupted",
    "cut_header.exr": "header",
    "deep.exr": "flatten first (oiiotool --flatten)",
    "gone.exr": "No such file",
    "nothing.png": "Not a PNG",
    "one.exr": "needs R, G and B",
    "row.exr": "is 30000x1 pixels",
    "spectral.exr": "its channels are a spectrum",
    "text.exr": "magic",
    "zero.png": "IHDR",
}


def test_bad_images_are_listed_and_the_rest_is_done(mixed, images, tmp_path):
    done = run("dataset", mixed, tmp_path / "out", *OPTIONS)
    assert done.code == 1 and done.out.startswith("wrote")
    *lines, last = done.err.splitlines()
    assert last == "cg2raw dataset: 11 of 16 images could not be used"
    assert len(lines) == len(REASONS)
    for line, (name, reason) in zip(lines, REASONS.items(), strict=True):
        assert line.startswith(f"cg2raw dataset: {name}: ") and reason in line
    check_agreement(tmp_path / "out")
    run("dataset", images, tmp_path / "good", *OPTIONS)
    assert contents(tmp_path / "out") == contents(tmp_path / "good")  # with manifests


def test_bad_images_are_listed_again_until_mended_or_gone(mixed, tmp_path):
    run("dataset", mixed, tmp_path / "out", *OPTIONS)
    assert run("dataset", mixed, tmp_path / "out", *OPTIONS).err.count("\n") == 12
    write_image(mixed / "text.exr", scene())
    for name in REASONS.keys() - {"text.exr"}:
        (mixed / name).unlink()
    done = run("dataset", mixed, tmp_path / "out", *OPTIONS)
    assert (done.code, done.err) == (0, "")


def test_names_that_are_not_utf8_are_a_reason(tmp_path):
    write_image(tmp_path / "in/good.exr", scene())
    odd = os.fsencode(tmp_path / "in") + b"/od\xffd.exr"
    shutil.copy(tmp_path / "in/good.exr", odd)
    done = run("dataset", tmp_path / "in", tmp_path / "out", *OPTIONS)
    said = "od\udcffd.exr: is not UTF-8; rename the file or folder"
    assert done.code == 1 and said in done.err
    dry = run("dataset", tmp_path / "in", tmp_path / "dry", *OPTIONS, "--dry-run")
    assert dry.code == 0 and said in dry.err
    check_agreement(tmp_path / "out")


def test_a_folder_that_cannot_be_written_is_one_line(images, tmp_path):
    out = tmp_path / "out"
    (out / ".cg2raw").mkdir(parents=True)
    (out / ".cg2raw/journal").write_text("in the way")
    done = run("dataset", images, out, *OPTIONS)
    assert done.code == 1 and done.err.count("\n") == 1 and "journal" in done.err


def test_crops_larger_than_the_image_are_a_reason(images, tmp_path):
    write_image(tmp_path / "in/big.exr", scene((64, 64)))
    write_image(tmp_path / "in/small.exr", scene((8, 64)))
    words = "--sensors nikon-d40 --illuminants 1 --crop 32x32".split()
    done = run("dataset", tmp_path / "in", tmp_path / "out", *words)
    assert done.code == 1
    assert "small.exr: is 64x8, smaller than the crop 32x32" in done.err


def wait_for(condition, seconds=60):
    """Return what @condition returns once it is true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.002)
    raise AssertionError("nothing happened")


def test_a_worker_that_dies_costs_nothing(images, tmp_path):
    out = tmp_path / "out"
    process = start(images, out, *OPTIONS, "--workers", "1")
    wait_for(lambda: files_in(out))
    os.kill(workers_of(process)[0], signal.SIGKILL)
    assert process.wait(60) == 0, process.stderr.read()
    run("dataset", images, tmp_path / "whole", *OPTIONS)
    assert contents(out) == contents(tmp_path / "whole")


def test_an_image_that_kills_its_workers_is_given_up(tmp_path):
    write_image(tmp_path / "in/good.exr", scene())
    write_image(tmp_path / "in/deadly.exr", scene())
    env = environment_where(tmp_path, "in/deadly.exr", "os.kill(os.getpid(), 9)")
    out = tmp_path / "out"
    process = start(tmp_path / "in", out, *OPTIONS, "--workers", "1", env=env)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "deadly.exr: the process that worked on it ended twice (SIGKILL)" in errors
    (log,) = [word for word in errors.split() if word.endswith("workers.log")]
    assert os.path.isfile(log)
    assert len(files_in(out)) == 8
    check_agreement(out)


def test_a_folder_above_may_have_any_name(tmp_path, monkeypatch):
    above = tmp_path / os.fsdecode(b"h\xf6fe")
    write_image(tmp_path / "in/a.exr", scene())
    (tmp_path / "in").rename(above)
    monkeypatch.chdir(above)
    done = run("dataset", ".", "out", *OPTIONS, "--workers", "1")
    assert (done.code, done.err) == (0, "")
    assert len(files_in(above / "out")) == 8
    assert run("dataset", ".", "out", *OPTIONS).out.endswith("8 of them kept\n")


def test_input_that_is_not_there_leaves_nothing(tmp_path):
    words = "--sensors nikon-d40 --illuminants 1".split()
    done = run("dataset", tmp_path / "renders", tmp_path / "out", *words)
    assert done.code == 1 and "renders: there is no such file" in done.err
    assert list(tmp_path.iterdir()) == []
