# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Whatever happened to a data set's folder: it is healed, or refused in one line."""

import json
import os
import re
import resource
import subprocess
import sys
from types import SimpleNamespace

import pytest

from cg2raw.dataset import job, journal
from cg2raw.dataset.run import make_dataset
from cg2raw.dataset.target import is_of
from dataset.data_sets import (
    FILES,
    OPTIONS,
    check_agreement,
    contents,
    rows,
    scene,
    write_image,
)
from python.commands import fails, run
from tiers import slow


def resume(image, out, *options):
    """Run the same command; it must succeed. Return how many files were kept."""
    done = run("dataset", image, out, *OPTIONS, *options)
    assert (done.code, done.err) == (0, ""), done
    check_agreement(out)
    kept = re.search(r" images?, (\d+) of them", done.out)
    return int(kept.group(1)) if kept else 0


def journal_of(out):
    return next((out / ".cg2raw/journal").rglob("*.jsonl"))


def rewritten(out, change):
    """Change the entries of the journal, with checksums as cg2raw would write them."""
    path = journal_of(out)
    entries = [journal.parsed(line) for line in path.open("rb")]
    path.write_bytes(b"".join(journal.line_of(entry) for entry in change(entries)))


def test_a_damaged_file_of_the_right_size_is_made_again(image, out):
    before = contents(out)
    damaged = next(out.rglob("*.dng"))
    size = damaged.stat().st_size
    damaged.write_bytes(bytes(size))
    assert resume(image, out) == FILES - 1
    assert contents(out) == before
    damaged.write_bytes(bytes(size))
    done = run("dataset", image, out, *OPTIONS, "--verify", "size")
    assert done.code == 0 and f"{FILES} of them kept" in done.out  # as was asked


def edited_text(out, old, new):
    path = journal_of(out)
    assert old in path.read_bytes()
    path.write_bytes(path.read_bytes().replace(old, new, 1))


def test_files_of_another_image_go_before_those_of_the_new(image, out, monkeypatch):
    """A kill may come between them."""

    def killed(*_):
        raise OSError("no space left")

    monkeypatch.setattr(job, "make_variants", killed)
    write_image(image, scene(seed=2))
    assert "no space left" in fails("dataset", image, out, *OPTIONS)
    assert not list(out.rglob("*.dng"))


def test_an_edited_line_is_no_line(image, out):
    before = contents(out)
    for old, new in (
        (b'"digital_gain": 1.0', b'"digital_gain": 2.0'),
        (b'"sha256": "', b'"sha256": "0'),
        (b'"path": "', b'"path": "/'),
    ):
        edited_text(out, old, new)
        assert resume(image, out) < FILES
        assert contents(out) == before


CHANGES = {
    "iso": {"iso": 3200.0},
    "absolute path": {"path": "/etc/passwd"},
    "path upwards": {"path": "../in/a.exr"},
    "sha256": {"sha256": "0" * 64},
    "sensor": {"sensor": "nikon-d850"},
    "seed": {"seed": 8},
    "order": {"order": 7},
    "no path": {"path": None},
    "no neutral": {"neutral": None},
    "no bytes": {"bytes": None},
    "another field": {"comment": "mine"},
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_row_that_is_not_what_was_asked_for_is_made_again(image, out, name):
    """Even if its checksum is right."""
    before = contents(out)

    def change(entries):
        for field, value in CHANGES[name].items():
            if value is None:
                del entries[1][field]
            else:
                entries[1][field] = value
        return entries

    rewritten(out, change)
    assert resume(image, out) == FILES - 1
    assert contents(out) == before


STRANGE = {
    "absolute path": {"path": "/etc/passwd"},
    "no order": {"path": "x", "order": None},
    "order that is a text": {"path": "x", "order": "first"},
    "path that is a list": {"path": ["x"]},
}


@pytest.mark.parametrize("name", STRANGE)
def test_a_row_of_a_file_that_nobody_asked_for_is_left_out(image, out, name):
    before = contents(out)
    rewritten(out, lambda entries: [*entries, {**entries[1], **STRANGE[name]}])
    assert resume(image, out) == FILES
    assert contents(out) == before


def of_checksum(text):
    """Return a line that only its checksum speaks for."""
    return journal.checksum_of(text) + b" " + text + b"\n"


HEADERS = {
    "cut": lambda data: data[:20],
    "empty": lambda data: b"",
    "binary": lambda data: bytes(range(256)) * 9,
    "no header": lambda data: data.partition(b"\n")[2],
    "last line cut": lambda data: data[:-7],
    "a line twice": lambda data: data + data.splitlines(keepends=True)[-1],
    "nested": lambda data: of_checksum(b"[" * 100000),
    "no JSON": lambda data: of_checksum(b"{"),
    "a list": lambda data: of_checksum(b"[1]"),
    "image that is a number": lambda data: of_checksum(b'{"image": 5}'),
}


@pytest.mark.parametrize("name", HEADERS)
def test_a_damaged_journal_is_healed(image, out, name):
    before = contents(out)
    path = journal_of(out)
    path.write_bytes(HEADERS[name](path.read_bytes()))
    resume(image, out)
    assert contents(out) == before


def test_a_data_set_of_older_folders_is_refused_as_such(image, out):
    plan = json.loads((out / "dataset.json").read_text())
    del plan["folders"]
    (out / "dataset.json").write_text(json.dumps(plan))
    assert "called folders as image files" in fails("dataset", image, out, *OPTIONS)


@pytest.mark.parametrize("field", ["image", "sha256", "bytes", "modified"])
def test_a_header_that_lacks_a_field_is_healed(image, out, field):
    before = contents(out)

    def change(entries):
        del entries[0][field]
        return entries

    rewritten(out, change)
    resume(image, out)
    assert contents(out) == before


def test_a_journal_that_is_no_file_is_one_line(image, out):
    path = journal_of(out)
    path.unlink()
    path.mkdir()
    line = fails("dataset", image, out, *OPTIONS)
    assert path.name in line


def test_a_kill_while_the_plan_is_written_is_no_obstacle(image, tmp_path):
    out = tmp_path / "out"
    (out / ".cg2raw").mkdir(parents=True)
    (out / ".dataset.json.cg2raw-0123456789abcdef").write_text('{"cg2raw": ')
    assert resume(image, out) == 0
    assert not list(out.glob(".dataset*"))


@pytest.mark.parametrize("name", [".dataset.json.backup", "notes.txt"])
def test_other_files_stay_an_obstacle(image, tmp_path, name):
    out = tmp_path / "out"
    out.mkdir()
    (out / name).write_text("mine")
    assert "holds files of no data set" in fails("dataset", image, out, *OPTIONS)
    assert (out / name).read_text() == "mine"


LINKS = [
    ".cg2raw/lock",
    ".cg2raw/workers.log",
    ".cg2raw/manifest.jsonl",
    ".cg2raw/manifest.parquet",
]


@pytest.mark.parametrize("name", LINKS)
@pytest.mark.parametrize("kind", ["symlink", "hardlink"])
def test_nothing_is_written_through_a_link(image, tmp_path, name, kind):
    precious, out = tmp_path / "precious", tmp_path / "out"
    precious.write_text("do not lose this")
    (out / ".cg2raw").mkdir(parents=True)
    if kind == "symlink":
        (out / name).symlink_to(precious)
    else:
        (out / name).hardlink_to(precious)
    done = run("dataset", image, out, *OPTIONS)
    assert precious.read_text() == "do not lose this"
    if name.endswith("lock") and kind == "symlink":
        assert done.code == 1 and "lock: is a link" in done.err
    else:
        assert (done.code, done.err) == (0, "")
        check_agreement(out)


def test_a_folder_of_ours_that_is_a_link_is_refused(image, tmp_path):
    elsewhere, out = tmp_path / "elsewhere", tmp_path / "out"
    elsewhere.mkdir()
    out.mkdir()
    (out / ".cg2raw").symlink_to(elsewhere)
    assert ".cg2raw: is a link" in fails("dataset", image, out, *OPTIONS)
    assert list(elsewhere.iterdir()) == []


def limited(image, out, kilobytes):
    """Run the command in a process whose files may not grow beyond a size."""
    words = "--sensors nikon-d40 --illuminants 12 --workers 1".split()
    command = [sys.executable, "-m", "cg2raw", "dataset", image, out, *words]

    def limit():
        bytes_ = kilobytes * 1024
        resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_, bytes_))

    done = subprocess.run(
        command,
        preexec_fn=limit if kilobytes else None,  # noqa: PLW1509
        capture_output=True,
        text=True,
    )
    done.err_lines = done.stderr.count("\n")
    return done


@pytest.mark.parametrize("sizes", [(4, 18, 28), slow(range(4, 30, 2))])
def test_a_row_that_cannot_be_written_is_an_error(image, tmp_path, sizes):
    """`ulimit -f 18` printed "12 files", returned 0, and wrote 11 rows."""
    out = tmp_path / "out"
    codes = []
    for kilobytes in sizes:
        done = limited(image, out, kilobytes)
        codes.append(done.returncode)
        if done.returncode == 0:
            assert len(rows(out)) == 12
            check_agreement(out)
        else:
            assert done.returncode == 1 and done.err_lines == 1, done.stderr
            assert not (out / "manifest.jsonl").exists()
    assert codes[0] == 1


def test_files_without_a_row_are_an_error(tmp_path):
    """Somebody else's process cuts a journal while the data set is being made."""
    for number in range(3):
        write_image(tmp_path / f"in/{number}.exr", scene(seed=number))
    out = tmp_path / "out"
    from cg2raw import Sensor
    from cg2raw.dataset import options

    plan = options.make_plan(
        [Sensor("nikon-d40")],
        pytest.fail,
        illuminants=("A", "D65"),
        digital_gains=(1.0,),
        isos=(None,),
        exposure_time=None,
        white_luminance=None,
        noise=None,
        convention="dng",
        method="graphics2raw",
        format="dng",
        element_type="float32",
        compression="ljpeg",
        crop=None,
        patches=1,
        seed=0,
        layer=None,
        frame_from="name",
    )

    def watch(results, images, each):
        assert (images, each) == (3, 2)
        for result in results:
            if "reason" in result:
                path = journal.path_of(str(out), result["image"])
                os.truncate(path, os.path.getsize(path) - 5)
            yield result

    with pytest.raises(ValueError, match="6 files are finished, 3 are on record"):
        make_dataset([str(tmp_path / "in")], str(out), plan, watch=watch)
    assert not list(out.glob("manifest*"))
    summary = make_dataset([str(tmp_path / "in")], str(out), plan)
    assert (summary.made, summary.kept) == (3, 3)
    check_agreement(out)


def test_noise_by_the_place_among_the_images(tmp_path):
    """Renamed in the same order, images have the same noise; by name they have not."""
    options = "--sensors samsung-s20fe --illuminants A --iso 800".split()
    for folder, names in (("in", "abc"), ("renamed", "def")):
        for number, name in enumerate(names):
            write_image(tmp_path / folder / f"{name}.exr", scene(seed=number))
    found = {}
    for mode in ("name", "index", "none"):
        for folder in ("in", "renamed"):
            out = tmp_path / f"{mode}-{folder}"
            words = [tmp_path / folder, out, *options, "--frame-from", mode]
            assert run("dataset", *words).code == 0
            found[mode, folder] = rows(out)
    frames = {key: [row["frame"] for row in value] for key, value in found.items()}
    hashes = {key: [row["sha256"] for row in value] for key, value in found.items()}
    assert hashes["index", "in"] == hashes["index", "renamed"]
    assert hashes["name", "in"] != hashes["name", "renamed"]
    assert len(set(frames["index", "in"])) == len(set(frames["name", "in"])) == 3
    assert len(set(frames["none", "in"])) == 1
    plan = json.loads((tmp_path / "index-in/dataset.json").read_text())
    assert plan["frame_from"] == "index"
    # another image before the others moves them: they are made again
    write_image(tmp_path / "in/0.exr", scene(seed=9))
    again = tmp_path / "index-in"
    words = [tmp_path / "in", again, *options, "--frame-from", "index"]
    assert run("dataset", *words).code == 0
    assert len({row["frame"] for row in rows(again)}) == 4
    check_agreement(again)


@pytest.mark.parametrize(
    ("size", "modified", "same"),
    [(7, 5, True), (8, 5, False), (7, 6, False), (8, 6, False), (None, None, False)],
)
def test_a_header_is_of_a_file_of_its_size_and_time(size, modified, same):
    status = SimpleNamespace(st_size=7, st_mtime_ns=5)
    assert is_of({"bytes": size, "modified": modified}, status) is same
