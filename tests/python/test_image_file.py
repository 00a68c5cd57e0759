# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What image files are taken for."""

import os
import shutil

import numpy as np
import OpenImageIO as oiio
import pytest

from cg2raw.io.image_file import (
    image_size,
    read_image,
    read_plane,
    read_rows,
)
from dataset.data_sets import scene, write_deep, write_image

CODES = np.arange(0, 252, dtype=np.uint8).reshape(7, 12, 3)
ACESCG = (
    0.713,
    0.293,
    0.165,
    0.830,
    0.128,
    0.044,
    0.32168,
    0.33767,
)  # ACES TB-2014-004


def read(path):
    """Return the Image of a render or a picture."""
    return read_image(path, undo="stated")


@pytest.mark.parametrize("name", ["a.exr", "a.tif", "a.hdr"])
def test_floats_are_linear(tmp_path, name):
    pixels = np.abs(scene())
    image = read(write_image(tmp_path / name, pixels, "float"))
    assert image.undone == "" and image.pixels.dtype == np.float32
    if name == "a.hdr":  # 8 bits beside a shared exponent
        assert np.abs(image.pixels - pixels).max() <= pixels.max() / 128
    else:
        assert np.array_equal(image.pixels, pixels)


@pytest.mark.parametrize("curve", ["zip", "dwab", "tiles"])
def test_all_rows_arrive(tmp_path, curve):
    # more rows than are read at a time, an origin of its own, and a last tile cut short
    pixels = np.abs(scene((700, 10)))
    spec = oiio.ImageSpec(10, 700, 3, "float")
    spec.x, spec.y = spec.full_x, spec.full_y = -3, 50
    if curve == "tiles":
        spec.tile_width, spec.tile_height = 32, 48
    else:
        spec.attribute("compression", curve)
    path = str(tmp_path / "a.exr")
    file = oiio.ImageOutput.create(path)
    assert file.open(path, spec) and file.write_image(pixels) and file.close()
    found = read(path).pixels
    # dwab loses some; a row out of place would be off by much more
    assert np.abs(found - pixels).mean() < (0.02 if curve == "dwab" else 1e-9)


BAD = {
    "other.exr": (scene(), "half", {"oiio__ColorSpace": "ACEScg"}, "colour space"),
    "p3.png": (CODES, "uint8", {"oiio__ColorSpace": "srgb_p3d65_scene"}, "p3d65"),
    "one.exr": (scene()[..., :1].copy(), "half", {}, "needs R, G and B"),
    "two.png": (CODES[..., :2].copy(), "uint8", {}, "needs R, G and B"),
    "row.exr": (scene((1, 30000)), "half", {}, "30000x1"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_used_says_why(tmp_path, name):
    pixels, kind, attributes, reason = BAD[name]
    path = write_image(tmp_path / name, pixels, kind, **attributes)
    with pytest.raises(ValueError, match=rf"\A[^\n]*{reason}[^\n]*\Z"):
        read(path)


def test_a_name_that_is_not_utf8_is_an_error_and_a_folder_of_one_is_none(tmp_path):
    path = write_image(tmp_path / "a.exr", scene())
    odd = tmp_path / os.fsdecode(b"caf\xe9.exr")
    shutil.copy(path, odd)
    with pytest.raises(ValueError, match="is not UTF-8; rename the file or folder"):
        read(odd)
    folder = tmp_path / os.fsdecode(b"h\xf6fe")
    folder.mkdir()
    moved = path.rename(folder / "a.exr")
    assert image_size(moved) == scene().shape[:2] and read(moved).path == str(moved)
    moved.write_text("no image")
    with pytest.raises(ValueError, match="h.fe/a.exr: .*magic"):
        read(moved)


def test_other_primaries_are_an_error(tmp_path):
    spec = oiio.ImageSpec(8, 8, 3, "half")
    eight = oiio.TypeDesc("float[8]")
    spec.attribute("chromaticities", eight, ACESCG)
    path = str(tmp_path / "a.exr")
    file = oiio.ImageOutput.create(path)
    assert file.open(path, spec) and file.write_image(scene((8, 8))) and file.close()
    with pytest.raises(ValueError, match="chromaticities"):
        read(path)


def test_a_space_that_the_caller_states_outweighs_primaries(tmp_path):
    spec = oiio.ImageSpec(8, 8, 3, "half")
    spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), ACESCG)
    path = write_parts(tmp_path / "a.exr", [(spec, scene((8, 8)))])
    image = read_image(path, space="lin_rec709")
    assert np.array_equal(image.pixels, scene((8, 8)).astype(np.float16))


def write_parts(path, parts):
    """Write (ImageSpec, (H, W, C) pixels) as the parts of an EXR; return its path."""
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), [spec for spec, _ in parts]), file.geterror()
    for index, (spec, pixels) in enumerate(parts):
        if index:
            assert file.open(str(path), spec, "AppendSubimage"), file.geterror()
        assert file.write_image(pixels), file.geterror()
    assert file.close()
    return path


def part(name, channels, pixels):
    """Return (ImageSpec, pixels) of a named part."""
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(channels), "float")
    spec.channelnames = tuple(channels)
    spec.attribute("oiio:subimagename", name)
    return spec, pixels


def test_the_picture_of_a_multi_part_file(tmp_path):
    beauty, other = scene(seed=2), scene(seed=3)
    parts = [
        part("depth", ["Z"], other[..., :1].copy()),
        part("diffuse", ["R", "G", "B"], other),
        part("rgba", ["R", "G", "B"], beauty),
    ]
    path = write_parts(tmp_path / "a.exr", parts)
    image = read_image(path)
    assert image.layer == "rgba" and np.array_equal(image.pixels, beauty)
    assert np.array_equal(read_image(path, "diffuse").pixels, other)
    assert image_size(path) == (24, 36)
    path = write_parts(tmp_path / "b.exr", parts[:2])
    with pytest.raises(ValueError, match=r"b.exr: .*--layer diffuse.*depth:Z"):
        read_image(path)


def test_channels_of_a_layer_may_lie_apart(tmp_path):
    pixels = np.random.default_rng(4).random((24, 36, 5), dtype=np.float32)
    names = ["Z", "beauty.B", "beauty.G", "mask.A", "beauty.R"]
    file = write_parts(tmp_path / "a.exr", [part("", names, pixels)])
    specs = oiio.ImageInput.open(str(file)).spec().channelnames  # OpenEXR sorts them
    order = [specs.index(f"beauty.{color}") for color in "RGB"]
    image = read_image(file)
    assert image.layer == "beauty" and order == sorted(order)
    assert np.array_equal(image.pixels, pixels[..., [4, 2, 1]])


@pytest.mark.parametrize("depth", ["half", "float"])
def test_half_floats_may_remain_so(tmp_path, depth):
    """Depth beside them, as renderers write it, changes nothing."""
    pixels = np.random.default_rng(4).random((24, 36, 4), dtype=np.float32)
    spec = oiio.ImageSpec(36, 24, 4, depth)
    spec.channelnames = ("R", "G", "B", "Z")
    if depth == "float":
        spec.channelformats = ("half", "half", "half", depth)
    path = write_parts(tmp_path / "a.exr", [(spec, pixels)])
    kept = read_image(path, keep_half=True).pixels
    assert kept.dtype == np.float16
    assert np.array_equal(kept, pixels[..., :3].astype(np.float16))
    found = read_image(path).pixels
    assert found.dtype == np.float32 and np.array_equal(found, kept)
    float_file = write_image(tmp_path / "b.exr", pixels[..., :3].copy(), "float")
    assert read_image(float_file, keep_half=True).pixels.dtype == np.float32


@pytest.mark.parametrize("tile", [0, 16])
@pytest.mark.parametrize("layout", ["margins", "overscan", "both"])
def test_an_image_is_its_display_window(tmp_path, layout, tile):
    """Overscan is cut off; what the data window lacks is black."""
    data = {"margins": (5, 7, 40, 300), "overscan": (-9, -20, 90, 340)}.get(
        layout, (-9, 30, 60, 300)
    )
    x, y, width, height = data
    pixels = np.abs(scene((height, width))) + 0.01
    spec = oiio.ImageSpec(width, height, 3, "float")
    spec.x, spec.y, spec.full_width, spec.full_height = x, y, 64, 310
    spec.tile_width = spec.tile_height = tile
    path = write_parts(tmp_path / "a.exr", [(spec, pixels)])
    whole = np.zeros((1000, 1000, 3), np.float32)
    whole[y + 100 : y + 100 + height, x + 100 : x + 100 + width] = pixels
    found = read_image(path).pixels
    assert found.shape == (310, 64, 3)
    assert np.array_equal(found, whole[100:410, 100:164])
    assert np.array_equal(read_plane(path), found[..., 0])


def test_windows_that_do_not_meet_are_an_error(tmp_path):
    spec = oiio.ImageSpec(16, 16, 3, "float")
    spec.x, spec.full_width, spec.full_height = 500, 64, 48
    path = write_parts(tmp_path / "a.exr", [(spec, scene((16, 16)))])
    with pytest.raises(
        ValueError, match="16x16 at 500,0, lies outside .* 64x48 at 0,0"
    ):
        read_image(path)


def test_deep_images_are_an_error(tmp_path):
    path = write_deep(tmp_path / "deep.exr")
    with pytest.raises(ValueError, match="deep.exr: deep .*oiiotool --flatten"):
        read_image(path)


@pytest.mark.parametrize("name", ["a.NEF", "a.cr2", "a.fits", "a.npy"])
def test_raw_files_are_no_pictures(tmp_path, name):
    """OpenImageIO may read them as their preview."""
    write_image(tmp_path / "a.tif", scene((16, 16)))
    (tmp_path / name).write_bytes((tmp_path / "a.tif").read_bytes())
    with pytest.raises(ValueError, match=f"{name}: is RAW already.*develop it first"):
        read_image(tmp_path / name)


class NoThreads:
    """An image's reader where the system starts no thread."""

    def read_scanlines(self, *arguments):
        raise RuntimeError("Resource temporarily unavailable")

    read_tiles = read_scanlines


@pytest.mark.parametrize("tile", [0, 16])
def test_what_openimageio_throws_is_said_of_the_file(tile):
    spec = oiio.ImageSpec(16, 16, 3, "float")
    spec.tile_height = tile
    with pytest.raises(OSError, match="a.exr: cannot be read: Resource temporarily"):
        read_rows("a.exr", NoThreads(), spec, 0, 16, [0, 1, 2], "float")


@pytest.mark.parametrize("tile", [0, 16])
def test_channels_come_in_the_order_that_is_asked_for(tmp_path, tile):
    pixels = np.random.default_rng(4).random((16, 16, 4), dtype=np.float32)
    spec = oiio.ImageSpec(16, 16, 4, "float")
    spec.channelnames = ("R", "G", "B", "A")
    spec.tile_width = spec.tile_height = tile
    path = write_parts(tmp_path / "a.exr", [(spec, pixels)])
    source = oiio.ImageInput.open(str(path))
    for channels in ([0, 1, 2], [1, 2], [2, 0], [0, 3]):
        found = read_rows(path, source, source.spec(), 0, 16, channels, oiio.FLOAT)
        assert np.array_equal(found, pixels[..., channels])
