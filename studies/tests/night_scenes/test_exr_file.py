# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A complete EXR file is told from one that lacks something."""

import shutil

import pytest

from studies.night_scenes.exr_file import complete_size

from .fake_worker import tiny_exr


@pytest.fixture
def render(repository):
    """Return a DWAA render of Blender's."""
    return repository / "tests" / "data" / "night_street.exr"


def test_a_render_of_blender_is_complete(render):
    assert complete_size(render) == (1920, 1080)


def test_a_plain_file_is_complete(tmp_path):
    path = tmp_path / "plain.exr"
    path.write_bytes(tiny_exr(16, 9))
    assert complete_size(path) == (16, 9)


@pytest.mark.parametrize("share", [0.0, 0.0001, 0.001, 0.3, 0.9, 0.99999])
def test_a_file_that_ends_early_is_not(render, tmp_path, share):
    path = tmp_path / "short.exr"
    shutil.copy(render, path)
    with open(path, "r+b") as file:
        file.truncate(int(share * path.stat().st_size))
    with pytest.raises(ValueError):
        complete_size(path)


def test_every_shorter_file_is_refused(tmp_path):
    data = tiny_exr(4, 3)
    path = tmp_path / "short.exr"
    for size in range(len(data)):
        path.write_bytes(data[:size])
        with pytest.raises(ValueError):
            complete_size(path)


def test_lines_that_were_never_written_are_missed(tmp_path):
    data = bytearray(tiny_exr(4, 3))
    table = len(data) - 3 * 16 - 3 * 8
    data[table : table + 8] = bytes(8)
    path = tmp_path / "gap.exr"
    path.write_bytes(data)
    with pytest.raises(ValueError, match="lines"):
        complete_size(path)
