# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Every reader opens every kind of file, and reads our very numbers."""

import itertools
import json
import math
import re
import subprocess

import numpy as np
import pytest
import rawpy
import tifffile

from dng import dng_files
from oracles import cameras
from tiers import first_fast, slow

BLACK, WHITE = 512, 16383
PATTERNS = ("RGGB", "GRBG", "GBRG", "BGGR", cameras.X_TRANS)
DAYLIGHT = dng_files.fields_of()["color_matrix_2"]
LEVELS = {"bits": 14, "black_level": BLACK, "white_level": WHITE}
ONE_MATRIX = {
    "calibration_illuminant_1": "D65",
    "calibration_illuminant_2": None,
    "color_matrix_1": DAYLIGHT,
    "color_matrix_2": None,
}
# Several tiles and strips each way; an odd size ends within a CFA repeat.
SHAPES = {"even": (272, 1040), "odd": (271, 1039)}
CASES = [
    *itertools.product(("none", "ljpeg"), (False, True), PATTERNS, (1, 2), SHAPES),
    *itertools.product(("ljpeg-2d",), (False,), PATTERNS, (2,), SHAPES),
]
# Without --slow: each pair of what a file has, but one matrix in all with a preview.
FEW = [case for case in CASES if case[1] == (case[3] == 1)]


def name_of(case):
    compression, preview, cfa, matrices, size = case
    cfa = "x-trans" if cfa == cameras.X_TRANS else cfa
    words = (compression, "preview" if preview else "raw", cfa, f"{matrices}m", size)
    return "-".join(words)


def sensor_of(case):
    _, _, cfa, matrices, _ = case
    matrix = ONE_MATRIX if matrices == 1 else {}
    return dng_files.sensor(cfa=cfa, noise=None, **LEVELS, **matrix)


@pytest.fixture(scope="module")
def files(tmp_path_factory, request):
    """Return {case: (path, DN)} of the whole matrix, or of the few."""
    folder = tmp_path_factory.mktemp("readers")
    written, is_fast = {}, request.config.option.markexpr == "not slow"
    for seed, case in enumerate(FEW if is_fast else CASES):
        compression, preview, *_, size = case
        sensor = sensor_of(case)
        path = folder / f"{name_of(case)}.dng"
        mosaic = dng_files.random_mosaic(sensor, SHAPES[size], seed)
        dng_files.write(path, sensor, mosaic, compression=compression, preview=preview)
        written[case] = path, mosaic
    return written


@pytest.fixture(params=[c if c in FEW else slow(c) for c in CASES], ids=name_of)
def case(request, files):
    """Return (words of the case, path, DN)."""
    return (request.param, *files[request.param])


def neutral_of(case):
    return np.array(sensor_of(case).illuminant("A").neutral)


def test_libraw(case):
    words, path, mosaic = case
    with rawpy.imread(str(path)) as raw:
        np.testing.assert_array_equal(raw.raw_image, mosaic)
        np.testing.assert_array_equal(raw.raw_image_visible, mosaic)
        colors = "".join("RGBG"[i] for i in np.ravel(raw.raw_pattern))
        assert colors == words[2]
        assert raw.black_level_per_channel == [BLACK] * 4
        assert raw.white_level == WHITE
        multipliers = np.array(raw.camera_whitebalance[:3])
        matrix = raw.rgb_xyz_matrix[:3]
    np.testing.assert_allclose(multipliers, 1.0 / neutral_of(words), rtol=2e-6)
    # LibRaw and dcraw keep the daylight matrix.
    np.testing.assert_allclose(matrix, np.reshape(DAYLIGHT, (3, 3)), atol=1e-6)


@pytest.mark.parametrize(
    ("cfa", "compression"),
    first_fast(
        [
            ("RGGB", "ljpeg"),
            (cameras.X_TRANS, "ljpeg-2d"),
            ("RGGB", "ljpeg-2d"),
            (cameras.X_TRANS, "ljpeg"),
        ],
        2,
    ),
)
def test_libraw_reads_lossless_jpeg_of_any_width(cfa, compression, tmp_path):
    """Some pairs of tile and image width are cases of their own in LibRaw."""
    sensor = dng_files.sensor(cfa=cfa, noise=None, **LEVELS)
    path = tmp_path / "wide.dng"
    for width in (*range(32, 1312, 16), *range(1536, 4200, 128), 601, 799, 1025):
        mosaic = dng_files.random_mosaic(sensor, (24, width), width)
        dng_files.write(path, sensor, mosaic, compression=compression, preview=False)
        with rawpy.imread(str(path)) as raw:
            np.testing.assert_array_equal(raw.raw_image, mosaic, err_msg=f"{width}")


def test_dcraw(case, program, tmp_path):
    program("dcraw")
    words, path, mosaic = case
    for option in ("-D", "-E"):
        dn, complaint = dng_files.dcraw(path, tmp_path / "dn.tif", option, "-4")
        np.testing.assert_array_equal(dn, mosaic)
        assert complaint == ""
    report = dng_files.run("dcraw", "-i", "-v", path).stdout.decode()
    cfa = words[2]
    side = math.isqrt(len(cfa))
    rows = "/".join(cfa[at : at + side] for at in range(0, len(cfa), side))
    assert f"Filter pattern: {rows}\n" in report
    multipliers = re.search(r"Camera multipliers: ([\d. ]+)", report)[1].split()[:3]
    np.testing.assert_allclose(
        np.array(multipliers, float), 1.0 / neutral_of(words), atol=2e-6
    )
    said = dng_files.run("dcraw", "-v", "-w", "-h", "-c", path).stderr.decode()
    assert f"darkness {BLACK}, saturation {WHITE}," in said


def test_tifffile(case):
    words, path, mosaic = case
    with tifffile.TiffFile(path) as tiff:
        page = dng_files.raw_page(tiff)
        np.testing.assert_array_equal(page.asarray(), mosaic)
        assert page.photometric == tifffile.PHOTOMETRIC.CFA
        colors = {"R": 0, "G": 1, "B": 2}
        assert page.tags["CFAPattern"].value == bytes(colors[c] for c in words[2])
        assert page.is_tiled == (words[0] != "none")


@pytest.fixture(scope="module")
def by_oiiotool(files, program, tmp_path_factory):
    """Return the folder of what oiiotool's raw reader makes of all files, at once:
    neither our plugin nor tiff claims reading .dng."""
    folder = tmp_path_factory.mktemp("oiiotool")
    words = []
    for path, _ in files.values():
        words += ["--iconfig", "raw:Demosaic", "none", path]  # of the next file alone
        words += ["-o", folder / f"{path.stem}.tif", "--pop"]
    dng_files.run(program("oiiotool"), *words)
    return folder


def test_oiiotool(case, by_oiiotool):
    _, path, mosaic = case
    dn = tifffile.imread(by_oiiotool / f"{path.stem}.tif")
    np.testing.assert_array_equal(dn, mosaic)


def test_exiftool(files, program):
    # All at once: a start of exiftool takes longer than a file.
    tool = program("exiftool")
    paths = [path for path, _ in files.values()]
    report = dng_files.run(tool, "-j", "-validate", "-a", "-warning", "-error", *paths)
    entries = json.loads(report.stdout)
    assert len(entries) == len(files)
    for entry in entries:
        assert "Warning" not in entry and "Error" not in entry, entry
        assert entry["Validate"] == "OK", entry


def test_exiftool_finds_no_warning_in_a_real_camera_file(camera_data, program):
    # The measure above is fair: real DNGs pass without one, and a warning would show.
    tool = program("exiftool")
    path = camera_data / "real" / "Hero6_GOPR0024.dng"
    report = dng_files.run(tool, "-j", "-validate", "-a", "-warning", path)
    assert "Warning" not in json.loads(report.stdout)[0]


def test_black_level_of_each_x_trans_site(program, tmp_path):
    program("dcraw")
    black = np.random.default_rng(3).integers(400, 900, 36)
    sensor = dng_files.sensor(
        cfa=cameras.X_TRANS, noise=None, **{**LEVELS, "black_level": black.tolist()}
    )
    shape = (513, 600)  # LibRaw demosaics X-Trans from 512 x 512 pixels on
    rows, cols = np.indices(shape)
    path = tmp_path / "flat.dng"
    mosaic = black[rows % 6 * 6 + cols % 6] + 3000
    dng_files.write(path, sensor, mosaic.astype(np.uint16), illuminant="A")
    options = {"gamma": (1, 1), "output_bps": 16, "adjust_maximum_thr": 0}
    with rawpy.imread(str(path)) as raw:
        libraw = raw.postprocess(use_camera_wb=True, no_auto_bright=True, **options)
    dcraw, _ = dng_files.dcraw(
        path, tmp_path / "out.tif", "-w", "-W", "-6", "-g", "1", "1"
    )
    for picture in (libraw, dcraw):
        inner = picture[20:-20, 20:-20]
        assert inner.mean() > 3000
        assert inner.std(axis=(0, 1)).max() < 2  # of 65535


SUBSET = [c for c in CASES if c[2] in ("GRBG", cameras.X_TRANS) and c[3] == 2]


@pytest.mark.slow
@pytest.mark.parametrize("words", SUBSET, ids=name_of)
def test_rawtherapee_opens(words, files, program, tmp_path):
    tool = program("rawtherapee-cli")
    out = tmp_path / "out.tif"
    dng_files.run(tool, "-q", "-o", out, "-t", "-b16", "-Y", "-c", files[words][0])
    height, width = SHAPES[words[-1]]
    border = 7 if words[2] == cameras.X_TRANS else 4  # RawTherapee's own, on each side
    assert tifffile.imread(out).shape == (height - 2 * border, width - 2 * border, 3)


def darktable(tool, path, out):
    """Return (exit code, what it said) of developing a file."""
    core = ("--core", "--configdir", out.parent, "--library", ":memory:")
    command = (tool, path, out, *core, "--conf", "write_sidecar_files=never")
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("words", SUBSET, ids=name_of)
def test_darktable_opens(words, files, program, tmp_path):
    tool = program("darktable-cli")
    out = tmp_path / "out.tif"
    code, said = darktable(tool, files[words][0], out)
    if words[0] == "ljpeg-2d":  # the reason why it is not the default
        assert not out.exists()
        return
    assert code == 0, said
    height, width = SHAPES[words[-1]]
    border = 2  # DefaultCropOrigin
    assert tifffile.imread(out).shape == (height - 2 * border, width - 2 * border, 3)
