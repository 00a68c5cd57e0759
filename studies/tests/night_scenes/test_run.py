# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Runs with a worker that only pretends: resumption, failures, Ctrl-C."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studies.night_scenes.folder import Folder, Refused, Settings
from studies.night_scenes.main import main
from studies.night_scenes.run import Worker, render

FAKE = (sys.executable, str(Path(__file__).with_name("fake_worker.py")))
SMALL = Settings(32, 4)


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Return run(indices, mode, settings, workers) -> (frames rendered, lines)."""

    def run(indices, mode="good", settings=SMALL, workers=2):
        monkeypatch.setenv("FAKE_WORKER", mode)
        lines = []
        with Folder(tmp_path / "night", settings) as folder:
            done = render(folder, indices, workers, 1, lines.append, FAKE)
        return done, lines

    return run


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_frames_get_their_names_and_descriptions(run, tmp_path):
    assert run(range(5))[0] == 5
    folder = tmp_path / "night"
    assert names(folder) == sorted(
        f"night_{index:04d}.{end}" for index in range(5) for end in ("exr", "json")
    )
    described = json.loads((folder / "night_0003.json").read_text())
    assert described["width"] == 32 and described["samples"] == 4
    assert described["scene"]["index"] == 3 and described["scene"]["kind"] == "interior"


def test_what_is_done_is_kept(run, tmp_path):
    run(range(3))
    frame = tmp_path / "night" / "night_0001.exr"
    before = frame.stat().st_mtime_ns
    done, lines = run(range(5))
    assert done == 2 and lines[0] == "3 of 5 frames are there"
    assert frame.stat().st_mtime_ns == before


def test_what_is_not_complete_is_rendered_again(run, tmp_path):
    run(range(3))
    frame = tmp_path / "night" / "night_0001.exr"
    whole = frame.read_bytes()
    frame.write_bytes(whole[:-3])
    assert run(range(3))[0] == 1
    assert frame.read_bytes() == whole


def test_a_progress_line_says_what_is_left(run):
    _, lines = run([0, 1], workers=1)
    assert lines[0].startswith("[  1/2] night_0000.exr  street, alley  0 s")
    assert lines[1].endswith("0 s left")


@pytest.mark.parametrize("other", [Settings(48, 4), Settings(32, 8)])
def test_frames_of_other_settings_are_not_mixed(run, other):
    run([0])
    with pytest.raises(Refused, match="not"):
        run([0, 1], settings=other)


@pytest.mark.parametrize(
    ("mode", "message"),
    [
        ("fails 2", "night_0002.exr: Error: planted: .* MiB are left"),
        ("dies 2", "night_0002.exr: the worker ended with 7"),
        ("garbles 2", "night_0002.exr: the worker said 'Blender says hello"),
        ("short 2", "night_0002.exr: ends within its lines: .* MiB are left"),
    ],
)
def test_a_failure_is_one_line_and_leaves_whole_frames_only(
    run, tmp_path, mode, message
):
    with pytest.raises(Refused, match=message):
        run(range(4), mode, workers=1)
    assert names(tmp_path / "night") == [
        "night_0000.exr", "night_0000.json", "night_0001.exr", "night_0001.json",
    ]  # fmt: skip
    assert run(range(4))[0] == 2


def test_a_worker_that_cannot_start_says_why(run, tmp_path):
    with pytest.raises(Refused, match="night: No module named 'bpy'"):
        run(range(2), "starts not")
    assert names(tmp_path / "night") == []


def test_a_worker_that_ended_before_it_was_asked_is_heard():
    said = {"index": None, "error": "No module named 'bpy'"}
    worker = Worker(
        [sys.executable, "-c", f"print({json.dumps(json.dumps(said))})"], None
    )
    worker.process.wait()
    assert worker.ask({"index": 0}) == said
    worker.stop()


def test_a_folder_has_one_run(tmp_path):
    with Folder(tmp_path, SMALL), pytest.raises(Refused, match="another run"):
        with Folder(tmp_path, SMALL):
            pass


def test_leftovers_are_swept(run, tmp_path):
    folder = tmp_path / "night"
    folder.mkdir()
    (folder / "night_0007.exr.123.part").write_bytes(b"half")
    run([0])
    assert names(folder) == ["night_0000.exr", "night_0000.json"]


RUN = """
import sys
from studies.night_scenes import main, run
run.render.__defaults__ = ((sys.executable, sys.argv.pop(1)), None)
sys.exit(main.main(sys.argv[1:]))
"""


def start(studies, folder, mode, *arguments):
    """Start the command with the fake worker; return the process."""
    return subprocess.Popen(
        [sys.executable, "-c", RUN, FAKE[1], str(folder), "--width", "32", *arguments],
        env={**os.environ, "PYTHONPATH": str(studies), "FAKE_WORKER": mode},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_leaves_nothing_half_written(studies, tmp_path, number):
    folder = tmp_path / "night"
    process = start(studies, folder, "waits", "-n", "4")
    deadline = time.monotonic() + 60
    while len([*folder.glob("night_0000.exr"), *folder.glob("*1.exr.*")]) < 2:
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.05)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert errors.strip() == "night-scenes: ended; the same command goes on from here"
    assert names(folder) == ["night_0000.exr", "night_0000.json"]


def test_a_folder_that_cannot_be_is_one_line(studies, tmp_path):
    (tmp_path / "file").write_text("")
    process = start(studies, tmp_path / "file" / "night", "good", "-n", "1")
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 1
    assert errors.startswith("night-scenes: ") and errors.count("\n") == 1
    assert "Not a directory" in errors


def test_only_the_named_frames(studies, tmp_path):
    process = start(studies, tmp_path, "good", "--only", "9", "3", "9")
    lines, _ = process.communicate(timeout=60)
    assert names(tmp_path) == [
        "night_0003.exr", "night_0003.json", "night_0009.exr", "night_0009.json",
    ]  # fmt: skip
    assert lines.splitlines()[-1] == f"all 2 frames are in {tmp_path}"


@pytest.mark.parametrize(
    "words", [["-n", "0"], ["--width", "big"], ["--workers", "-1"]]
)
def test_a_wrong_number_is_refused(studies, tmp_path, words):
    process = start(studies, tmp_path / "night", "good", *words)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2 and "is no whole number" in errors
    assert not (tmp_path / "night").exists()


def test_the_list_needs_no_folder(capsys):
    assert main(["--list", "--first", "31", "-n", "1"]) == 0
    assert capsys.readouterr().out == "night_0031\tinterior\tgarage\n"
    with pytest.raises(SystemExit):
        main([])
    assert "FOLDER is missing" in capsys.readouterr().err
