# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A monochrome sensor's DNG: LinearRaw of one sample, read by others and by us."""

import json

import numpy as np
import pytest
import rawpy
import tifffile

import cg2raw
from cg2raw import _core
from dng import dng_files
from oracles import cameras

BLACK, WHITE = 1000, 65535
NOISE = {"iso": 100, "beta1": 7.5e-6, "beta2": 9.6e-9}
SHADING = {"r2": -0.3, "r4": 0.05, "r6": 0.0, "tilt_x": 0.01, "tilt_y": -0.02}
SHADING |= {"tilt_x_r2": 0.0, "tilt_y_r2": 0.0}
SHADED = [{"name": "lens_shading", "parameters": SHADING}]
COMPRESSIONS = ("none", "ljpeg")


def sensor_of(**fields):
    given = {"black_level": BLACK, "white_level": WHITE, "noise": [NOISE]}
    return cg2raw.Sensor.from_json(cameras.mono_text(**{"bits": 16, **given, **fields}))


@pytest.fixture(params=COMPRESSIONS)
def written(request, tmp_path):
    """Return (path, DN): any value anywhere."""
    path, sensor = tmp_path / f"{request.param}.dng", sensor_of()
    mosaic = dng_files.random_mosaic(sensor, (61, 83))
    dng_files.write(path, sensor, mosaic, illuminant="", compression=request.param)
    return path, mosaic


def test_tags(tmp_path):
    path = tmp_path / "mono.dng"
    dng_files.write(path, sensor_of(), illuminant="", iso=100)
    first, mosaic, _ = dng_files.tags_of(path)
    assert mosaic["PhotometricInterpretation"] == tifffile.PHOTOMETRIC.LINEAR_RAW
    assert mosaic["SamplesPerPixel"] == 1
    assert (mosaic["BlackLevel"], mosaic["WhiteLevel"]) == ((BLACK, 1), WHITE)
    assert mosaic["NoiseProfile"] == pytest.approx((NOISE["beta1"], NOISE["beta2"]))
    colored = ("CFAPattern", "CFARepeatPatternDim", "CFAPlaneColor", "CFALayout")
    colored += ("ColorMatrix1", "AsShotNeutral", "CalibrationIlluminant1")
    assert not {*colored} & {*first, *mosaic}


def test_libraw(written):
    path, mosaic = written
    with rawpy.imread(str(path)) as raw:
        np.testing.assert_array_equal(raw.raw_image_visible, mosaic)
        assert raw.num_colors == 1
        assert raw.black_level_per_channel == [BLACK] * 4
        assert raw.white_level == WHITE


def test_libraw_reads_lossless_jpeg_of_any_width(tmp_path):
    """Some pairs of tile and image width are cases of their own in LibRaw."""
    sensor, path = sensor_of(), tmp_path / "wide.dng"
    for width in (*range(32, 1312, 16), *range(1536, 4200, 128), 601, 799, 1025):
        mosaic = dng_files.random_mosaic(sensor, (24, width), width)
        dng_files.write(path, sensor, mosaic, illuminant="", preview=False)
        with rawpy.imread(str(path)) as raw:
            np.testing.assert_array_equal(raw.raw_image, mosaic, err_msg=f"{width}")


def test_dcraw(written, program, tmp_path):
    program("dcraw")
    path, mosaic = written
    dn, complaint = dng_files.dcraw(path, tmp_path / "dn.tif", "-D", "-4")
    np.testing.assert_array_equal(dn, mosaic)
    assert complaint == ""
    assert "Raw colors: 1\n" in dng_files.run("dcraw", "-i", "-v", path).stdout.decode()


def ramp(tmp_path):
    """Return the path of a grey ramp from left to right, 400x600."""
    sensor, path = sensor_of(noise=None), tmp_path / "ramp.dng"
    scene = np.linspace(0.02, 0.9, 600, dtype=np.float32)
    image = np.broadcast_to(scene[None, :, None], (400, 600, 3))
    cg2raw.write_dng(path, sensor.simulate(image), compression="none")
    return path


def check_grey_ramp(picture, border):
    """Assert that a picture is of the ramp, grey and rising."""
    assert picture.shape[:2] == (400 - 2 * border, 600 - 2 * border)
    colours = picture.reshape(*picture.shape[:2], -1).astype(float)
    assert np.ptp(colours, axis=2).max() <= 0.02 * colours.max()
    columns = colours.mean(axis=(0, 2))[::20]
    assert (np.diff(columns) > 0).all()


@pytest.mark.slow
def test_rawtherapee(program, tmp_path):
    tool, out = program("rawtherapee-cli"), tmp_path / "out.tif"
    dng_files.run(tool, "-q", "-o", out, "-t", "-b16", "-Y", "-c", ramp(tmp_path))
    check_grey_ramp(tifffile.imread(out), 0)


@pytest.mark.slow
def test_darktable(program, tmp_path):
    tool, out = program("darktable-cli"), tmp_path / "out.tif"
    core = ("--core", "--configdir", tmp_path, "--library", ":memory:")
    words = (*core, "--conf", "write_sidecar_files=never")
    dng_files.run(tool, ramp(tmp_path), out, *words)
    check_grey_ramp(tifffile.imread(out), 2)  # DefaultCropOrigin


def test_tifffile(written):
    path, mosaic = written
    with tifffile.TiffFile(path) as tiff:
        np.testing.assert_array_equal(dng_files.raw_page(tiff).asarray(), mosaic)


def test_oiiotool(written, system_oiiotool, tmp_path):
    path, mosaic = written
    out = tmp_path / "dn.tif"
    system_oiiotool("--iconfig", "raw:Demosaic", "none", path, "-o", out)
    np.testing.assert_array_equal(tifffile.imread(out), mosaic)


def test_exiftool_finds_nothing_wrong(written, program):
    tool = program("exiftool")
    report = dng_files.run(tool, "-j", "-validate", "-a", "-warning", written[0])
    (entry,) = json.loads(report.stdout)
    assert entry["Validate"] == "OK", entry


def test_the_preview_is_grey(tmp_path):
    """A grey of 0.5 over white: code 188 of sRGB's curve. Source: IEC 61966-2-1."""
    sensor, path = sensor_of(), tmp_path / "grey.dng"
    level = round(BLACK + 0.5 * (WHITE - BLACK))
    mosaic = np.full((64, 96), level, np.uint16)
    dng_files.write(path, sensor, mosaic, illuminant="")
    assert np.all(tifffile.imread(path) == 188)


def test_the_profile_comes_back(tmp_path):
    path, sensor = tmp_path / "back.dng", sensor_of(effects=SHADED)
    dng_files.write(path, sensor, illuminant="", iso=100, shape=(48, 64))
    back = cg2raw.Sensor.from_dng(path)
    for name in ("cfa", "width", "height", "bits", "black_level", "white_level"):
        assert getattr(back, name) == getattr(sensor, name), name
    (row,) = back.noise
    assert (row["beta1"], row["beta2"]) == ([NOISE["beta1"]], [NOISE["beta2"]])
    (effect,) = back.effects
    assert effect["name"] == "lens_shading"
    assert effect["parameters"] == pytest.approx(SHADING, abs=1e-4)  # of its nodes
    assert not any("neutral" in note or "ColorMatrix" in note for note in notes(path))


def notes(path):
    return _core.read_dng_metadata(str(path)).notes


def test_one_gain_map_is_of_all_pixels(tmp_path):
    path = tmp_path / "shaded.dng"
    dng_files.write(path, sensor_of(effects=SHADED), illuminant="", shape=(48, 64))
    (map_,) = _core.read_dng_metadata(str(path)).gain_maps
    assert (map_["sites"], map_["pitch"]) == ([0], (1, 1))


def test_exact_matrices_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"matrices exact.*monochrome.*say camera"):
        dng_files.write(
            tmp_path / "x.dng", sensor_of(), illuminant="", matrices="exact"
        )


def test_a_plain_array_needs_no_illuminant(tmp_path):
    path, sensor = tmp_path / "plain.dng", sensor_of()
    mosaic = dng_files.random_mosaic(sensor, (40, 50))
    cg2raw.write_dng(path, mosaic, sensor=sensor)
    with rawpy.imread(str(path)) as raw:
        np.testing.assert_array_equal(raw.raw_image, mosaic)
