# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Names of 255 bytes or with a newline; pipes, devices, sockets and links to nothing
among the files that are read."""

import os
import socket
import threading

import numpy as np
import pytest

from conftest import oiiotool_runner
from dataset.data_sets import files_in, rows, scene, write_image
from images import attributes, read_dn
from python.commands import fails, run, write_dng
from tiers import WHEEL_FAST

LIGHT = ("--sensor", "nikon-d40", "--illuminant", "D65")
LONGEST = 2000  # letters of what is said
SHAPE = (24, 36)
LONG, LINES, BLANK = "n" * 251, "two\nlines", " $(x);'\"\\ "


def name_of(stem, ending):
    """Return a name with an ending, of 255 bytes at most."""
    return stem[: 255 - len(ending)] + ending


@pytest.mark.parametrize("stem", [LONG, LINES, BLANK], ids=["long", "newline", "shell"])
def test_names_of_inputs_and_outputs(tmp_path, stem):
    exr = write_image(tmp_path / name_of(stem, ".exr"), scene(SHAPE))
    dng = tmp_path / name_of(stem, ".dng")
    assert run("convert", exr, "-o", dng, *LIGHT).code == 0
    assert read_dn(dng).shape == SHAPE
    json = tmp_path / name_of(stem, ".json")
    assert run("profile", dng, "-o", json).code == 0
    ocio = tmp_path / name_of(stem, ".ocio")
    pair = ("--sensors", "nikon-d40", "--illuminants", "D65")
    assert run("ocio", *pair, "-o", ocio).code == 0
    assert len(list(tmp_path.iterdir())) == 4


@pytest.mark.parametrize("name", WHEEL_FAST)
def test_names_of_the_plugin(tmp_path, name):
    exr = write_image(tmp_path / "in.exr", scene(SHAPE))
    words = (exr, *attributes(sensor="nikon-d40", illuminant="D65"), "-o")
    oiiotool = oiiotool_runner(name)
    for number, stem in enumerate((LONG[:200], LINES, BLANK)):
        folder = tmp_path / f"{number}"
        folder.mkdir()
        oiiotool(*words, folder / name_of(stem, ".dng"))
        assert [path.name for path in folder.iterdir()] == [name_of(stem, ".dng")]


def test_names_of_images_of_a_data_set(tmp_path):
    for stem in (LONG, LINES, BLANK):
        write_image(tmp_path / "in" / name_of(stem, ".exr"), scene(SHAPE))
    write_image(tmp_path / "in/plain.exr", scene(SHAPE))
    plan = ("--sensors", "nikon-d40", "--illuminants", "1", "--workers", 1)
    done = run("dataset", tmp_path / "in", tmp_path / "out", *plan)
    assert done.code == 0, done.err
    assert len(files_in(tmp_path / "out")) == len(rows(tmp_path / "out")) == 4
    assert run("dataset", tmp_path / "in", tmp_path / "out", *plan).code == 0


@pytest.mark.parametrize("name", [LONG + "x" * 9 + ".dng", "two\nlines.txt"])
def test_a_name_that_is_refused_is_said_in_one_line(tmp_path, name):
    exr = write_image(tmp_path / "in.exr", scene(SHAPE))
    line = fails("convert", exr, "-o", tmp_path / name, *LIGHT)
    assert len(line) < LONGEST


def test_a_pipe_is_no_output_of_a_dng(tmp_path):
    exr = write_image(tmp_path / "in.exr", scene(SHAPE))
    pipe = tmp_path / "pipe.dng"
    os.mkfifo(pipe)
    line = fails("convert", exr, "-o", pipe, *LIGHT)
    assert line.endswith(f"{pipe}: is not a regular file: choose another name")
    assert pipe.is_fifo()


def test_a_pipe_takes_a_text(tmp_path):
    """As /dev/stdout does, and what is a pipe stays one."""
    pipe, heard = tmp_path / "pipe.json", []
    dng = write_dng(tmp_path / "shot.dng")
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: heard.append(pipe.read_text()))
    reader.start()
    assert run("profile", dng, "-o", pipe).code == 0
    reader.join(10)
    assert heard[0].startswith("{") and pipe.is_fifo()


@pytest.mark.parametrize("name", ["convert", "profile", "render"])
def test_a_pipe_is_no_input(tmp_path, name):
    """It is said at once, and not waited for who writes to it."""
    ending = {"profile": ".dng", "render": ".npy"}.get(name, ".exr")
    pipe = tmp_path / f"in/pipe{ending}"
    pipe.parent.mkdir()
    os.mkfifo(pipe)
    words = {
        "convert": (pipe, "-o", tmp_path / "a.dng", *LIGHT),
        "profile": (pipe, "-o", tmp_path / "a.json"),
        "render": (pipe, "-o", tmp_path / "a.png"),
    }[name]
    done = run(name, *words)
    assert done.code == 1
    assert str(pipe) in done.err
    assert "regular file" in done.err or "is no file" in done.err
    assert not list(tmp_path.glob("a.*"))


# What is no file, and what is said of it.
ODD = {
    "pipe": "is no regular file",
    "full": "is no regular file",
    "zero": "is no regular file",
    "socket": "",  # some say that it is no file, some what the system says
    "nothing": "",
    "circle": "",
}


def make_odd(kind, path):
    """Put what is no file at a path; return it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as ours:
            ours.bind(os.path.relpath(path))  # a long path would be refused
    else:
        target = {"nothing": "nowhere", "circle": path.name}.get(kind, f"/dev/{kind}")
        path.symlink_to(target)
    return path


def make_all_odd(folder, name):
    """Put what is no file at paths of a name with {} in it; return [(kind, path)]."""
    return [(kind, make_odd(kind, folder / name.format(kind))) for kind in ODD]


@pytest.mark.parametrize("given", ["folder", "files"])
def test_a_data_set_goes_on_without_what_is_no_image(tmp_path, given):
    write_image(tmp_path / "in/an.exr", scene(SHAPE))
    odd = make_all_odd(tmp_path / "in", "no-{}.exr")
    if given == "files":
        odd = [(kind, path) for kind, path in odd if path.exists()]
    images = [path for _, path in odd] + [tmp_path / "in/an.exr"]
    images = [tmp_path / "in"] if given == "folder" else images
    plan = ("--sensors", "nikon-d40", "--illuminants", "1", "--workers", 1)
    done = run("dataset", *images, tmp_path / "out", *plan)
    assert done.code == 1
    *lines, last = done.err.splitlines()
    for kind, path in odd:
        (line,) = (one for one in lines if path.name in one)
        assert line.startswith(f"cg2raw dataset: {path.name}: ") and ODD[kind] in line
    count = len(odd)
    assert last == f"cg2raw dataset: {count} of {count + 1} images could not be used"
    assert len(lines) == count
    assert [row["input"] for row in rows(tmp_path / "out")] == ["an.exr"]


@pytest.mark.parametrize("kind", ["pipe", "zero", "socket", "nothing"])
def test_a_shot_goes_on_without_what_is_no_image(tmp_path, kind):
    for number in (1, 3):
        write_image(tmp_path / f"in/shot.{number}.exr", scene(SHAPE))
    odd = make_odd(kind, tmp_path / "in/shot.2.exr")
    words = (odd.with_name("shot.#.exr"), "-o", tmp_path / "out", *LIGHT)
    line = fails("convert", *words, "--framerate", 24, "--quiet")
    assert line.startswith(f"cg2raw convert: {odd}: ") and ODD[kind] in line
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["shot.1.dng", "shot.3.dng"]


@pytest.mark.parametrize("ending", [".npy", ".npz", ".fits", ".dng", ".arw"])
@pytest.mark.parametrize("kind", ODD)
def test_no_calibration_passes_over_what_is_no_frame(tmp_path, kind, ending):
    """In a folder, too: that a dark is missing is told."""
    if ending == ".fits":
        pytest.importorskip("astropy")
    np.save(tmp_path / "a.npy", np.full(SHAPE, 100, np.uint16))
    odd = make_odd(kind, tmp_path / f"darks/b{ending}")
    for given in (odd, odd.parent):
        words = (tmp_path / "a.npy", given, "-s", "nikon-d40", "--exposure", 0)
        line = fails("calibrate", *words)
        assert str(odd) in line and (ending == ".dng" or ODD[kind] in line)


@pytest.mark.parametrize("field", ["file", "scene"])
@pytest.mark.parametrize("kind", ODD)
def test_captures_have_files_alone(tmp_path, kind, field):
    np.save(tmp_path / "a.npy", np.full(SHAPE, 100, np.uint16))
    odd = make_odd(kind, tmp_path / "odd.npy")
    files = {"file": "a.npy", "scene": "a.npy", field: odd.name}
    pairs = ", ".join(f"{name}: {value}" for name, value in files.items())
    captures = tmp_path / "captures.yaml"
    captures.write_text(f"sensor: nikon-d40\nframes:\n  - {{kind: scene, {pairs}}}\n")
    line = fails("diagnose", "check", captures)
    assert f'captures.yaml:3: frames[0].{field} is "odd.npy"' in line
    assert "no regular file" in line or "there is no file" in line


@pytest.mark.parametrize("kind", [*ODD, "folder"])
def test_what_is_no_profile_is_no_sensor(tmp_path, monkeypatch, kind):
    """The others that are installed are listed, and the path is told."""
    path = tmp_path / "profiles/odd.json"
    path.mkdir(parents=True) if kind == "folder" else make_odd(kind, path)
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(path.parent))
    done = run("sensors")
    assert done.code == 0 and "nikon-d40" in done.out and "odd" not in done.out
    assert 'unknown sensor "odd"; installed: ' in fails("sensors", "odd")
    line = fails("sensors", path)
    assert line.startswith(f"cg2raw sensors: {path}: ") and ODD.get(kind, "") in line
