# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command: what it says of what is missing, and one camera from end to end."""

import json
import os
import subprocess
from dataclasses import replace

import pytest

from studies import fingerprint
from studies import main as command
from studies.places import data_folder, luxpy_folder
from studies.protocol import FILE, PROTOCOL, read_protocol


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["denoise"], "must be one of classical, colour"),
        (["--ssf", "a.csv"], "--ssf and --sensor go together"),
        (["--quick", "--full"], "not allowed with"),
    ],
)
def test_a_wrong_command_line_is_refused(words, said, capsys):
    with pytest.raises(SystemExit) as stopped:
        command.arguments(words)
    assert stopped.value.code == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--data", "{}"], "holds no camera data"),
        (["--luxpy", "{}"], "holds no folders rfls and spds"),
    ],
)
def test_what_is_missing_is_said_in_one_line(words, said, tmp_path, capsys):
    assert command.main([word.format(tmp_path) for word in words]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and said in error


def test_without_photographs_the_other_studies_run(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "need_torch", lambda: None)
    (tmp_path / "tables").mkdir()
    monkeypatch.setenv("CG2RAW_TEST_DATA", str(tmp_path))
    assert "photographs" not in command.asked([], "quick")
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "is missing: no photograph" in error
    assert command.asked(["photographs"], "quick") == ["photographs"]


def test_no_page_is_written_of_the_small_world(camera_data, tmp_path, monkeypatch):
    monkeypatch.setattr(command, "luxpy_folder", lambda _: None)
    words = ["colour", "--full", "--docs", "--data", str(camera_data)]
    given = command.arguments([*words, "-o", str(tmp_path)])
    with pytest.raises(ValueError, match="no data files of luxpy"):
        command.run(given)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ("--renders", "holds no renders"),
        ("--judge", "holds no frames of the second judge"),
    ],
)
def test_an_empty_folder_is_said(option, said, camera_data, tmp_path, capsys):
    words = ["isp", "--data", str(camera_data), "-o", str(tmp_path / "out")]
    assert command.main([*words, option, str(tmp_path)]) == 1
    last = capsys.readouterr().err.splitlines()[-1]
    assert said in last and "./studies/run " in last
    assert not (tmp_path / "out" / "results.json").exists()


def test_an_unknown_camera_is_said(camera_data, tmp_path, capsys):
    words = ["--data", str(camera_data), "--cameras", "leica", "-o", str(tmp_path)]
    assert command.main(words) == 1
    assert "camera leica must be one of canon-600d" in capsys.readouterr().err


def test_luxpy_is_found_by_folder_variable_and_package(tmp_path, monkeypatch):
    data = tmp_path / "luxpy" / "data"
    for part in ("rfls", "spds"):
        (data / part).mkdir(parents=True)
    monkeypatch.setenv("CG2RAW_LUXPY_DATA", str(data))
    assert luxpy_folder() == data
    assert luxpy_folder(tmp_path) == data == luxpy_folder(tmp_path / "luxpy")
    # An import of luxpy would fail here.
    monkeypatch.delenv("CG2RAW_LUXPY_DATA")
    (tmp_path / "luxpy" / "__init__.py").write_text("raise ImportError")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert luxpy_folder() == data


def test_camera_data_are_found_by_variable(tmp_path, monkeypatch):
    (tmp_path / "tables").mkdir()
    monkeypatch.setenv("CG2RAW_TEST_DATA", str(tmp_path))
    assert data_folder() == tmp_path


@pytest.mark.parametrize(
    ("before", "after"),
    [("[scene]", "[stage]"), ("greys = 0.2", "gray = 0.2"), ("power = 6", "")],
)
def test_a_wrong_protocol_is_refused(before, after, tmp_path):
    text = FILE.read_text()
    assert before in text
    (tmp_path / "protocol.toml").write_text(text.replace(before, after))
    with pytest.raises(ValueError, match="protocol.toml"):
        read_protocol(tmp_path / "protocol.toml")


@pytest.fixture
def short(monkeypatch):
    """A protocol of 4 small frames, the least that have quarters, and no pictures."""
    frames = {"quick": 4, "full": 4}
    protocol = replace(
        PROTOCOL,
        scene=replace(PROTOCOL.scene, height=48, width=64),
        classical=replace(PROTOCOL.classical, frames=frames),
        colour=replace(PROTOCOL.colour, frames=frames),
    )
    monkeypatch.setattr(command, "PROTOCOL", protocol)
    monkeypatch.setattr(command, "figures_of_world", lambda *_: {})


def test_another_version_of_a_package_is_said_in_one_line(
    monkeypatch, tmp_path, capsys
):
    found = {**fingerprint.installed(), "numpy": "1.0.0"}
    monkeypatch.setattr(fingerprint, "installed", lambda: found)
    assert command.main(["colour", "-o", str(tmp_path)]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "numpy 1.0.0 is installed" in error
    assert not list(tmp_path.iterdir())


def test_a_run_that_is_stopped_says_so_and_keeps_what_was_done(
    short, camera_data, tmp_path, capsys, monkeypatch
):
    """Of two cameras the first is done when Ctrl-C comes; it is not measured again."""
    words = ["classical", "--cameras", "nikon-d40,canon-600d", "-o", str(tmp_path)]
    words += ["--data", str(camera_data)]
    measure, asked = command.classical, []

    def stopped(world, camera, frames):
        asked.append(camera.id)
        if asked == ["nikon-d40", "canon-600d"]:
            raise KeyboardInterrupt
        return measure(world, camera, frames)

    monkeypatch.setattr(command, "classical", stopped)
    assert command.main(words) == 130
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines()[-1].startswith("evidence: stopped: the same command")
    assert list(json.loads((tmp_path / "results.json").read_text())["studies"]) == [
        "classical"
    ]
    assert command.main(words) == 0
    assert asked == ["nikon-d40", "canon-600d", "canon-600d"]
    assert "| camera |" in capsys.readouterr().out


def test_committed_results_of_another_seed_are_named():
    def of(seeds):
        return {"colour": {"made by": {"seeds": seeds, "core": "a"}, "cameras": {}}}

    assert command.replaced(of("real 1"), of("real 1")) == []
    (said,) = command.replaced(of("real 2"), of("real 1"))
    assert said == "evidence.json had colour with other seeds: it is replaced"


@pytest.mark.slow  # minutes
def test_a_small_run_of_all_studies(camera_data, repository, tmp_path):
    """As users run it, in the pinned environment, which needs an index once."""
    script = repository / "scripts" / "evidence"
    words = ["--quick", "-o", tmp_path, "--data", camera_data]
    every = [script, *command.STUDIES, *map(str, words)]
    done = subprocess.run(every, capture_output=True, text=True)
    if "cannot be installed" in done.stderr and not os.environ.get("CI"):
        pytest.skip(done.stderr.strip())
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "results.json").read_text())["studies"]
    assert {name.partition(", ")[0] for name in found} == set(command.STUDIES)
    tables = (tmp_path / "tables.md").read_text()
    assert "| ours, match - upi, match |" in tables


@pytest.mark.slow
def test_one_camera_from_end_to_end(short, camera_data, tmp_path, capsys, monkeypatch):
    def run(*words):
        own = ["--data", str(camera_data), "-o", str(tmp_path), *words]
        assert command.main(own) == 0
        return capsys.readouterr()

    first = run("classical", "colour", "--cameras", "nikon-d40").out
    for title in ("Classical methods, 4 frames", "Colour, day, 4", "Colour, night, 4"):
        assert title in first
    assert (tmp_path / "tables.md").read_text() == first
    bytes_before = (tmp_path / "results.json").read_bytes()
    with monkeypatch.context() as patched:  # what is there is not measured again
        patched.setattr(command, "classical", None)
        patched.setattr(command, "colour", None)
        assert run("classical", "colour", "--cameras", "nikon-d40").out == first
    assert (tmp_path / "results.json").read_bytes() == bytes_before
    found = json.loads(bytes_before)["studies"]["colour"]["cameras"]["nikon-d40"]
    assert len(found["entry"]["day"]["ours, dng"]["degrees"]) == 4
    # A second camera joins the tables; another mode of a study starts that one afresh.
    both = run("colour", "--cameras", "sony-a7s-ii").out
    assert "| day | nikon-d40 | sony-a7s-ii |" in both
    other = run("classical", "--cameras", "nikon-d40", "--full")
    assert "earlier results differ: classical in mode: they are in" in other.err
    (kept,) = tmp_path.glob("results-*.json")
    assert set(json.loads(kept.read_text())["studies"]) == {"classical", "colour"}
    assert "Colour" in other.out


def test_a_camera_of_ones_own(short, camera_data, tmp_path, capsys):
    from studies.cameras import FILES, known_camera

    profile = tmp_path / "own.json"
    fields = json.loads(known_camera("nikon-d850", camera_data).sensor.to_json())
    profile.write_text(json.dumps(fields | {"id": "my-camera"}))
    words = ["colour", "--data", str(camera_data), "-o", str(tmp_path)]
    words += ["--ssf", str(camera_data / FILES["nikon-d850"]), "--sensor", str(profile)]
    assert command.main(words) == 0
    assert "| day | my-camera |" in capsys.readouterr().out
