# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies.sources.renders: crops of a folder's images, drawn by a seed."""

import numpy as np
import OpenImageIO as oiio
import pytest

from studies.protocol import PROTOCOL
from studies.sources.renders import read_renders

COUNT, ROWS, COLUMNS = 5, 96, 128  # of frames


def write_image(path, image):
    """Write (H, W, 3) to an EXR file."""
    rows, columns, channels = image.shape
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), oiio.ImageSpec(columns, rows, channels, "half"))
    assert file.write_image(image) and file.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Five images of 640x360, each of its own red, with a ramp in green."""
    folder = tmp_path_factory.mktemp("renders")
    for number in range(COUNT):
        image = np.zeros((360, 640, 3), np.float32)
        image[..., 0] = number + 1.0
        image[..., 1] = np.linspace(0.0, 1.0, 640)
        write_image(folder / f"night_{number:04d}.exr", image)
    return folder


def test_draws_are_crops_of_each_image_once(folder):
    renders = read_renders(folder, PROTOCOL.scene)
    drawn = renders.drawn(COUNT, 3)
    assert {image.shape for image in drawn} == {(ROWS, COLUMNS, 3)}
    assert sorted(image[0, 0, 0] for image in drawn) == [1.0, 2.0, 3.0, 4.0, 5.0]
    # Blocks of 3: 128 of the 213 columns, so as much of the ramp.
    shares = [abs(image[0, -1, 1] - image[0, 0, 1]) for image in drawn]
    assert shares == pytest.approx([127 / 213] * COUNT, abs=0.01)


def test_a_seed_is_a_draw_and_two_are_two(folder):
    renders = read_renders(folder, PROTOCOL.scene)
    one, again, other = (renders.drawn(4, seed) for seed in (0, 0, 1))
    assert all(np.array_equal(a, b) for a, b in zip(one, again, strict=True))
    assert not all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def test_more_than_there_are_come_again(folder):
    reds = [int(i[0, 0, 0]) for i in read_renders(folder, PROTOCOL.scene).drawn(12, 0)]
    assert sorted(reds.count(number) for number in range(1, 6)) == [2, 2, 2, 3, 3]


def test_another_file_is_another_hash(folder, tmp_path):
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    same = read_renders(tmp_path, PROTOCOL.scene).digest
    assert same == read_renders(folder, PROTOCOL.scene).digest
    write_image(tmp_path / "night_0000.exr", np.ones((360, 640, 3), np.float32))
    assert read_renders(tmp_path, PROTOCOL.scene).digest != same


@pytest.mark.parametrize(
    ("shape", "said"),
    [(None, "holds no renders"), ((48, 640, 3), "is 640x48, and a frame")],
)
def test_what_holds_no_frames_is_said(shape, said, tmp_path):
    if shape:
        write_image(tmp_path / "night_0000.exr", np.ones(shape, np.float32))
    with pytest.raises(ValueError, match=said):
        read_renders(tmp_path, PROTOCOL.scene)
