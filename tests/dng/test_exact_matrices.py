# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""With `exact` matrices every reader gives the render back, not only a full one."""

import itertools

import numpy as np
import pytest
import rawpy
import tifffile

from dng import dng_files
from oracles import cameras, de2000, dng_renderer

# Pixels of a flat patch: RawTherapee refuses files below 100 kB, LibRaw X-Trans below
# 512 x 512 pixels.
SIDE = 66
MARGIN = 16  # of it that demosaicing may touch
# 14 bits: with the 10 of a phone quantisation alone costs 0.2.
LEVELS = {"bits": 14, "black_level": 512, "white_level": 16383}
MATRIX_A, MATRIX_D65 = cameras.matrices("FujifilmXM1")
# Bundled sensors; a name that RawTherapee has a profile of its own for; X-Trans.
SENSORS = {
    "s20fe": {"profile": "samsung-s20fe"},
    "d40": {"profile": "nikon-d40"},
    "d800": {
        "profile": "samsung-s20fe",
        "make": "NIKON CORPORATION",
        "model": "NIKON D800",
        "unique_camera_model": "Nikon D800",
    },
    "xm1": {
        "profile": "nikon-d40",
        "make": "FUJIFILM",
        "model": "X-M1",
        "unique_camera_model": "Fujifilm X-M1",
        "cfa": cameras.X_TRANS,
        "noise": None,
        "color_matrix_1": MATRIX_A.ravel().tolist(),
        "color_matrix_2": MATRIX_D65.ravel().tolist(),
    },
}
LIGHTS = ("A", "D65", "sample:1")
RAWTHERAPEE = """[Version]
AppVersion=5.9
Version=349
[White Balance]
Setting=Camera
[Color Management]
InputProfile={profile}
ToneCurve=false
ApplyLookTable=false
ApplyBaselineExposureOffset=false
ApplyHueSatMap=false
WorkingProfile=ProPhoto
OutputProfile=RTv4_sRGB
OutputBPC=false
"""
# What darktable applies of its own accord is for cameras, not for a comparison.
DARKTABLE = (
    "plugins/darkroom/workflow=none",
    "plugins/darkroom/chromatic-adaptation=legacy",
    "plugins/imageio/format/tiff/bpp=32",
    "write_sidecar_files=never",
)


def colours():
    """Return (8, 12, 3) linear sRGB: greys, then within the gamut; no highlights."""
    random = np.random.default_rng(0).uniform(0.03, 0.8, (8, 12, 3))
    grey = random.mean(axis=-1, keepdims=True)
    chart = grey + 0.6 * (random - grey)
    chart[0] = np.linspace(0.03, 0.8, 12)[:, None]
    return chart


def difference(picture):
    """Return dE2000 of each patch of a linear sRGB picture, centred in the chart."""
    chart = colours()
    full = np.array(chart.shape[:2]) * SIDE
    top, left = (full - picture.shape[:2]) // 2
    seen = np.empty_like(chart)
    for row, col in np.ndindex(chart.shape[:2]):
        first, right = row * SIDE - top + MARGIN, col * SIDE - left + MARGIN
        inner = SIDE - 2 * MARGIN
        patch = picture[first : first + inner, right : right + inner]
        seen[row, col] = patch.mean(axis=(0, 1))
    lab = de2000.lab_from_linear_srgb
    return de2000.de2000(lab(chart), lab(seen))


def linear(srgb):
    """Return linear values of sRGB codes 0..1 (IEC 61966-2-1)."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


@pytest.fixture(
    params=itertools.product(SENSORS, LIGHTS),
    ids=lambda p: f"{p[0]}-{p[1].replace(':', '')}",
    scope="module",
)
def chart(request, tmp_path_factory):
    """Return the path of a chart's DNG with the exact matrix."""
    name, light = request.param
    sensor = dng_files.sensor(**SENSORS[name], **LEVELS)
    path = tmp_path_factory.mktemp("exact") / "chart.dng"
    render = np.kron(colours(), np.ones((SIDE, SIDE, 1)))
    mosaic = sensor.simulate(render, illuminant=light)
    dng_files.write(path, sensor, mosaic, illuminant=light, matrices="exact")
    return path


def test_specification(chart):
    # As Adobe's renderer: by the neutral's own white, which LibRaw and dcraw ignore,
    # and with the matrix rounded to four decimals.
    dng = dng_renderer.read(chart)
    camera = dng_renderer.patch_means(dng, SIDE)
    seen = camera @ dng_renderer.srgb_from_camera(dng).T
    lab = de2000.lab_from_linear_srgb
    assert de2000.de2000(lab(colours()), lab(seen)).mean() <= 0.05


def test_libraw(chart):
    with rawpy.imread(str(chart)) as raw:
        picture = raw.postprocess(
            use_camera_wb=True,
            no_auto_bright=True,
            adjust_maximum_thr=0,
            gamma=(1, 1),
            output_bps=16,
        )
    assert difference(picture / 65535).mean() <= 0.05


def test_dcraw(chart, program, tmp_path):
    program("dcraw")
    options = ("-w", "-W", "-6", "-g", "1", "1", "-o", "1")
    picture, _ = dng_files.dcraw(chart, tmp_path / "out.tif", *options)
    assert difference(picture / 65535).mean() <= 0.05


def test_camera_matrices_do_not(tmp_path):
    # LibRaw knows one matrix: under A the camera's own two are not what it applies.
    sensor = dng_files.sensor("nikon-d40", **LEVELS)
    render = np.kron(colours(), np.ones((SIDE, SIDE, 1)))
    mosaic = sensor.simulate(render, illuminant="A")
    path = tmp_path / "camera.dng"
    dng_files.write(path, sensor, mosaic, illuminant="A", matrices="camera")
    with pytest.raises(AssertionError):
        test_libraw(path)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["(camera)", "(cameraICC)"])
def test_rawtherapee(chart, profile, program, tmp_path):
    # (cameraICC), its default, looks for a profile by the camera's name.
    tool = program("rawtherapee-cli")
    (tmp_path / "neutral.pp3").write_text(RAWTHERAPEE.format(profile=profile))
    out = tmp_path / "out.tif"
    settings = ("-p", tmp_path / "neutral.pp3", "-t", "-b16", "-Y")
    dng_files.run(tool, "-q", "-o", out, *settings, "-c", chart)
    assert difference(linear(tifffile.imread(out) / 65535)).mean() <= 0.3


@pytest.mark.slow
def test_darktable(chart, program, tmp_path):
    tool = program("darktable-cli")
    out = tmp_path / "out.tif"
    profile = ("--icc-type", "LIN_REC709", "--icc-intent", "RELATIVE_COLORIMETRIC")
    core = ["--core", "--configdir", tmp_path, "--library", ":memory:"]
    for setting in DARKTABLE:
        core += ["--conf", setting]
    dng_files.run(tool, chart, out, *profile, *core)
    assert difference(tifffile.imread(out).astype(float)).mean() <= 0.3
