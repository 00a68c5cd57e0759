# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Where commands write: what each input becomes, and what is refused at once."""

import json
import re
import threading
from types import SimpleNamespace

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


def test_an_output_is_checked_before_any_work():
    for path in ("b.json", "raw/b.JSON", "a.dng"):
        ending = ".dng" if path == "a.dng" else ".json"
        assert _outputs.check_output("-o", path, ending)
    for path in (None, "-", "raw"):  # none, stdout, what writing itself refuses
        assert not _outputs.check_output("-o", path, ".json")
    for path, words in (
        ("b.txt", "-o b.txt: must end in .json"),
        ("no/b.json", "-o no/b.json: there is no folder no"),
    ):
        with pytest.raises(ValueError, match=words):
            _outputs.check_output("-o", path, ".json")


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("form", ["text", "quiet", "json"])
def test_files_that_fail_are_named_and_the_others_done(capsys, form, workers):
    def work(path, output):
        if path == "b.exr":
            raise ValueError("is black")
        if path == "c.exr":
            raise OSError(28, "No space left on device", "raw/c.dng")
        return {"input": path, "output": output}

    arguments = SimpleNamespace(quiet=form == "quiet", json=form == "json")

    def done(names, faults=()):
        pairs = [(f"{name}.exr", f"raw/{name}.dng") for name in names]
        code = _outputs.each_file(
            *("convert", pairs, work, arguments, "converting"),
            *(lambda report: f"wrote {report['output']}", faults, workers),
        )
        return code, *capsys.readouterr()

    code, out, err = done("abcd", [("e.exr", "e.exr: is missing")])
    said = ["e.exr: is missing", "b.exr: is black"]
    said += ["c.exr: raw/c.dng: No space left on device"]
    lines = [*said, "2 of 4 failed"]
    assert code == 1 and err.splitlines() == [f"cg2raw convert: {s}" for s in lines]
    if form == "json":
        found = json.loads(out)
        assert [file["output"] for file in found["files"]] == ["raw/a.dng", "raw/d.dng"]
        assert found["errors"] == [{"input": line[:5], "error": line} for line in said]
    else:
        told = ["wrote raw/a.dng", "wrote raw/d.dng"]
        assert out.splitlines() == told * (form == "text")
    assert done("a")[0] == 0 and done("b")[0] == 1
    assert "failed" not in done("b")[2]  # of one file the line itself says so
    assert done("a", [("e.exr", "e.exr: is missing")])[0] == 1


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
