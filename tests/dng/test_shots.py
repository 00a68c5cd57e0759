# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames of shots (CinemaDNG): what their tags say, and that readers see our DN."""

import json

import numpy as np
import pytest
import rawpy
import tifffile

import cg2raw
from dng import dng_files
from oracles import cameras
from tiers import slow

SHOT = {
    "frame_rate": "23.976",
    "time_code": "01:02:03:04",
    "reel_name": "A001",
    "camera_label": "B",
}
TIME_CODES, FRAME_RATE, REEL_NAME, CAMERA_LABEL = 51043, 51044, 51081, 51105
BYTE, SRATIONAL = 1, 10  # TIFF's types
OPCODE_LIST_2, SUB_IFDS = 51009, 330
BAYER = ("RGGB", "GRBG", "GBRG", "BGGR")
# Several tiles and parts of the strip; odd sizes end within a repeat of the CFA.
SHAPES = {"even": (272, 1040), "odd": (401, 1039)}


def write(path, sensor, mosaic, **options):
    """Write a mosaic as a frame of SHOT; options: those of write_dng."""
    light = {"illuminant": "A"}
    shot = options.pop("shot", SHOT)
    cg2raw.write_dng(path, mosaic, sensor=sensor, **light, shot=shot, **options)


@pytest.fixture
def frame(tmp_path):
    """Return (path, sensor, mosaic) of a frame of a shot, written by default."""
    sensor = dng_files.sensor()
    mosaic = dng_files.random_mosaic(sensor, (64, 96))
    write(tmp_path / "shot.0001.dng", sensor, mosaic)
    return tmp_path / "shot.0001.dng", sensor, mosaic


def test_the_tags_of_a_frame(frame):
    with tifffile.TiffFile(frame[0]) as tiff:
        assert len(tiff.pages) == 1
        tags = tiff.pages[0].tags
        assert SUB_IFDS not in tags and tags["NewSubfileType"].value == 0
        assert tags[FRAME_RATE].value == (24000, 1001)
        assert tags[FRAME_RATE].dtype == SRATIONAL and tags[FRAME_RATE].count == 1
        assert tags[TIME_CODES].value == bytes([4, 3, 2, 1, 0, 0, 0, 0])
        assert tags[TIME_CODES].dtype == BYTE
        assert tags[REEL_NAME].value == "A001" and tags[CAMERA_LABEL].value == "B"


RATES = [
    ("23.976", "24000/1001", "01:02:03:23"),
    ("24", "24", "23:59:59:00"),
    ("29.97", "30000/1001", "00:01:00;02"),
    ("47.952", "48000/1001", "01:00:00:47"),
    ("50", "50", "10:20:30:49"),
    ("59.94", "60000/1001", "00:10:00;59"),
    ("12.5", "25/2", None),
]


@pytest.mark.parametrize(("rate", "lowest", "code"), RATES)
def test_our_reader_reads_them_back(tmp_path, rate, lowest, code):
    """And the file that is written with what was read says the same."""
    path, again = tmp_path / "x.dng", tmp_path / "again.dng"
    sensor = dng_files.sensor()
    mosaic = dng_files.random_mosaic(sensor, (64, 96))
    shot = SHOT | {"frame_rate": rate, "time_code": code or ""}
    write(path, sensor, mosaic, shot=shot)
    read = cg2raw.read_dng_metadata(str(path)).shot
    assert (read["frame_rate"], read["time_code"]) == (lowest, code)
    assert (read["reel_name"], read["camera_label"]) == ("A001", "B")
    place = {name: read[name] or "" for name in SHOT}
    write(again, sensor, mosaic, shot=place)
    assert again.read_bytes() == path.read_bytes()


def test_a_still_s_reader_says_none(tmp_path):
    dng_files.write(tmp_path / "x.dng", dng_files.sensor())
    read = cg2raw.read_dng_metadata(str(tmp_path / "x.dng")).shot
    assert [read[name] for name in SHOT] == [None, None, "", ""]


def test_exiftool_shows_them(frame, program):
    words = ["-j", "-validate", "-warning", "-error", "-IFD0:all"]
    done = dng_files.run(program("exiftool"), *words, frame[0])
    (said,) = json.loads(done.stdout)
    assert said["Validate"] == "OK" and not {"Warning", "Error"} & set(said)
    assert said["FrameRate"] == pytest.approx(24000 / 1001, abs=1e-3)
    assert said["TimeCodes"].startswith("01:02:03.04")
    assert (said["ReelName"], said["CameraLabel"]) == ("A001", "B")


def test_a_still_has_none_of_them(tmp_path):
    path, sensor = tmp_path / "still.dng", dng_files.sensor()
    mosaic = dng_files.random_mosaic(sensor, (64, 96))
    write(path, sensor, mosaic, shot={})
    with tifffile.TiffFile(path) as tiff:
        tags = tiff.pages[0].tags
        assert not {TIME_CODES, FRAME_RATE, REEL_NAME, CAMERA_LABEL} & {
            tag.code for tag in tags
        }
        assert SUB_IFDS in tags


@pytest.mark.parametrize("preview", [None, False, True])
def test_a_preview_if_it_is_asked_for(tmp_path, preview):
    path, sensor = tmp_path / "x.dng", dng_files.sensor()
    write(path, sensor, dng_files.random_mosaic(sensor, (64, 96)), preview=preview)
    with tifffile.TiffFile(path) as tiff:
        assert (SUB_IFDS in tiff.pages[0].tags) == bool(preview)


@pytest.mark.parametrize(
    ("shading", "shot", "tagged"),
    [
        (None, {}, True),
        (None, SHOT, False),
        ("baked", {}, False),
        ("tagged", SHOT, True),
    ],
)
def test_lens_shading_is_baked_in_shots(tmp_path, shading, shot, tagged):
    """The pixels are the same; only the GainMaps that undo it are there or not."""
    sensor = cg2raw.Sensor("gopro-hero6-black")
    grey = np.full((64, 96, 3), 0.3, np.float32)
    raw = sensor.simulate(grey, illuminant="D50")
    cg2raw.write_dng(tmp_path / "x.dng", raw, shading=shading, shot=shot)
    tags = dng_files.tags_of(tmp_path / "x.dng")[1]
    assert ("OpcodeList2" in tags or OPCODE_LIST_2 in tags) == tagged
    with rawpy.imread(str(tmp_path / "x.dng")) as read:
        np.testing.assert_array_equal(read.raw_image, raw)
    assert raw[0, 0] < raw[32, 48]  # what lies in the pixels


@pytest.mark.parametrize("size", SHAPES)
def test_an_uncompressed_frame_is_one_strip(tmp_path, size, program):
    """DaVinci Resolve rejects several (dnglab, issue 368)."""
    path, sensor = tmp_path / "x.dng", dng_files.sensor()
    mosaic = dng_files.random_mosaic(sensor, SHAPES[size])
    write(path, sensor, mosaic, compression="none")
    with tifffile.TiffFile(path) as tiff:
        tags = tiff.pages[0].tags
        assert len(tags["StripOffsets"].value) == 1
        assert tags["StripByteCounts"].value == (2 * mosaic.size,)
        np.testing.assert_array_equal(tiff.pages[0].asarray(), mosaic)
    with rawpy.imread(str(path)) as raw:
        np.testing.assert_array_equal(raw.raw_image, mosaic)
    program("dcraw")
    dn, _ = dng_files.dcraw(path, tmp_path / "dn.tif", "-D", "-4")
    np.testing.assert_array_equal(dn, mosaic)


@pytest.mark.parametrize("cfa", [*BAYER, cameras.X_TRANS])
@pytest.mark.parametrize("compression", ["ljpeg", "none"])
def test_libraw_reads_frames_of_shots(tmp_path, cfa, compression):
    sensor = dng_files.sensor(cfa=cfa, noise=None, black_level=0)
    path = tmp_path / "x.dng"
    mosaic = dng_files.random_mosaic(sensor, SHAPES["odd"])
    write(path, sensor, mosaic, compression=compression)
    with rawpy.imread(str(path)) as raw:
        np.testing.assert_array_equal(raw.raw_image, mosaic)


@pytest.mark.parametrize("cfa", BAYER)
@pytest.mark.parametrize("compression", ["ljpeg", "none"])
@pytest.mark.parametrize("size", ["odd", slow("even")])
def test_ffmpeg_decodes_our_numbers(tmp_path, program, cfa, compression, size):
    """It gives them from black to white over 16 bits, rounded down."""
    path, sensor = tmp_path / "x.dng", dng_files.sensor(cfa=cfa)
    mosaic = dng_files.random_mosaic(sensor, SHAPES[size])
    write(path, sensor, mosaic, compression=compression)
    raw = ["-f", "rawvideo", "-pix_fmt", f"bayer_{cfa.lower()}16le", "-"]
    quiet = ["-v", "error", "-xerror", "-i", path]
    done = dng_files.run(program("ffmpeg"), *quiet, *raw)
    assert done.stderr == b""
    found = np.frombuffer(done.stdout, "<u2").reshape(mosaic.shape)
    black, white = sensor.black_level[0], sensor.white_level
    light = np.clip((mosaic.astype(float) - black) / (white - black), 0.0, 1.0)
    np.testing.assert_allclose(found, light * 65535, atol=1.0)


BAD = [
    ({"frame_rate": "0"}, "24000/1001"),
    ({"frame_rate": "fast"}, 'frame rate "fast"'),
    ({"frame_rate": 24, "time_code": "01:00:00;00"}, "write it 01:00:00:00"),
    ({"frame_rate": 24, "time_code": "01:00:00:24"}, "from 0 to 23"),
    ({"time_code": "an hour"}, "hh:mm:ss:ff"),
    ({"framerate": 24}, "shot has no 'framerate'; known: exposure_time, f_number"),
    ({"iso": 100}, "shot has an iso: give it as the argument iso"),
    ({"f_number": "f/8"}, "shot {'f_number': 'f/8'}: exposure_time, f_number"),
    ({"reel_name": 7}, "a whole number, the others texts"),
]


@pytest.mark.parametrize(("shot", "said"), BAD, ids=str)
def test_a_bad_shot_is_one_line_and_no_file(tmp_path, shot, said):
    path, sensor = tmp_path / "x.dng", dng_files.sensor()
    mosaic = dng_files.random_mosaic(sensor, (64, 96))
    with pytest.raises(ValueError, match="^[^\n]+$") as error:
        write(path, sensor, mosaic, shot=shot)
    assert said in str(error.value) and not path.exists()
