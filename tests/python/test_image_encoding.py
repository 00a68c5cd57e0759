# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the numbers of image files are taken for: curves, and alpha."""

import struct
import zlib

import numpy as np
import PIL.Image
import pytest
import tifffile
from PIL import ImageCms

from cg2raw.io.image_file import read_image
from dataset.data_sets import scene, write_image

CODES = np.arange(0, 252, dtype=np.uint8).reshape(7, 12, 3)


def read(path):
    """Return the Image of a render or a picture."""
    return read_image(path, undo="stated")


def srgb_of_specification(code):
    """Return light of sRGB values 0..1. Source: IEC 61966-2-1."""
    code = np.float64(code)
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def of_bits(kind):
    """Return the code values at a depth."""
    return CODES if kind == "uint8" else CODES.astype(np.uint16) * 257


@pytest.mark.parametrize("kind", ["uint8", "uint16"])
def test_integers_that_say_so_are_srgb(tmp_path, kind):
    image = read(write_image(tmp_path / "a.png", of_bits(kind), kind))
    assert image.undone == "srgb"
    light = srgb_of_specification(CODES / 255.0)
    assert np.array_equal(image.pixels, light.astype(np.float32))


@pytest.mark.parametrize("kind", ["uint8", "uint16"])
@pytest.mark.parametrize("ending", ["tif", "tga", "sgi", "dpx"])
def test_integers_that_say_nothing_are_what_is_asked_for(tmp_path, ending, kind):
    if (ending, kind) == ("tga", "uint16"):
        pytest.skip("Targa files have 8 bits")
    path = write_image(tmp_path / f"a.{ending}", of_bits(kind), kind)
    light = srgb_of_specification(CODES / 255.0).astype(np.float32)
    for undo in ("srgb", "stated-or-srgb"):
        image = read_image(path, undo=undo)
        assert image.undone == "srgb" and np.array_equal(image.pixels, light)
    with pytest.raises(ValueError, match=r"a\.\w+: its whole .*--linearize"):
        read(path)
    linear = read_image(path, undo="stated", space="lin_rec709")
    assert np.array_equal(linear.pixels, (CODES / 255).astype(np.float32))


def test_a_space_that_the_caller_states_outweighs_a_profile(tmp_path):
    path = str(tmp_path / "a.tif")
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("LAB")).tobytes()
    tifffile.imwrite(path, CODES, photometric="rgb", iccprofile=profile)
    assert read_image(path, undo="srgb", space="sRGB").undone == "srgb"


def test_a_raw_space_is_no_light(tmp_path):
    path = write_image(tmp_path / "a.exr", np.abs(scene()), "float")
    space = "RAW - nikon-d40 - A"
    for undo in ("stated", "srgb"):
        with pytest.raises(ValueError, match="RAW - nikon-d40 - A"):
            read_image(path, undo=undo, space=space)


def test_linear_integers_are_scaled(tmp_path):
    path = with_gamma(write_image(tmp_path / "a.png", CODES, "uint8"), 100000)
    assert np.array_equal(read(path).pixels, (CODES / 255).astype(np.float32))


def with_gamma(path, gamma):
    """Make a PNG say by gAMA, and by it alone, what its code values are."""
    data, at = path.read_bytes(), 8
    chunk = b"gAMA" + struct.pack(">I", gamma)
    made = data[:at]
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        name, whole = data[at + 4 : at + 8], data[at : at + 12 + length]
        at += 12 + length
        if name == b"IDAT":
            made += struct.pack(">I", 4) + chunk + struct.pack(">I", zlib.crc32(chunk))
        if name in (b"IHDR", b"IDAT", b"IEND"):
            made += whole
    path.write_bytes(made)
    return path


@pytest.mark.parametrize(
    ("gamma", "transfer"), [(100000, ""), (55556, "g1.8"), (45455, "g2.2")]
)
def test_the_file_says_the_curve(tmp_path, gamma, transfer):
    path = with_gamma(write_image(tmp_path / "a.png", CODES, "uint8"), gamma)
    image = read(path)
    assert image.undone == transfer
    exponent = 1 if not transfer else float(transfer[1:])
    light = (CODES / 255.0) ** exponent
    assert np.allclose(image.pixels, light, rtol=1e-6, atol=0)


ALPHA = np.tile(np.array([0, 64, 255], np.uint8), (7, 4))
UNASSOCIATED = {
    "a.png": {"oiio__UnassociatedAlpha": 1},
    "a.tif": {"oiio__UnassociatedAlpha": 1},
    "a.tga": {"oiio__UnassociatedAlpha": 1},
}


@pytest.mark.parametrize("space", ["sRGB", "lin_rec709"])
@pytest.mark.parametrize("name", UNASSOCIATED)
def test_what_is_transparent_is_dark(tmp_path, name, space):
    """The curve is undone first, then alpha is multiplied in."""
    pixels = np.dstack([CODES, ALPHA])
    path = write_image(tmp_path / name, pixels, "uint8", **UNASSOCIATED[name])
    light = CODES / 255.0
    light = srgb_of_specification(light) if space == "sRGB" else light
    over_black = light * (ALPHA / 255.0)[..., None]
    found = read_image(path, undo="stated", space=space).pixels
    np.testing.assert_allclose(found, over_black, rtol=2e-7)
    # Of pixels that no curve encodes, the same without a word of it.
    if space == "lin_rec709":
        found = read_image(path, space=space, keep_half=True).pixels
        np.testing.assert_allclose(found, over_black, rtol=2e-7)


def test_a_palette_may_be_transparent(tmp_path):
    path = tmp_path / "a.png"
    picture = PIL.Image.fromarray(np.array([[0, 1], [1, 0]], np.uint8), "P")
    picture.putpalette([200, 150, 220, 255, 255, 255])
    picture.save(path, transparency=bytes([0, 255]))
    found = read(path).pixels
    assert found[..., 1].tolist() == [[0, 1], [1, 0]]


def test_associated_alpha_is_not_multiplied_twice(tmp_path):
    pixels = np.dstack([np.abs(scene()), np.full((24, 36), 0.25, np.float32)])
    pixels[0, 0] = np.nan, 3, np.inf, 0
    for name in ("a.exr", "a.tif"):
        found = read(write_image(tmp_path / name, pixels, "float")).pixels
        np.testing.assert_array_equal(found, pixels[..., :3])
    path = write_image(tmp_path / "b.tif", pixels, "float", oiio__UnassociatedAlpha=1)
    found = read(path).pixels
    assert (found[0, 0] == 0).all()  # whatever colour it has
    np.testing.assert_array_equal(found[1:], pixels[1:, :, :3] / 4)


def test_integers_of_32_bits_are_an_error(tmp_path):
    path = str(tmp_path / "a.tif")
    tifffile.imwrite(path, CODES.astype(np.uint32), photometric="rgb")
    with pytest.raises(ValueError, match="needs 8 or 16 bits"):
        read(path)


def test_icc_profiles_of_other_spaces_are_an_error(tmp_path):
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("LAB")).tobytes()
    path = str(tmp_path / "a.tif")
    tifffile.imwrite(path, CODES, photometric="rgb", iccprofile=profile)
    with pytest.raises(ValueError, match="ICC profile"):
        read(path)
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    tifffile.imwrite(path, CODES, photometric="rgb", iccprofile=profile)
    assert read(path).undone == "srgb"
