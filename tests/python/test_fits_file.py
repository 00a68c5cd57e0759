# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""FITS files: what is written into them by astropy comes back, or one error does."""

import sys

import numpy as np
import pytest

from cg2raw.io import fits_file

fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")

DN = np.random.default_rng(5).integers(0, 65536, (12, 16)).astype(np.uint16)
DN[0, 0], DN[-1, -1] = 0, 65535


def write(path, pixels=DN, hdu=fits.PrimaryHDU, **header):
    """Write an image of @pixels; return the path as text. _ in a keyword is -."""
    image = hdu(pixels)
    for name, value in header.items():
        image.header[name.replace("_", "-")] = value
    first = [] if hdu is fits.PrimaryHDU else [fits.PrimaryHDU()]
    fits.HDUList([*first, image]).writeto(path)
    return str(path)


@pytest.mark.parametrize("name", ["a.fits", "BIAS.FIT", "a.fts", "a.fits.gz"])
def test_unsigned_pixels_come_back(tmp_path, name):
    path = write(tmp_path / name)
    assert fits_file.is_fits(path)
    assert fits_file.read_header(path).shape == DN.shape
    found = fits_file.read_pixels(path)
    np.testing.assert_array_equal(found, DN)
    assert found.dtype == np.uint16 and found.flags.c_contiguous


@pytest.mark.parametrize("dtype", ["uint8", "int16", "int32", "int64", "uint32", "<f4",
                                   "<f8"])  # fmt: skip
def test_whole_numbers_of_any_type_come_back(tmp_path, dtype):
    pixels = (DN % 200).astype(dtype)
    path = write(tmp_path / "a.fits", pixels)
    np.testing.assert_array_equal(fits_file.read_pixels(path), pixels)


def test_tiles_of_compressed_files_come_back(tmp_path):
    path = write(tmp_path / "a.fits.fz", hdu=fits.CompImageHDU)
    np.testing.assert_array_equal(fits_file.read_pixels(path), DN)


def test_the_first_image_with_pixels_counts(tmp_path):
    path = tmp_path / "a.fits"
    table = fits.BinTableHDU.from_columns([fits.Column("a", "D", array=[1.0])])
    images = [fits.ImageHDU(DN), fits.ImageHDU(DN[::-1])]
    fits.HDUList([fits.PrimaryHDU(), table, *images]).writeto(path)
    np.testing.assert_array_equal(fits_file.read_pixels(str(path)), DN)
    [note] = fits_file.read_header(str(path)).notes
    assert note == "holds 2 images; the first is used"


def test_scaled_integers_are_those_they_mean(tmp_path):
    image = fits.PrimaryHDU((DN % 200).astype(np.float32) * 4 + 100)
    image.scale("int16", bscale=4, bzero=100)
    image.writeto(tmp_path / "a.fits")
    found = fits_file.read_pixels(str(tmp_path / "a.fits"))
    np.testing.assert_array_equal(found, (DN % 200) * 4 + 100)


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ({}, (None, None, None)),
        ({"EXPTIME": 0.0, "CCD_TEMP": -4.82}, (0.0, -4.82, None)),
        ({"EXPOSURE": 60, "SET_TEMP": -10}, (60.0, -10.0, None)),
        ({"EXPTIME": 5.0, "EXPOSURE": 7.0}, (5.0, None, None)),
        ({"CCD_TEMP": -4.8, "SET_TEMP": -5.0}, (None, -4.8, None)),
        ({"EGAIN": 2.06, "GAIN": 100}, (None, None, 2.06)),
        ({"GAIN": 100}, (None, None, None)),  # the setting of a camera
        ({"GAIN": (2.06, "gain in e-/ADU")}, (None, None, 2.06)),
        ({"GAIN": (1.5, "electrons per DN")}, (None, None, 1.5)),
        ({"GAIN": (100, "the gain setting")}, (None, None, None)),
        ({"EXPTIME": "  ", "EXPOSURE": "2.5"}, (2.5, None, None)),
    ],
)
def test_what_a_header_says(tmp_path, header, expected):
    found = fits_file.read_header(write(tmp_path / "a.fits", **header))
    said = found.exposure_time, found.temperature, found.electrons_per_dn
    assert said == expected


@pytest.mark.parametrize("pedestal", [100, -100])
def test_a_pedestal_of_either_sign_is_taken_off(tmp_path, pedestal):
    # MaxIm DL: to be added, and negative. PixInsight: to be subtracted.
    pixels = np.maximum(DN, 100)
    path = write(tmp_path / "a.fits", pixels, PEDESTAL=pedestal)
    assert fits_file.read_header(path).pedestal == 100
    np.testing.assert_array_equal(fits_file.read_pixels(path), pixels - 100)


@pytest.mark.parametrize(
    ("order", "cfa"), [("TOP-DOWN", "GRBG"), ("bottom-up", None), (None, "GRBG")]
)
def test_the_top_row_comes_first(tmp_path, order, cfa):
    header = {"BAYERPAT": "RGGB", "XBAYROFF": 1}
    header |= {"ROWORDER": order} if order else {}
    path = write(tmp_path / "a.fits", **header)
    expected = DN[::-1] if order == "bottom-up" else DN
    np.testing.assert_array_equal(fits_file.read_pixels(path), expected)
    assert fits_file.read_header(path).cfa == cfa


@pytest.mark.parametrize(
    ("pixels", "header", "words"),
    [
        (np.zeros((3, 4, 5), "i2"), {}, "is 5x4x3, 3 frames of 5x4; must be one frame"),
        (np.zeros(7, "i2"), {}, "is 7, no picture; must be one frame"),
        (DN.astype(float) / 2, {}, "no DN, the first in stored row 0, column"),
        (np.full((4, 4), np.nan), {}, "16 pixels are no DN, the first in stored row 0, "
         "column 0: nan; must be whole numbers, 0 to 65535"),
        (np.full((4, 4), 1e300), {}, r"column 0: 1e\+300; must"),
        (np.full((4, 4), -1, "i2"), {}, "column 0: -1; must"),
        (DN, {"PEDESTAL": 9}, "column 0: -9 without its PEDESTAL of 9 DN; must"),
        (DN, {"EXPTIME": -1.0}, "EXPTIME is -1.0; must be a number, at least 0"),
        (DN, {"EXPTIME": "long"}, "EXPTIME is 'long'; must be a number, at least 0"),
        (DN, {"CCD_TEMP": -300.0}, "CCD-TEMP is -300.0; must be a number, at least -2"),
        (DN, {"ROWORDER": "left"}, 'ROWORDER is "LEFT"; must be TOP-DOWN or BOTTOM-UP'),
    ],
)  # fmt: skip
def test_what_is_no_frame_is_an_error(tmp_path, pixels, header, words):
    path = write(tmp_path / "a.fits", pixels, **header)
    with pytest.raises(ValueError, match=f"a.fits: .*{words}"):
        fits_file.read_pixels(path)


def test_a_cube_of_one_frame_is_one(tmp_path):
    path = write(tmp_path / "a.fits", DN[None])
    np.testing.assert_array_equal(fits_file.read_pixels(path), DN)


def test_a_file_without_images_is_an_error(tmp_path):
    path = tmp_path / "a.fits"
    table = fits.BinTableHDU.from_columns([fits.Column("a", "D", array=[1.0])])
    fits.HDUList([fits.PrimaryHDU(), table]).writeto(path)
    with pytest.raises(ValueError, match="a.fits: holds no image; give the file of on"):
        fits_file.read_header(str(path))


@pytest.mark.parametrize("name", ["a.fits", "a.fits.gz", "a.fits.fz"])
@pytest.mark.parametrize("share", [0.0, 0.05, 0.3, 0.6, 0.95])
def test_a_file_that_is_cut_off_is_an_error(tmp_path, name, share, recwarn):
    big = np.random.default_rng(1).integers(0, 65536, (200, 300)).astype(np.uint16)
    hdu = fits.CompImageHDU if name.endswith(".fz") else fits.PrimaryHDU
    path = write(tmp_path / name, big, hdu)
    whole = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ValueError, match=f"{name}: ") as caught:
        fits_file.read_pixels(path)
    assert "\n" not in str(caught.value)
    assert not [one for one in recwarn if "FITS" in str(one.message)]


def test_bytes_of_something_else_are_an_error(tmp_path):
    (tmp_path / "a.fits").write_bytes(b"II*\0" + bytes(9000))
    with pytest.raises(ValueError, match="a.fits: is no FITS file, or cut off"):
        fits_file.read_header(str(tmp_path / "a.fits"))
    with pytest.raises(FileNotFoundError, match="none.fits"):
        fits_file.read_header(str(tmp_path / "none.fits"))


def test_without_astropy_the_error_says_what_to_install(tmp_path, monkeypatch):
    path = write(tmp_path / "a.fits")
    monkeypatch.setitem(sys.modules, "astropy.io.fits", None)
    with pytest.raises(ValueError, match=r"pip install 'cg2raw\[fits\]'"):
        fits_file.read_header(path)
