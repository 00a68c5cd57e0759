# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tags say what the sensor's profile and the simulation say, digit by digit."""

import struct

import numpy as np
import pytest
import tifffile
from scipy import ndimage

import cg2raw
from dng import dng_files
from oracles import cameras

SUB_IFDS, EXIF_IFD, FORWARD_MATRIX = 330, 34665, (50964, 50965)
NOISE_PROFILE, OPCODE_LIST_2 = 51041, 51009
TONE_CURVE, BLACK_RENDER = 50940, 51110
DEFAULT_SCALE = 50718
LONG = 4  # TIFF's type


def tags(path):
    """Return {number: value} of IFD0 and, over it, of the mosaic's IFD."""
    with tifffile.TiffFile(path) as tiff:
        both = list(tiff.pages[0].tags)
        both += list(dng_files.raw_page(tiff).tags)
        return {tag.code: tag.value for tag in both}


@pytest.fixture
def path(tmp_path):
    return tmp_path / "shot.dng"


def test_identity_and_structure(path):
    dng_files.write(path, dng_files.sensor())
    first, mosaic, exif = dng_files.tags_of(path)
    assert first["NewSubfileType"] == 1 and mosaic["NewSubfileType"] == 0
    assert first["DNGVersion"] == bytes([1, 4, 0, 0])
    assert first["DNGBackwardVersion"] == bytes([1, 3, 0, 0])
    assert first["Orientation"] == 1
    assert first["Make"] == "NIKON CORPORATION" and first["Model"] == "NIKON D40"
    assert first["UniqueCameraModel"] == "Nikon D40"
    assert first["Software"].startswith("cg2raw ")
    assert mosaic["BitsPerSample"] == 16 and mosaic["SamplesPerPixel"] == 1
    assert mosaic["CFAPlaneColor"] == bytes([0, 1, 2]) and mosaic["CFALayout"] == 1
    assert mosaic["ActiveArea"] == (0, 0, 64, 96)
    assert mosaic["DefaultCropOrigin"] == (2, 1, 2, 1)
    assert mosaic["DefaultCropSize"] == (92, 1, 60, 1)
    assert mosaic["DefaultScale"] == (1, 1, 1, 1)
    assert exif["ExifVersion"] == "0230"
    unknown = {"DateTime", "Artist", "Copyright", "ImageDescription", "ExposureTime"}
    assert not unknown & (set(first) | set(exif))


@pytest.mark.parametrize(
    ("aspect", "scale"),
    [
        (2.0, (2, 1, 1, 1)),
        (0.5, (1, 1, 2, 1)),
        (10 / 11, (1, 1, 11, 10)),
        (float(np.float32(1 / 3)), (1, 1, 3, 1)),
        *((none, (1, 1, 1, 1)) for none in (None, 0.0, -2.0, np.nan, np.inf)),
    ],
)
def test_the_shape_of_pixels_is_their_default_scale(path, aspect, scale):
    raw = dng_files.sensor().simulate(np.full((16, 16, 3), 0.3), illuminant="A")
    cg2raw.write_dng(path, raw, shot={"pixel_aspect": aspect})
    assert tags(path)[DEFAULT_SCALE] == scale


def test_no_preview_is_one_ifd(path):
    dng_files.write(path, dng_files.sensor(), preview=False)
    with tifffile.TiffFile(path) as tiff:
        assert len(tiff.pages) == 1
        assert SUB_IFDS not in tiff.pages[0].tags
        assert tiff.pages[0].tags["NewSubfileType"].value == 0
        assert tiff.pages[0].tags["DNGVersion"].value == bytes([1, 4, 0, 0])


@pytest.mark.parametrize("preview", [False, True])
def test_pointers_are_longs(path, preview):
    dng_files.write(path, dng_files.sensor(), preview=preview)
    with tifffile.TiffFile(path) as tiff:
        first = tiff.pages[0].tags
        types = [first[n].dtype for n in (SUB_IFDS, EXIF_IFD) if n in first]
    assert types == [LONG] * (1 + preview)


def fractions(matrix, denominator):
    pairs = [(round(m * denominator), denominator) for m in np.ravel(matrix)]
    return tuple(np.ravel(pairs))


def test_colour_is_exact(path):
    sensor = dng_files.sensor()
    profile = dng_files.fields_of()
    dng_files.write(path, sensor, illuminant="neutral:1.25:0.3333333")
    first, _, _ = dng_files.tags_of(path)
    assert first["ColorMatrix1"] == fractions(profile["color_matrix_1"], 10000)
    assert first["ColorMatrix2"] == fractions(profile["color_matrix_2"], 10000)
    assert first["CalibrationIlluminant1"] == 17
    assert first["CalibrationIlluminant2"] == 21
    # Green is 1 though red is above it.
    assert first["AsShotNeutral"] == fractions([1.25, 1.0, 0.333333], 1000000)
    absent = {
        "AsShotWhiteXY",
        "AnalogBalance",
        "CameraCalibration1",
        "BaselineExposure",
    }
    assert not absent & set(first)


def test_the_daylight_matrix_is_the_second(path):
    # dcraw and LibRaw keep whichever comes last.
    names = ("calibration_illuminant", "color_matrix")
    profile = dng_files.fields_of()
    swap = {f"{name}_{3 - n}": profile[f"{name}_{n}"] for name in names for n in (1, 2)}
    dng_files.write(path, dng_files.sensor(**swap))
    first, _, _ = dng_files.tags_of(path)
    assert first["CalibrationIlluminant2"] == 21
    assert first["ColorMatrix2"] == fractions(profile["color_matrix_2"], 10000)


def test_forward_matrices(path):
    one = [0.5, 0.3, 0.1642, 0.25, 0.75, 0.0, 0.0, 0.1, 0.7249]
    two = [0.6, 0.2, 0.1642, 0.3, 0.7, 0.0, 0.0, 0.2, 0.6249]
    sensor = dng_files.sensor(forward_matrix_1=one, forward_matrix_2=two)
    dng_files.write(path, sensor)
    found = tags(path)
    assert found[FORWARD_MATRIX[0]] == fractions(one, 10000)
    assert found[FORWARD_MATRIX[1]] == fractions(two, 10000)


def test_exact_is_one_matrix_of_a_camera_of_its_own(path):
    dng_files.write(path, dng_files.sensor(), matrices="exact")
    first, _, _ = dng_files.tags_of(path)
    assert first["CalibrationIlluminant1"] == 21
    assert set(first["ColorMatrix1"][1::2]) == {10_000_000}  # denominators
    assert "ColorMatrix2" not in first and FORWARD_MATRIX[0] not in first
    assert first["Model"] == "NIKON D40 exact"
    assert first["UniqueCameraModel"] == "Nikon D40 exact"


@pytest.mark.parametrize(
    ("black", "expected"),
    [([64, 65, 66, 67], (64, 1, 65, 1, 66, 1, 67, 1)), ([64.25, 0, 1, 2.5], None)],
)
def test_levels(path, black, expected):
    sensor = dng_files.sensor(black_level=black, white_level=1000, cfa="GBRG")
    dng_files.write(path, sensor)
    _, mosaic, _ = dng_files.tags_of(path)
    assert mosaic["BlackLevelRepeatDim"] == (2, 2)
    assert mosaic["BlackLevel"] == (expected or fractions(black, 10000))
    assert mosaic["WhiteLevel"] == 1000
    assert mosaic["CFARepeatPatternDim"] == (2, 2)
    assert mosaic["CFAPattern"] == bytes([1, 2, 0, 1])


def test_noise_profile(path):
    beta1, beta2 = [1e-4, 2e-4, 4e-4, 3e-4], [1e-6, 2e-6, 4e-6, 3e-6]
    noise = [{"iso": 100, "beta1": beta1, "beta2": beta2}]
    sensor = dng_files.sensor(noise=noise, cfa="RGGB")
    dng_files.write(path, sensor, iso=100)
    expected = [1e-4, 1e-6, 3e-4, 3e-6, 3e-4, 3e-6]  # green: the mean of its two sites
    np.testing.assert_allclose(tags(path)[NOISE_PROFILE], expected, rtol=1e-12)
    _, _, exif = dng_files.tags_of(path)
    assert exif["ISOSpeedRatings"] == 100
    dng_files.write(path, sensor)
    assert NOISE_PROFILE not in tags(path)


SITES = [500 + site for site in range(36)]


@pytest.mark.parametrize(
    ("black", "expected"), [(SITES, SITES), (512, [512] * 36), (512.25, [512.25] * 36)]
)
def test_x_trans_has_its_own_repeat(path, black, expected):
    beta2 = [site * 1e-9 for site in SITES]
    noise = [{"iso": 100, "beta1": [2e-4, 1e-4, 3e-4], "beta2": beta2}]
    cfa = cameras.X_TRANS
    sensor = dng_files.sensor(cfa=cfa, black_level=black, noise=noise)
    dng_files.write(path, sensor, iso=100)
    _, mosaic, _ = dng_files.tags_of(path)
    assert mosaic["CFARepeatPatternDim"] == mosaic["BlackLevelRepeatDim"] == (6, 6)
    assert mosaic["CFAPattern"] == bytes("RGB".index(color) for color in cfa)
    denominator = 1 if float(expected[0]).is_integer() else 10000
    assert mosaic["BlackLevel"] == fractions(expected, denominator)
    pairs = np.reshape(tags(path)[NOISE_PROFILE], (3, 2))
    for color, scale, pair in zip("RGB", (2e-4, 1e-4, 3e-4), pairs, strict=True):
        of_color = [site for site, c in zip(SITES, cfa, strict=True) if c == color]
        np.testing.assert_allclose(pair, (scale, np.mean(of_color) * 1e-9), rtol=1e-12)


def test_linear_tone_curve(path):
    dng_files.write(path, dng_files.sensor(), tone_curve="linear")
    assert tuple(tags(path)[TONE_CURVE]) == (0.0, 0.0, 1.0, 1.0)
    assert tags(path)[BLACK_RENDER] == 1
    dng_files.write(path, dng_files.sensor())
    assert TONE_CURVE not in tags(path)


def gain_maps(opcodes):
    """Return [(top, left, bottom, right), (pitches), gains (rows, cols)] of GainMaps.

    Source: DNG specification 1.4, chapter 6: big-endian, spacing and origin in the
    active area's height and width."""
    (count,) = struct.unpack_from(">I", opcodes)
    maps, at = [], 4
    for _ in range(count):
        number, version, flags, size = struct.unpack_from(">4I", opcodes, at)
        assert (number, version, flags) == (9, 0x01030000, 1)
        area = struct.unpack_from(">4I", opcodes, at + 16)
        plane, planes, *pitch, rows, cols = struct.unpack_from(">6I", opcodes, at + 32)
        spacing_v, spacing_h, *origin = struct.unpack_from(">4d", opcodes, at + 56)
        (map_planes,) = struct.unpack_from(">I", opcodes, at + 88)
        assert (plane, planes, map_planes, origin) == (0, 1, 1, [0.0, 0.0])
        assert (spacing_v, spacing_h) == (1 / (rows - 1), 1 / (cols - 1))
        assert size == 76 + 4 * rows * cols
        gains = np.frombuffer(opcodes, ">f4", rows * cols, at + 92).reshape(rows, cols)
        maps.append((area, tuple(pitch), gains))
        at += 16 + size
    assert at == len(opcodes)
    return maps


SHADING = {
    "r2": -0.6,
    "r4": 0.1,
    "r6": -0.05,
    "tilt_x": 0.1,
    "tilt_y": -0.05,
    "tilt_x_r2": 0.04,
    "tilt_y_r2": -0.02,
}


def shaded_sensor(cfa):
    effect = {"name": "lens_shading", "parameters": SHADING, "evidence": {}}
    return dng_files.sensor(cfa=cfa, black_level=512, noise=None, effects=[effect])


@pytest.mark.parametrize("cfa", ["RGGB", cameras.X_TRANS])
def test_gain_map_undoes_lens_shading(path, cfa):
    height, width = 301, 403
    dng_files.write(path, shaded_sensor(cfa), shape=(height, width))
    maps = gain_maps(tags(path)[OPCODE_LIST_2])
    areas = [(r, c, height, width) for r in (0, 1) for c in (0, 1)]
    assert [m[0] for m in maps] == areas  # one for each pixel of 2 x 2
    assert {m[1] for m in maps} == {(2, 2)}
    half = np.hypot(height, width) / 2
    for _, _, gains in maps:
        rows, cols = gains.shape
        v = (np.linspace(0, 1, rows)[:, None] - 0.5) * height / half
        u = (np.linspace(0, 1, cols)[None, :] - 0.5) * width / half
        r2 = u * u + v * v
        radial = 1 - 0.6 * r2 + 0.1 * r2**2 - 0.05 * r2**3
        tilt = 0.1 * u - 0.05 * v + r2 * (0.04 * u - 0.02 * v)
        np.testing.assert_allclose(gains, 1 / (radial + tilt), rtol=1e-6)


COLOR_SHADING = {
    "red_r2": -0.12,
    "red_r4": 0.05,
    "red_x": 0.03,
    "red_y": -0.02,
    "blue_r2": 0.08,
    "blue_r4": -0.1,
    "blue_x": -0.04,
    "blue_y": 0.01,
}


def color_shaded_sensor(cfa, *more):
    listed = [("color_shading", COLOR_SHADING), *more]
    effects = [{"name": n, "parameters": p, "evidence": {}} for n, p in listed]
    return dng_files.sensor(cfa=cfa, black_level=512, noise=None, effects=effects)


@pytest.mark.parametrize("cfa", ["RGGB", "GBRG", cameras.X_TRANS])
def test_gain_maps_undo_color_shading(path, cfa):
    """A map per site of the CFA, of its colour; green has none of it."""
    height, width = 301, 403
    dng_files.write(path, color_shaded_sensor(cfa), shape=(height, width))
    maps = gain_maps(tags(path)[OPCODE_LIST_2])
    side = 2 if len(cfa) == 4 else 6
    sites = [(row, col) for row in range(side) for col in range(side)]
    assert [m[0] for m in maps] == [(*site, height, width) for site in sites]
    assert {m[1] for m in maps} == {(side, side)}
    half = np.hypot(height, width) / 2
    values = {"G": [0.0] * 4}
    values["R"], values["B"] = np.reshape(list(COLOR_SHADING.values()), (2, 4))
    for letter, (_, _, gains) in zip(cfa, maps, strict=True):
        rows, cols = gains.shape
        v = (np.linspace(0, 1, rows)[:, None] - 0.5) * height / half
        u = (np.linspace(0, 1, cols)[None, :] - 0.5) * width / half
        r2 = u * u + v * v
        of_r2, of_r4, of_x, of_y = values[letter]
        left = 1 + of_r2 * r2 + of_r4 * r2**2 + of_x * u + of_y * v
        np.testing.assert_allclose(gains, 1 / left, rtol=1e-6)


@pytest.mark.parametrize("cfa", ["RGGB", cameras.X_TRANS])
def test_gain_maps_make_a_frame_flat(path, cfa):
    """Both effects as they are simulated, times the maps as a reader applies them."""
    height, width = 120, 180
    sensor = color_shaded_sensor(cfa, ("lens_shading", SHADING | {"r2": -0.3}))
    grey = np.full((height, width, 3), 0.4, np.float32)
    light = {"illuminant": "D65", "highlights": False}
    flat = sensor.signal(grey, effects=False, **light)
    shaded = sensor.signal(grey, **light)
    dng_files.write(path, sensor, shape=(height, width))
    undone = shaded.copy()
    for area, pitch, gains in gain_maps(tags(path)[OPCODE_LIST_2]):
        top, left, bottom, right = area
        rows, cols = np.arange(top, bottom, pitch[0]), np.arange(left, right, pitch[1])
        at = np.meshgrid(
            (rows + 0.5) / height * (gains.shape[0] - 1),
            (cols + 0.5) / width * (gains.shape[1] - 1),
            indexing="ij",
        )
        undone[np.ix_(rows, cols)] *= ndimage.map_coordinates(
            gains.astype(float), at, order=1
        )
    assert np.abs(shaded / flat - 1).max() > 0.3
    np.testing.assert_allclose(undone, flat, rtol=1e-3)


def test_no_gain_map_without_the_effect(path):
    dng_files.write(path, dng_files.sensor())
    assert OPCODE_LIST_2 not in tags(path)
    dng_files.write(path, shaded_sensor("RGGB"), effects=False)
    assert OPCODE_LIST_2 not in tags(path)


@pytest.mark.slow
@pytest.mark.parametrize("cfa", ["RGGB", cameras.X_TRANS])
def test_darktable_applies_the_gain_maps(path, cfa, program, tmp_path):
    tool = program("darktable-cli")
    dng_files.write(path, shaded_sensor(cfa), shape=(600, 800))
    out = tmp_path / "out.tif"
    core = ["--core", "--configdir", tmp_path, "--library", ":memory:"]
    for setting in ("plugins/darkroom/workflow=none", "write_sidecar_files=never"):
        core += ["--conf", setting]
    dng_files.run(tool, path, out, "--icc-type", "LIN_REC709", *core)
    green = tifffile.imread(out)[..., 1].astype(float)
    corner, centre = green[10:30, 10:30].mean(), green[290:310, 390:410].mean()
    assert corner == pytest.approx(centre, rel=0.01)  # without the map: 0.4


def test_same_bytes_again(path, tmp_path):
    again = tmp_path / "again.dng"
    sensor = dng_files.sensor("samsung-s20fe")
    for name in (path, again):
        dng_files.write(name, sensor, iso=800, seed=3)
    assert path.read_bytes() == again.read_bytes()
