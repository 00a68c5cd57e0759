# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sections of FITS images: overscan is taken off, amplifiers make one picture."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import cg2raw
from cg2raw.io import fits_file
from cg2raw.io.fits_sections import binning_of

fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")

BLACK, WHITE = 300, 4095  # DN, of the profile
SENSOR = cg2raw.Sensor.from_json(
    json.dumps(
        {
            "schema": 1, "id": "made", "make": "Made", "model": "CCD",
            "unique_camera_model": "Made CCD", "sources": {}, "cfa": "mono",
            "width": 16, "height": 12, "bits": 12, "black_level": BLACK,
            "white_level": WHITE,
        }
    )
)  # fmt: skip
RNG = np.random.default_rng(3)
LIGHT = RNG.integers(0, 900, (12, 16)).astype(np.uint16)


def read(path, image=None, **levels):
    """Return the DN of the one frame of a file, at SENSOR's levels, and its header."""
    sensor = cg2raw.Sensor.from_json(json.dumps(json.loads(SENSOR.to_json()) | levels))
    [file] = fits_file.frames(str(path), image)
    return file.mosaic(sensor=sensor), file.header


def write(path, pixels, **header):
    image = fits.PrimaryHDU(pixels.astype(np.uint16))
    image.header.update(header)
    image.writeto(path)
    return path


def with_overscan(bias, side):
    """Return (pixels, sections) of LIGHT over a bias, with 4 px of overscan."""
    wide = side in ("left", "right")
    overscan = np.zeros((12, 4) if wide else (4, 16))
    order = [overscan, LIGHT] if side in ("left", "bottom") else [LIGHT, overscan]
    pixels = bias + (np.hstack(order) if wide else np.vstack(order))
    sections = {  # from the first row that is stored on, as FITS counts
        "left": ("[5:20,1:12]", "[1:4,1:12]"),
        "right": ("[1:16,1:12]", "[17:20,1:12]"),
        "bottom": ("[1:16,5:16]", "[1:16,1:4]"),
        "top": ("[1:16,1:12]", "[1:16,16:13]"),
    }
    return pixels, sections[side]


@pytest.mark.parametrize("keyword", ["TRIMSEC", "DATASEC"])
@pytest.mark.parametrize("side", ["left", "right", "bottom", "top"])
@pytest.mark.parametrize("bias", [290, 300, 311])
def test_the_bias_is_that_of_the_overscan(tmp_path, side, bias, keyword):
    pixels, (picture, overscan) = with_overscan(bias, side)
    header = {keyword: picture, "BIASSEC": overscan}
    dn, header = read(write(tmp_path / "a.fits", pixels, **header))
    np.testing.assert_array_equal(dn, LIGHT + BLACK)
    assert header.shape == (12, 16) and "overscan (BIASSEC)" in header.notes[0]


def test_rows_that_are_stored_bottom_up_are_turned_after_that(tmp_path):
    pixels, (picture, overscan) = with_overscan(310, "bottom")
    header = {"TRIMSEC": picture, "BIASSEC": overscan, "ROWORDER": "BOTTOM-UP"}
    dn, _ = read(write(tmp_path / "a.fits", pixels, **header))
    np.testing.assert_array_equal(dn, LIGHT[::-1] + BLACK)


def test_noise_and_single_pixels_of_the_overscan_move_no_bias(tmp_path):
    pixels, (picture, overscan) = with_overscan(320.0, "right")
    pixels[:, 16:] += np.tile([-2, 2, -1, 1], (12, 1))
    pixels[3, 17] = 60000  # as the trail of a saturated row has it
    header = {"TRIMSEC": picture, "BIASSEC": overscan}
    dn, _ = read(write(tmp_path / "a.fits", pixels, **header))
    np.testing.assert_array_equal(dn, LIGHT + BLACK)


def test_saturated_pixels_stay_saturated(tmp_path):
    pixels, (picture, overscan) = with_overscan(340, "right")
    pixels[0, :3] = WHITE, WHITE - 1, WHITE + 9
    header = {"TRIMSEC": picture, "BIASSEC": overscan}
    dn, _ = read(write(tmp_path / "a.fits", pixels, **header))
    assert dn[0, :3].tolist() == [WHITE, WHITE - 41, WHITE + 9]


def test_without_a_sensor_the_picture_is_as_it_is_stored(tmp_path):
    pixels, (picture, overscan) = with_overscan(340, "right")
    path = write(tmp_path / "a.fits", pixels, TRIMSEC=picture, BIASSEC=overscan)
    [file] = fits_file.frames(str(path))
    np.testing.assert_array_equal(file.mosaic(), LIGHT + 340)


def test_a_file_that_is_trimmed_already_is_whole(tmp_path):
    sections = {"TRIMSEC": "[5:20,1:12]", "BIASSEC": "[1:4,1:14]"}
    dn, header = read(write(tmp_path / "a.fits", LIGHT, **sections))
    np.testing.assert_array_equal(dn, LIGHT)
    assert header.notes == ("is trimmed already: its overscan is not in the file",)


@pytest.mark.parametrize(("left", "cfa"), [(1, "RGGB"), (2, "GRBG"), (3, "RGGB")])
def test_the_cfa_is_that_of_the_picture_s_corner(tmp_path, left, cfa):
    section = f"[{left}:16,1:12]"
    path = write(tmp_path / "a.fits", LIGHT, DATASEC=section, BAYERPAT="RGGB")
    [file] = fits_file.frames(str(path))
    assert file.header.cfa == cfa


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"TRIMSEC": "1:16"}, r"TRIMSEC is 1:16; must be a section such as"),
        ({"TRIMSEC": "[0:0,0:0]"}, r"TRIMSEC is \[0:0,0:0\], and the image 16x12: it"),
        ({"DATASEC": "[1:17,1:12]"}, "DATASEC is .* must lie in the image"),
        (
            {"DATASEC": "[1:12,1:12]", "BIASSEC": "[13:17,1:12]"},
            r"BIASSEC is \[13:17,1:12\], and the image 16x12: it must lie in",
        ),
        ({"BIASSEC": "[13:16,1:12]"}, "BIASSEC says .* and neither TRIMSEC nor DATA"),
        (
            {"DATASEC": "[1:13,1:12]", "BIASSEC": "[13:16,1:12]"},
            "BIASSEC and DATASEC overlap",
        ),
        (
            {"BIASSEC1": "[1:4,1:12]", "TRIMSEC": "[5:16,1:12]"},
            "BIASSEC1 says .* and neither TRIMSEC1 nor DATASEC1 where",
        ),
    ],
)
def test_sections_that_make_no_sense_are_refused(tmp_path, sections, words):
    path = write(tmp_path / "a.fits", LIGHT, **sections)
    with pytest.raises(ValueError, match=f"a.fits: {words}"):
        fits_file.frames(str(path))


def test_a_profile_without_room_below_black_is_refused(tmp_path):
    pixels, (picture, overscan) = with_overscan(340.0, "right")
    pixels[:, 16:] += np.tile([-6, 6, -3, 3], (12, 1))
    path = write(tmp_path / "a.fits", pixels, TRIMSEC=picture, BIASSEC=overscan)
    with pytest.raises(ValueError, match="level of 5 DN leaves no room .* to 340"):
        read(path, black_level=5)


def test_amplifiers_of_one_image_have_a_bias_each(tmp_path):
    """Overscan of both lies between their halves, as where they are read outwards."""
    left, right = LIGHT[:, :8] + 310, LIGHT[:, 8:] + 290
    pixels = np.hstack([left, np.full((12, 3), 310), np.full((12, 5), 290), right])
    path = write(
        tmp_path / "a.fits", pixels, BIASSEC1="[9:11,1:12]", DATASEC1="[1:8,1:12]",
        BIASSEC2="[12:16,1:12]", DATASEC2="[17:24,1:12]",
    )  # fmt: skip
    dn, header = read(path)
    np.testing.assert_array_equal(dn, LIGHT + BLACK)
    assert any("is put together of 0 1, 0 2" in note for note in header.notes)


def amplifiers(path, across, down, order=1, binning=1, **more):
    """Write LIGHT as an extension for each of across x down amplifiers, all mirrored
    but the first column and row, each with a bias and overscan of its own, in a window
    of the detector."""
    hdus, height, width = [], 12 // down, 16 // across
    for n in range(across * down):
        row, col = divmod(n, across)
        part = LIGHT[row * height :][:height, col * width :][:, :width]
        y, x = [row * height + 1, (row + 1) * height], [col * width, (col + 1) * width]
        y, x = [n + 20 for n in y], [n + 30 for n in x]
        part = part[:: -1 if row else 1, :: -1 if col else 1]
        x[0] += 1
        y[0], x[0] = (y[0] - 1) * binning + 1, (x[0] - 1) * binning + 1
        y[1], x[1] = y[1] * binning, x[1] * binning
        y, x = y[:: -1 if row else 1], x[:: -1 if col else 1]
        pixels = np.hstack([part, np.zeros((height, 4))]) + 280 + 10 * n
        hdu = fits.ImageHDU(pixels.astype(np.uint16), name=f"AMP{n + 1}")
        hdu.header["DATASEC"] = f"[1:{width},1:{height}]"
        hdu.header["BIASSEC"] = f"[{width + 1}:{width + 4},1:{height}]"
        hdu.header["DETSEC"] = f"[{x[0]}:{x[1]},{y[0]}:{y[1]}]"
        hdu.header["CCDSUM"] = f"{binning} {binning}"
        hdu.header["EGAIN"] = 2.0 + 0.5 * (n % 2)
        hdu.header.update(more)
        hdus.append(hdu)
    fits.HDUList([fits.PrimaryHDU(), *hdus[::order]]).writeto(path)
    return path


@pytest.mark.parametrize(
    ("across", "down", "order", "binning"),
    [(2, 1, 1, 1), (2, 2, 1, 1), (2, 2, -1, 2), (4, 4, -1, 1)],
)
def test_amplifiers_are_put_together_if_that_is_wanted(
    tmp_path, across, down, order, binning
):
    path = amplifiers(tmp_path / "a.fits", across, down, order, binning)
    dn, header = read(path, "all")
    np.testing.assert_array_equal(dn, LIGHT + BLACK)
    assert header.electrons_per_dn is None  # they differ
    assert set(header.settings["EGAIN"].split(", ")) == {"2", "2.5"}
    assert any(
        "as if they had one gain, though headers say 2, 2.5" in note
        for note in header.notes
    )


def test_amplifiers_are_not_taken_for_one_unless_that_is_wanted(tmp_path):
    path = amplifiers(tmp_path / "a.fits", 2, 1)
    words = r"holds 2 images: 1 \(AMP1, 12x12\), 2 \(AMP2, 12x12\); .*--image all"
    with pytest.raises(ValueError, match=words):
        fits_file.frames(str(path))
    dn, header = read(path, "AMP2")
    np.testing.assert_array_equal(dn, LIGHT[:, :7:-1] + BLACK)
    assert header.electrons_per_dn == 2.5


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"DETSEC": "[1:8,1:12]"}, "AMP1, AMP2 do not make one picture of 8x12"),
        ({"DETSEC": "[1:7,1:12]"}, "DETSEC of image AMP1 is 7x12 pixels, the pictu"),
        ({"CCDSUM": "2"}, "CCDSUM is 2; must be two numbers"),
    ],
)
def test_amplifiers_that_do_not_fit_are_refused(tmp_path, more, words):
    path = amplifiers(tmp_path / "a.fits", 2, 1, **more)
    with pytest.raises(ValueError, match=f"a.fits: {words}"):
        fits_file.frames(str(path), "all")


def test_a_pixel_is_the_sum_of_columns_and_of_rows():
    """CCDSUM has those along x, columns, first."""
    assert binning_of("a.fits", {"CCDSUM": " 2  13 "}) == (2, 13)
    assert binning_of("a.fits", {}) == (1, 1)
    for text in ("2", "0 2", "2 2 2", "2x2", ""):
        with pytest.raises(ValueError, match=f"a.fits: CCDSUM is {text}; must be two"):
            binning_of("a.fits", {"CCDSUM": text})


def test_amplifiers_have_as_many_frames_each(tmp_path):
    path = amplifiers(tmp_path / "a.fits", 2, 1)
    with fits.open(path, mode="update") as file:
        for hdu in file[1:]:
            hdu.data = np.stack([hdu.data, hdu.data + 100])
    frames = fits_file.frames(str(path), "all")
    assert [frame.header.name for frame in frames] == ["a.fits[0]", "a.fits[1]"]
    for frame in frames:  # the bias of the overscan is 100 DN higher, too
        np.testing.assert_array_equal(frame.mosaic(sensor=SENSOR), LIGHT + BLACK)
    with fits.open(path, mode="update") as file:
        file[2].data = file[2].data[:1]
    with pytest.raises(ValueError, match="its images have different numbers of frames"):
        fits_file.frames(str(path), "all")


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ((3, 4, 5), "is 5x4x3, 3 frames of 5x4"),
        ((0, 5), "is 5x0, no picture"),
        ((4, 0), "is 0x4, no picture"),
        ((7,), "is 7, no picture"),
    ],
)
def test_an_image_has_frames_of_some_pixels(shape, words):
    assert fits_file._shape("a", SimpleNamespace(shape=(2, 4, 5))) == (2, (4, 5))
    with pytest.raises(ValueError, match=f"a: its image {words}; must be one frame"):
        fits_file._shape("a", SimpleNamespace(shape=shape))
