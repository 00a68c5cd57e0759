# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Where commands write: what each input becomes, and what is refused at once."""

import re
import threading

import pytest

from cg2raw.cli import _outputs, match
from cg2raw.cli._shots import bracket_outputs, outputs_of_shot


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """The current folder has a file, a.dng, and a folder, raw."""
    (tmp_path / "raw").mkdir()
    (tmp_path / "a.dng").touch()
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("inputs", "output", "found"),
    [
        (["s/b.exr"], "raw", ["raw/b.dng"]),
        (["s/b.exr"], "new/", ["new/b.dng"]),
        (["s/b.exr"], "c.DNG", ["c.DNG"]),
        (["s/b.exr", "c.d.tif"], "new", ["new/b.dng", "new/c.d.dng"]),
        (
            ["b.0007.exr", "b.0008.exr"],
            "raw/c.##.dng",
            ["raw/c.07.dng", "raw/c.08.dng"],
        ),
        ([], "raw/c.#.dng", []),
    ],
)
def test_each_input_has_an_output(inputs, output, found):
    assert outputs_of_shot(inputs, output) == found


def test_without_a_name_outputs_lie_in_the_current_folder():
    assert _outputs.outputs_of(["s/b.exr"], None, ".dng") == ["b.dng"]


@pytest.mark.parametrize(
    ("inputs", "output", "words"),
    [
        (["b.exr"], "c.tif", "-o c.tif: must end in .dng, or be a folder"),
        (["b.exr"], "no/c.dng", "-o no/c.dng: there is no folder no"),
        (["b.exr"], "no/new/", "-o no/new/: there is no folder no"),
        (["b.exr", "c.exr"], "no/new", "-o no/new: there is no folder no"),
        (["b.exr", "c.exr"], "a.dng", "-o a.dng: is no folder, and several files"),
        (["a.dng"], "raw/../a.dng", "-o raw/../a.dng: is one of the files to be read"),
        (["a.dng"], ".", "-o a.dng: is one of the files to be read"),
        (["s/b.exr", "b.exr"], "raw", "b.exr: would become raw/b.dng, as s/b.exr does"),
        (["b.1.exr"], "raw/c.#.tif", "-o raw/c.#.tif: must end in .dng, or be a fol"),
        (["b.1.exr"], "no/new/c.#.dng", "-o no/new: there is no folder no"),
        (["b.exr"], "raw/c.#.dng", "-o raw/c.#.dng: b.exr has no frame number"),
        (["b.-1.exr"], "raw/c#.dng", "frame -1 would become raw/c-0001.dng, whose"),
    ],
)
def test_an_output_that_cannot_be_is_refused(inputs, output, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        outputs_of_shot(inputs, output)


@pytest.mark.parametrize(
    ("folder", "words"),
    [
        ("a.dng", "--report a.dng: is a file; name a folder"),
        ("no/page", "--report no/page: there is no folder "),
    ],
)
def test_a_report_needs_a_folder(folder, words):
    with pytest.raises(ValueError, match=words):
        _outputs.check_report(folder)
    for good in (None, "raw", "new"):
        _outputs.check_report(good)


def test_a_bracket_has_its_stops_before_the_frame_number():
    found = bracket_outputs(["raw/a.dng", "raw/b.0007.dng"], "-2,0.5")
    assert found == {
        "raw/a_ev-2.dng": ("raw/a.dng", "-2"),
        "raw/a_ev+0.5.dng": ("raw/a.dng", "0.5"),
        "raw/b_ev-2.0007.dng": ("raw/b.0007.dng", "-2"),
        "raw/b_ev+0.5.0007.dng": ("raw/b.0007.dng", "0.5"),
    }
    assert bracket_outputs(["a.dng"], None) == {"a.dng": ("a.dng", None)}


def test_folders_that_nothing_was_written_to_are_gone(tmp_path):
    with (
        pytest.raises(OSError, match="full"),
        _outputs.folders_for(["x/a.dng", "y/b.dng", "raw/c.dng", "d.dng"]),
    ):
        (tmp_path / "x" / "a.dng").touch()
        assert (tmp_path / "y").is_dir()
        raise OSError("full")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.dng", "raw", "x"]


@pytest.mark.parametrize("results", ["outputs", "match"])
def test_work_that_is_given_up_begins_no_more(results):
    """Two threads are busy when the results are no longer wanted."""
    begun, go = [], threading.Event()

    def work(number, _):
        begun.append(number)
        if number:
            go.wait(10)
        return number

    pairs = [(number, "") for number in range(20)]
    if results == "outputs":
        found = (get() for get in _outputs.results_of(pairs, work, 2))
    else:
        pool = match.ThreadPoolExecutor(2)
        found = match.results(pool, work, *zip(*pairs, strict=True))
    assert next(found) == 0
    threading.Timer(0.2, go.set).start()
    found.close()
    go.wait()
    assert set(begun) <= {0, 1, 2}
