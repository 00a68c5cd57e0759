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


def header_of(path):
    [file] = fits_file.frames(str(path))
    return file.header


def pixels_of(path):
    [file] = fits_file.frames(str(path))
    return file.mosaic()


@pytest.mark.parametrize("name", ["a.fits", "BIAS.FIT", "a.fts", "a.fits.gz"])
def test_unsigned_pixels_come_back(tmp_path, name):
    path = write(tmp_path / name)
    assert fits_file.is_fits(path)
    assert header_of(path).shape == DN.shape
    found = pixels_of(path)
    np.testing.assert_array_equal(found, DN)
    assert found.dtype == np.uint16 and found.flags.c_contiguous


@pytest.mark.parametrize("dtype", ["uint8", "int16", "int32", "int64", "uint32", "<f4",
                                   "<f8"])  # fmt: skip
def test_whole_numbers_of_any_type_come_back(tmp_path, dtype):
    pixels = (DN % 200).astype(dtype)
    path = write(tmp_path / "a.fits", pixels)
    np.testing.assert_array_equal(pixels_of(path), pixels)


def test_tiles_of_compressed_files_come_back(tmp_path):
    path = write(tmp_path / "a.fits.fz", hdu=fits.CompImageHDU)
    np.testing.assert_array_equal(pixels_of(path), DN)


OTHER = (DN[:, ::-1] // 2).astype(np.uint16)
SCI = {"name": "SCI"}


def stored(path, *images):
    """Write a file of (pixels, fields of its ImageHDU, header); the first of None is an
    empty primary one. Return its path as text."""
    file = fits.HDUList([fits.PrimaryHDU(images[0][0])])
    file[0].header.update(images[0][1] if len(images[0]) > 1 else {})
    for pixels, fields, *header in images[1:]:
        file.append(fits.ImageHDU(pixels, **fields))
        file[-1].header.update(*header)
    file.writeto(path)
    return str(path)


def test_a_table_is_no_image(tmp_path):
    path = tmp_path / "a.fits"
    table = fits.BinTableHDU.from_columns([fits.Column("a", "D", array=[1.0])])
    fits.HDUList([fits.PrimaryHDU(), table, fits.ImageHDU(DN)]).writeto(path)
    np.testing.assert_array_equal(pixels_of(path), DN)
    assert header_of(path).notes == ()


@pytest.mark.parametrize(
    ("images", "note"),
    [
        ([(OTHER[:2, :3],), (DN, SCI)], "image 1 (SCI, 16x12) is used, not 0 (3x2)"),
        (
            [(None,), (OTHER, {"name": "DQ"}), (DN, SCI), (OTHER, {"name": "ERR"})],
            "image 2 (SCI, 16x12) is used, not 1 (DQ, 16x12), 3 (ERR, 16x12)",
        ),
        ([(DN,), (OTHER, {"name": "mask"})], "image 0 (16x12) is used, not 1 (MASK"),
    ],
)
def test_the_picture_among_several_images_is_said(tmp_path, images, note):
    path = stored(tmp_path / "a.fits", *images)
    np.testing.assert_array_equal(pixels_of(path), DN)
    assert header_of(path).notes[0].startswith(note)


@pytest.mark.parametrize("image", ["AMP2", "amp2", "AMP2,1", "2"])
def test_an_image_is_chosen_by_name_or_number(tmp_path, image):
    path = stored(
        tmp_path / "a.fits", (None,), (OTHER, {"name": "AMP1"}), (DN, {"name": "AMP2"})
    )
    [file] = fits_file.frames(path, image)
    np.testing.assert_array_equal(file.mosaic(), DN)


@pytest.mark.parametrize(
    ("image", "words"),
    [
        (None, r"holds 2 images: 1 \(SCI, 16x12\), 2 \(SCI, 16x12\); choose one"),
        ("SCI", r"has several images SCI; it holds 1 \(SCI"),
        ("SCI,3", "has no image SCI,3; it holds 1"),
        ("0", "has no image 0; it holds 1"),
        ("all", "image SCI has no DETSEC or CCDSEC"),
    ],
)
def test_several_images_are_listed_where_it_is_not_clear(tmp_path, image, words):
    path = stored(tmp_path / "a.fits", (None,), (DN, SCI), (OTHER, SCI | {"ver": 2}))
    with pytest.raises(ValueError, match=f"a.fits: .*{words}"):
        fits_file.frames(path, image)
    [file] = fits_file.frames(path, "SCI,2")
    np.testing.assert_array_equal(file.mosaic(), OTHER)


@pytest.mark.parametrize(
    ("own", "seconds"),
    [({}, 3.0), ({"EXPTIME": 4.0}, 4.0), ({"INHERIT": False}, None)],
)
def test_an_extension_inherits_the_primary_header(tmp_path, own, seconds):
    path = stored(tmp_path / "a.fits", (None, {"EXPTIME": 3.0}), (DN, SCI, own))
    assert header_of(path).exposure_time == seconds


def test_the_images_of_a_cube_are_frames(tmp_path):
    path = write(tmp_path / "a.fits", np.stack([DN, OTHER]), EXPTIME=2.0)
    first, second = fits_file.frames(path)
    np.testing.assert_array_equal(first.mosaic(), DN)
    np.testing.assert_array_equal(second.mosaic(), OTHER)
    assert [f.header.name for f in (first, second)] == ["a.fits[0]", "a.fits[1]"]
    assert second.header.exposure_time == 2.0


def test_settings_are_what_changes_the_numbers_of_a_frame(tmp_path):
    path = write(
        tmp_path / "a.fits", GAIN=120, EGAIN=1.0, ISOSPEED=800, OBJECT="M31",
        BITDEPTH=12, INSTRUME="QHY268M",
    )  # fmt: skip
    header = header_of(path)
    assert header.settings == {
        "EGAIN": "1", "GAIN": "120", "ISOSPEED": "800", "BITDEPTH": "12",
        "INSTRUME": "QHY268M",
    }  # fmt: skip
    assert (header.iso, header.depth, header.model) == (800, 12, "QHY268M")


def test_bounds_of_a_header_are_legal(tmp_path):
    header = {"BITDEPTH": 1, "EXPTIME": 0, "CCD_TEMP": -273.15}
    found = header_of(write(tmp_path / "a.fits", **header))
    assert (found.depth, found.exposure_time, found.temperature) == (1, 0, -273.15)


def test_scaled_integers_are_those_they_mean(tmp_path):
    image = fits.PrimaryHDU((DN % 200).astype(np.float32) * 4 + 100)
    image.scale("int16", bscale=4, bzero=100)
    image.writeto(tmp_path / "a.fits")
    found = pixels_of(tmp_path / "a.fits")
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
    found = header_of(write(tmp_path / "a.fits", **header))
    said = found.exposure_time, found.temperature, found.electrons_per_dn
    assert said == expected


def test_a_keyword_without_a_value_says_nothing(tmp_path):
    image = fits.PrimaryHDU(DN)
    for name in ("EXPTIME", "GAIN", "BIASSEC", "ROWORDER"):
        image.header[name] = fits.card.Undefined()
    image.writeto(tmp_path / "a.fits")
    header = header_of(tmp_path / "a.fits")
    assert header.exposure_time is None and header.settings == {}


@pytest.mark.parametrize("pedestal", [100, -100])
def test_a_pedestal_of_either_sign_is_taken_off(tmp_path, pedestal):
    # MaxIm DL: to be added, and negative. PixInsight: to be subtracted.
    pixels = np.maximum(DN, 100)
    path = write(tmp_path / "a.fits", pixels, PEDESTAL=pedestal)
    assert header_of(path).notes == ("a PEDESTAL of 100 DN is taken off",)
    np.testing.assert_array_equal(pixels_of(path), pixels - 100)


@pytest.mark.parametrize(
    ("order", "cfa"), [("TOP-DOWN", "GRBG"), ("bottom-up", None), (None, "GRBG")]
)
def test_the_top_row_comes_first(tmp_path, order, cfa):
    header = {"BAYERPAT": "RGGB", "XBAYROFF": 1}
    header |= {"ROWORDER": order} if order else {}
    path = write(tmp_path / "a.fits", **header)
    expected = DN[::-1] if order == "bottom-up" else DN
    np.testing.assert_array_equal(pixels_of(path), expected)
    assert header_of(path).cfa == cfa


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
        (DN, {"BITDEPTH": 0}, "BITDEPTH is 0; must be a number, at least 1"),
        (DN, {"ISOSPEED": "high"}, "ISOSPEED is 'high'; must be a number"),
        (DN, {"CCD_TEMP": -300.0}, "CCD-TEMP is -300.0; must be a number, at least -2"),
        (DN, {"ROWORDER": "left"}, 'ROWORDER is "LEFT"; must be TOP-DOWN or BOTTOM-UP'),
    ],
)  # fmt: skip
def test_what_is_no_frame_is_an_error(tmp_path, pixels, header, words):
    path = write(tmp_path / "a.fits", pixels, **header)
    with pytest.raises(ValueError, match=f"a.fits: .*{words}"):
        pixels_of(path)


def test_a_cube_of_one_frame_is_one(tmp_path):
    path = write(tmp_path / "a.fits", DN[None])
    np.testing.assert_array_equal(pixels_of(path), DN)


def test_a_file_without_images_is_an_error(tmp_path):
    path = tmp_path / "a.fits"
    table = fits.BinTableHDU.from_columns([fits.Column("a", "D", array=[1.0])])
    fits.HDUList([fits.PrimaryHDU(), table]).writeto(path)
    with pytest.raises(ValueError, match="a.fits: holds no image; give the file of on"):
        header_of(path)


@pytest.mark.parametrize("name", ["a.fits", "a.fits.gz", "a.fits.fz"])
@pytest.mark.parametrize("share", [0.0, 0.05, 0.3, 0.6, 0.95])
def test_a_file_that_is_cut_off_is_an_error(tmp_path, name, share, recwarn):
    big = np.random.default_rng(1).integers(0, 65536, (200, 300)).astype(np.uint16)
    hdu = fits.CompImageHDU if name.endswith(".fz") else fits.PrimaryHDU
    path = write(tmp_path / name, big, hdu)
    whole = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ValueError, match=f"{name}: ") as caught:
        pixels_of(path)
    assert "\n" not in str(caught.value)
    assert not [one for one in recwarn if "FITS" in str(one.message)]


def test_bytes_of_something_else_are_an_error(tmp_path):
    (tmp_path / "a.fits").write_bytes(b"II*\0" + bytes(9000))
    with pytest.raises(ValueError, match="a.fits: is no FITS file, or cut off"):
        header_of(tmp_path / "a.fits")
    with pytest.raises(FileNotFoundError, match="none.fits"):
        header_of(tmp_path / "none.fits")


def test_without_astropy_the_error_says_what_to_install(tmp_path, monkeypatch):
    path = write(tmp_path / "a.fits")
    monkeypatch.setitem(sys.modules, "astropy.io.fits", None)
    with pytest.raises(ValueError, match=r"pip install 'cg2raw\[fits\]'"):
        header_of(path)
