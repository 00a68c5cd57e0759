# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""DWA-compressed EXRs: the first row of a process is decoded alone."""

import contextlib
import threading

import numpy as np
import OpenImageIO as oiio
import pytest

from cg2raw.io import dwa, image_file


@pytest.fixture
def reads(monkeypatch):
    """What is read by a process that has read no DWA file yet: (rows, columns)."""
    found = []

    class Recorded:
        def __init__(self, source):
            self.source = source

        def __getattr__(self, name):
            return getattr(self.source, name)

        def read_scanlines(self, first, last, *others):
            found.append((last - first, None))
            return self.source.read_scanlines(first, last, *others)

        def read_tiles(self, left, right, top, below, *others):
            found.append((below - top, right - left))
            return self.source.read_tiles(left, right, top, below, *others)

    opened = image_file.opened

    @contextlib.contextmanager
    def recorded(path):
        with opened(path) as source:
            yield Recorded(source)

    monkeypatch.setattr(image_file, "opened", recorded)
    monkeypatch.setattr(dwa, "_chosen", threading.Event())
    return found


def exr(path, compression, tiles=(0, 0)):
    spec = oiio.ImageSpec(100, 90, 3, "half")
    spec.tile_height, spec.tile_width = tiles
    spec.attribute("compression", compression)
    pixels = np.random.default_rng(3).random((90, 100, 3), np.float32)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec) and file.write_image(pixels) and file.close()
    return path


@pytest.mark.parametrize("compression", ["dwaa", "dwab"])
def test_a_row_comes_first_and_once(tmp_path, reads, compression):
    path = exr(tmp_path / "a.exr", compression)
    first, again = (image_file.read_image(path).pixels for _ in range(2))
    assert reads == [(1, None), (90, None), (90, None)]
    assert np.array_equal(first, again)


def test_of_tiles_one_comes_first(tmp_path, reads):
    path = exr(tmp_path / "a.exr", "dwaa", (32, 48))
    first, again = (image_file.read_image(path).pixels for _ in range(2))
    assert reads[:2] == [(32, 48), (32, 100)] and reads.count((32, 48)) == 1
    assert np.array_equal(first, again)


def test_other_compressions_are_read_at_once(tmp_path, reads):
    image_file.read_image(exr(tmp_path / "a.exr", "zip"))
    assert reads == [(90, None)]


def test_a_broken_file_has_one_message(tmp_path, reads):
    path = exr(tmp_path / "a.exr", "dwaa")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 3])
    with pytest.raises(ValueError, match=r"a\.exr") as error:
        image_file.read_image(path)
    assert len(str(error.value).splitlines()) == 1
