# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""On a terminal a bar counts the files and says how long the rest will take."""

import contextlib
import io
import re

from cg2raw.cli import dataset, main, make_parser
from cg2raw.dataset.run import make_dataset
from dataset.data_sets import FILES, OPTIONS, scene, write_image
from python.commands import run

# Eight files of an image, by one worker.
FEW = [*OPTIONS, "--format", "npy", "--workers", "1"]


class Terminal(io.StringIO):
    """What is written to a terminal."""

    def isatty(self):
        return True


def shown(monkeypatch, *words):
    """Run a command whose stderr is a terminal; return the text that stands there,
    without what moves the cursor and colours."""
    for name in ("NO_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    with contextlib.redirect_stderr(Terminal()) as stderr:
        assert main([str(word) for word in words]) == 0
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", stderr.getvalue())


def test_the_bar_counts_files_and_tells_the_time_left(images, tmp_path, monkeypatch):
    text = shown(monkeypatch, "dataset", images, tmp_path / "out", *FEW)
    total = 5 * FILES
    assert re.search(rf"making .* {total}/{total} files, \d:\d\d:\d\d left", text)
    assert re.search(rf" 0/{total} files, (-:--:--|\d:\d\d:\d\d) left", text)


def test_quiet_or_without_a_terminal_there_is_none(images, tmp_path, monkeypatch):
    words = ["dataset", images, tmp_path / "out", *FEW]
    assert shown(monkeypatch, *words, "--quiet") == ""
    assert run(*words).err == ""


def test_it_moves_with_each_file_and_ends_with_all_of_them(tmp_path, monkeypatch):
    """Also if an image cannot be used, or its files are there already."""
    write_image(tmp_path / "in/a.exr", scene())
    write_image(tmp_path / "in/b.exr", scene())
    (tmp_path / "in/c.exr").write_text("no image")
    seen = []

    class Bar:
        def __enter__(self):
            return seen.append

        def __exit__(self, *error):
            pass

    def counted(words, unit, total):
        seen.append((unit, total))
        return Bar()

    monkeypatch.setattr(dataset, "counted", counted)
    words = ["dataset", tmp_path / "in", tmp_path / "out", *FEW]
    assert run(*words).code == 1
    first, *counts = seen
    assert first == ("files", 3 * FILES)
    assert counts == sorted(counts) and counts[-1] == 3 * FILES
    assert set(counts) >= set(range(2 * FILES + 1))  # each file of those that are made
    seen.clear()
    next((tmp_path / "out/a").iterdir()).unlink()
    assert run(*words).code == 1
    assert set(seen[1:]) == {FILES - 1, FILES, 2 * FILES, 3 * FILES}


def test_the_number_of_files_is_that_of_the_plan(images, tmp_path):
    """Of sensors with noise at some ISOs alone, lights by word, gains and patches."""
    words = (
        "--sensors all --illuminants A,D65,sample:3 --digital-gain 1,0.5 --format npy "
    )
    words += "--iso clean,100,3200 --patches 2 --patch-size 8 --workers 1 --quiet"
    counts = []

    def watch(results, images, each):
        counts.append((images, each))
        return results

    given = [str(images / "0.exr"), str(tmp_path / "out"), *words.split()]
    plan = dataset.plan_of(make_parser().parse_args(["dataset", *given]))
    summary = make_dataset([given[0]], given[1], plan, watch=watch)
    assert counts == [(1, summary.made)]
    assert plan.files_of_an_image == len(list(plan.variants("x", 0)))
