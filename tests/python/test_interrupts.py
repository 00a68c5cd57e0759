# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Ctrl-C and SIGTERM at any moment of a command: one line, the exit code of shells."""

import contextlib
import hashlib
import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from calibration.planted import frames_of, sensor_of
from cg2raw import interrupts
from dataset.data_sets import OPTIONS, folder_of_images
from diagnose import capture_files
from python.commands import write_dng
from tiers import first_fast

SAID = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
STOPPED = "stopped; run the same command again to resume"
NAMES = ("convert", "dataset", "profile", "sensors", "doctor", "ocio")
LONGER = ("render", "calibrate", "diagnose")  # of the slow test alone
LONGEST = 120  # s
# Of a data set: what says that it is begun, and how far it is.
OWN = {"dataset.json", "manifest.jsonl", "manifest.parquet", ".cg2raw"}


@dataclass
class Ended:
    """How a process ended."""

    code: int
    out: str
    err: str
    seconds: float  # that it had answered signals


def command(name, source, out):
    """Return the words of a command that reads @source and writes below @out."""
    pair = ("--sensors", "nikon-d40", "--illuminants", "D65")
    images = [source / f"images/{number}.exr" for number in (0, 2)]
    words = {
        "convert": (*images, "-o", out, "--workers", 2)
        + ("--sensor", "nikon-d40", "--illuminant", "D65"),
        "dataset": (source / "images", out, *OPTIONS, "--workers", 2),
        "profile": (source / "shot.dng", "-o", out / "camera.json"),
        "sensors": ("nikon-d40", "--plot", out / "camera.png"),
        "doctor": (),
        "ocio": (*pair, "-o", out / "config.ocio"),
        "render": (source / "shot.dng", "-o", out / "shot.png"),
        "calibrate": (source / "frames.npz", "--frames", source / "frames.csv")
        + ("--sensor", source / "my.json", "--iso", 100)
        + ("-o", out / "camera.json", "--report", out / "report"),
        "diagnose": ("check", source / "captures/captures.yaml"),
    }[name]
    return [sys.executable, "-m", "cg2raw", name, *map(str, words)]


def answers(process):
    """Return whether a process catches SIGTERM, as no Python does by itself."""
    with open(f"/proc/{process.pid}/status") as status:
        caught = next(line for line in status if line.startswith("SigCgt:"))
    return int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1


def ended(words, scratch, number=None, seconds=0.0):
    """Run a command; send it a signal @seconds after it has begun to answer any."""
    scratch.mkdir(parents=True, exist_ok=True)
    process = subprocess.Popen(
        words,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(scratch)},
    )
    while not answers(process) and process.poll() is None:
        time.sleep(0.0005)
    begun = time.monotonic()
    if number is not None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(seconds)
        process.send_signal(number)
    out, err = process.communicate(timeout=LONGEST)
    assert list(scratch.iterdir()) == [], words
    return Ended(process.returncode, out, err, time.monotonic() - begun)


def files_below(folder):
    """Return {path in a folder: hash} of its files, without a data set's own."""
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).digest()
        for path in Path(folder).rglob("*")
        if path.is_file() and path.relative_to(folder).parts[0] not in OWN
    }


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """Return a folder with images, and a DNG, for the commands to read."""
    folder = tmp_path_factory.mktemp("source")
    folder_of_images(folder / "images")
    write_dng(folder / "shot.dng", shape=(64, 96))
    sensor = sensor_of(shape=(48, 64))
    (folder / "my.json").write_text(sensor.to_json())
    frames = frames_of(sensor, biases=3, darks=3, flats=3)
    np.savez(folder / "frames.npz", **{frame.name: frame.pixels() for frame in frames})
    lines = [f"{frame.name},{frame.exposure_time},20.0" for frame in frames]
    table = "\n".join(["frame,exposure_s,temperature_c", *lines])
    (folder / "frames.csv").write_text(table)
    (folder / "captures").mkdir()
    capture_files.standard_set(folder / "captures")
    return folder


def check_moments(name, source, tmp_path, moments):
    """Send signals at @moments of a command; return how many ended it."""
    whole = tmp_path / "whole"
    whole.mkdir()
    calm = ended(command(name, source, whole), tmp_path / "scratch")
    assert calm.code in (0, 1) and (calm.code == 0 or name == "doctor"), calm
    complete, count = files_below(whole), 0
    for moment in range(moments):
        number = signal.SIGTERM if moment % 4 == 3 else signal.SIGINT
        out = tmp_path / f"out-{moment}"
        out.mkdir()
        seconds = calm.seconds * (moment + 0.5) / moments
        done = ended(command(name, source, out), tmp_path / "scratch", number, seconds)
        left = files_below(out)
        assert left.items() <= complete.items(), (seconds, left.keys())
        assert not list(out.glob(".cg2raw/parts")), seconds
        if done.code == calm.code:
            assert done.err == calm.err, seconds
            continue
        assert done.code == 128 + number, (seconds, done)
        said = [SAID[number], *([STOPPED] if name == "dataset" else [])]
        assert done.err in [f"cg2raw {name}: {words}\n" for words in said], seconds
        assert calm.out.startswith(done.out) or name == "convert", done
        count += 1
    return count


@pytest.mark.parametrize("name", first_fast(NAMES, 1))
def test_seven_moments_of_a_command(source, tmp_path, name):
    assert check_moments(name, source, tmp_path, 7) > 2


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES + LONGER)
def test_fifty_moments_of_a_command(source, tmp_path, name):
    assert check_moments(name, source, tmp_path, 50) > 10


def test_signals_are_answered_before_anything_is_loaded():
    """And a program that imports the package answers its own."""
    program = (
        "import signal, sys\n"
        "before = [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)]\n"
        "import cg2raw.__main__, cg2raw.interrupts\n"
        "ours = [name for name in sys.modules if name.startswith('cg2raw')]\n"
        "assert 'numpy' not in sys.modules and len(ours) == 3, ours\n"
        "from cg2raw import Sensor, cli\n"
        "after = [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)]\n"
        "assert before == after"
    )
    done = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr.decode()


def in_a_command(program):
    """Run Python as the command would be run; return how it ended."""
    start = (
        "import os, signal, sys, time\n"
        "from cg2raw import interrupts\n"
        "from cg2raw.interrupts import held, raised, scratch_folder, tidied\n"
        "interrupts.answer_signals()\n"
        "def ask(number=signal.SIGINT): os.kill(os.getpid(), number)\n"
    )
    return subprocess.run(
        [sys.executable, "-c", start + program], capture_output=True, text=True
    )


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_is_held_is_finished_first(number):
    done = in_a_command(
        f"with held():\n with held(): ask({int(number)})\n"
        " assert interrupts.is_asked_to_end(); os.write(1, b'whole')\n"
        "os.write(1, b'more')"
    )
    assert (done.returncode, done.stdout) == (128 + number, "whole")
    assert done.stderr == f"cg2raw: {SAID[number]}\n"


def test_what_must_not_stay_is_removed_and_the_sentence_said(tmp_path):
    (tmp_path / "part").write_text("half")
    done = in_a_command(
        f"with tidied(lambda: os.unlink({str(tmp_path / 'part')!r}), 'go on'):\n"
        " with tidied(lambda: os.unlink('/nowhere')): ask()"
    )
    assert (done.returncode, done.stderr) == (130, "cg2raw: go on\n")
    assert list(tmp_path.iterdir()) == []


def test_a_scratch_folder_goes_either_way(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    use = "with scratch_folder('x.') as folder: assert os.path.isdir(folder)"
    assert in_a_command(use).returncode == 0 and not list(tmp_path.iterdir())
    assert in_a_command(use + "; ask()").returncode == 130
    assert not list(tmp_path.iterdir())


def test_ctrl_c_is_raised_where_its_result_is_used():
    done = in_a_command(
        "try:\n with raised(): ask(); time.sleep(9)\n"
        "except KeyboardInterrupt: os.write(1, b'partial')\n"
        "ask()"
    )
    assert (done.returncode, done.stdout) == (130, "partial")
    assert done.stderr == "cg2raw: interrupted\n"


def test_the_line_is_said_while_libraw_is_not_to_say_any():
    done = in_a_command(
        "from cg2raw.io.libraw import no_words_of_libraries\n"
        "with no_words_of_libraries(): os.write(2, b'noise'); ask()"
    )
    assert (done.returncode, done.stderr) == (130, "cg2raw: interrupted\n")


def test_it_is_not_raised_through_an_import(tmp_path):
    (tmp_path / "slow_module.py").write_text("ask()\n")
    done = in_a_command(
        f"sys.path.insert(0, {str(tmp_path)!r}); import builtins; builtins.ask = ask\n"
        "with raised(): import slow_module"
    )
    assert (done.returncode, done.stderr) == (130, "cg2raw: interrupted\n")


def test_a_fork_says_nothing():
    done = in_a_command(
        "if not os.fork(): ask(); os.write(1, b'lives')\n"
        "else: os.write(1, str(os.waitstatus_to_exitcode(os.wait()[1])).encode())"
    )
    assert (done.stdout, done.stderr) == ("130", "")


def test_a_signal_that_is_ignored_stays_so():
    program = (
        "import os, signal; from cg2raw.interrupts import answer_signals\n"
        "answer_signals(); os.kill(os.getpid(), signal.SIGINT); print('lives')"
    )
    ignoring = ["sh", "-c", 'trap "" INT; exec "$@"', "sh", sys.executable, "-c"]
    done = subprocess.run([*ignoring, program], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "lives\n", "")


def test_nothing_ends_a_command_whose_work_is_done():
    done = in_a_command("interrupts.ignore_signals(); ask(); ask(15); print('done')")
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_a_program_that_imports_it_is_not_ended():
    with pytest.raises(KeyboardInterrupt), interrupts.held():
        signal.raise_signal(signal.SIGINT)
    assert not interrupts.is_asked_to_end()
