# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Names of 255 bytes or with a newline, and pipes where files are expected."""

import os
import threading

import pytest

from conftest import oiiotool_runner
from dataset.data_sets import files_in, rows, scene, write_image
from images import attributes, read_dn
from python.commands import fails, run, write_dng

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


@pytest.mark.parametrize("name", ["oiio-system", "oiio-wheel"])
def test_names_of_the_plugin(tmp_path, name):
    exr = write_image(tmp_path / "in.exr", scene(SHAPE))
    words = (exr, *attributes(sensor="nikon-d40", illuminant="D65"), "-o")
    oiiotool = oiiotool_runner(name)
    for number, stem in enumerate((LONG[:200], LINES, BLANK)):
        folder = tmp_path / f"{number}"
        folder.mkdir()
        oiiotool(*words, folder / name_of(stem, ".dng"))
        assert [path.name for path in folder.iterdir()] == [name_of(stem, ".dng")]


@pytest.mark.parametrize("stem", [LONG, LINES, BLANK], ids=["long", "newline", "shell"])
def test_names_of_images_of_a_data_set(tmp_path, stem):
    write_image(tmp_path / "in" / name_of(stem, ".exr"), scene(SHAPE))
    write_image(tmp_path / "in/plain.exr", scene(SHAPE))
    plan = ("--sensors", "nikon-d40", "--illuminants", "1", "--workers", 1)
    done = run("dataset", tmp_path / "in", tmp_path / "out", *plan)
    assert done.code == 0, done.err
    assert len(files_in(tmp_path / "out")) == len(rows(tmp_path / "out")) == 2
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
