# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw convert of shots: which files, what frames say, what is wrong with them."""

import json
import shutil
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
import rawpy
import tifffile

from dng import dng_files
from images import read_dn, write_image
from python import commands

BASE = ["--sensor", "samsung-s20fe", "--illuminant", "D65", "--iso", "1600"]
RATIONAL = oiio.TypeDesc(oiio.INT, oiio.VEC2, oiio.RATIONAL)
FRAMES = range(1001, 1007)
FRAME_RATE, TIME_CODES = 51044, 51043


def write(path, rate=None, code=None):
    """Write a small picture that says a rate (n, d) and a packed time code."""
    typed = [("FramesPerSecond", RATIONAL, rate)] if rate else []
    if code is not None:
        typed.append(("smpte:TimeCode", oiio.TypeTimeCode, (code, 0)))
    pixels = np.full((32, 48, 3), 0.2, np.float32)
    return write_image(path, pixels, typed=typed)


@pytest.fixture
def shot(tmp_path, monkeypatch):
    """Return the current folder, which has the FRAMES of a shot."""
    monkeypatch.chdir(tmp_path)
    first = write(tmp_path / f"shot.{FRAMES[0]}.exr")
    for number in FRAMES[1:]:
        shutil.copy(first, tmp_path / f"shot.{number}.exr")
    return tmp_path


def convert(*words, out="raw"):
    """Run cg2raw convert; return (Done, names of the files in @out)."""
    done = commands.run("convert", *words, "-o", out, *BASE)
    folder = Path(out)
    return done, sorted(p.name for p in folder.iterdir()) if folder.is_dir() else []


def tags(path):
    with tifffile.TiffFile(path) as tiff:
        return {tag.code: tag.value for tag in tiff.pages[0].tags}


NAMES = [f"shot.{number}.dng" for number in FRAMES]


@pytest.mark.parametrize(
    "pattern", ["shot.####.exr", "shot.%04d.exr", "shot.*.exr", "."]
)
def test_all_frames_under_their_names(shot, pattern):
    done, found = convert(pattern, "--framerate", "24")
    assert (done.code, done.err) == (0, "") and found == NAMES
    for name in NAMES:
        assert tags(f"raw/{name}")[FRAME_RATE] == (24, 1)


def test_a_range_and_names_of_outputs(shot):
    done, _ = convert(
        "shot.####.exr", "--frames", "1002-1006x2", out="raw/plate_%05d.dng"
    )
    assert (done.code, done.err) == (0, "")
    names = sorted(path.name for path in (shot / "raw").iterdir())
    assert names == ["plate_01002.dng", "plate_01004.dng", "plate_01006.dng"]


def test_frames_below_0_are_frames_like_others(shot):
    """Frame -1 has a grain of its own, and time codes count from the first."""
    for number in ("-0002", "-0001", "0000", "0001"):
        shutil.copy(shot / "shot.1001.exr", shot / f"pre.{number}.exr")
    words = ["--framerate", "24", "--timecode", "01:00:00:00", "--json"]
    out = "raw/x.####.dng"
    done, _ = convert("pre.####.exr", "--frames", "-1-1", *words, out=out)
    assert (done.code, done.err) == (0, "")
    files = json.loads(done.out)["files"]
    assert [file["frame"] for file in files] == [-1, 0, 1]
    assert [file["time_code"][-2:] for file in files] == ["00", "01", "02"]
    names = [f"raw/x.{number}.dng" for number in ("-0001", "0000", "0001")]
    assert [file["output"] for file in files] == names
    assert len({read_dn(name).tobytes() for name in names}) == 3
    done, _ = convert("pre.####.exr", "--frames=-2--1", out="raw/x####.dng")
    assert done.code == 1 and "would become raw/x-0002.dng" in done.err


def test_time_codes_count_from_the_first_frame(shot):
    words = ["--framerate", "24", "--timecode", "01:00:00:22"]
    done, _ = convert("shot.####.exr", *words, "--json")
    files = json.loads(done.out)["files"]
    codes = [file["time_code"] for file in files]
    assert codes[:3] == ["01:00:00:22", "01:00:00:23", "01:00:01:00"]
    assert {file["frame_rate"] for file in files} == {"24"}
    assert [file["frame"] for file in files] == list(FRAMES)
    (shot / "shot.1001.exr").unlink()
    done, _ = convert("shot.####.exr", *words, "--json", "--frames", "1001-1003")
    files = json.loads(done.out)["files"]
    assert [file["time_code"] for file in files] == codes[1:3]


def test_temporal_noise_differs_and_fixed_patterns_do_not(shot):
    """Of one seed: PRNU is the same in each frame, and noise is that of its number."""
    fields = {"name": "prnu", "parameters": {"sigma": 0.1}}
    profile = dng_files.fields_of("samsung-s20fe") | {"effects": [fields]}
    (shot / "own.json").write_text(json.dumps(profile))
    words = ["--sensor", "own.json", "--illuminant", "D65", "--framerate", "24"]
    for name, more in (("noisy", ["--iso", "1600"]), ("clean", [])):
        done = commands.run("convert", "shot.####.exr", "-o", name, *words, *more)
        assert (done.code, done.err) == (0, "")
    clean = [read_dn(f"clean/{name}").astype(float) for name in NAMES]
    assert all(np.array_equal(frame, clean[0]) for frame in clean)
    assert clean[0].std() > 50
    rest = [read_dn(f"noisy/{a}") - b for a, b in zip(NAMES, clean, strict=True)]
    correlation = np.corrcoef([frame.ravel() for frame in rest])
    # 1536 pixels: five sigma of independent noise.
    assert np.abs(correlation - np.eye(len(rest))).max() < 5 / np.sqrt(1536)


def test_any_number_of_workers_writes_the_same(shot):
    for count in (1, 3):
        words = ["--framerate", "24", "--workers", count]
        done, _ = convert("shot.####.exr", *words, out=f"raw{count}")
        assert (done.code, done.err) == (0, "")
        assert [line.split(":")[0][-13:] for line in done.out.splitlines()] == NAMES
    for name in NAMES:
        one, three = (shot / f"raw{n}" / name for n in (1, 3))
        assert one.read_bytes() == three.read_bytes()


def test_gaps_and_duplicates_are_listed_and_the_rest_is_done(shot):
    (shot / "shot.1003.exr").unlink()
    shutil.copy("shot.1005.exr", "shot.01005.exr")
    (shot / "shot.1006.exr").write_text("no image")
    done, found = convert("shot.*.exr", "--framerate", "24", "--frames", "1001-1008")
    assert done.code == 1 and found == [NAMES[n] for n in (0, 1, 3)]
    assert len(done.err.splitlines()) == 3
    assert "shot.#.exr: frames 1003, 1007-1008 are missing" in done.err
    assert "shot.01005.exr: is frame 1005, as shot.1005.exr is" in done.err
    assert "shot.1006.exr: " in done.err
    done, _ = convert("shot.%04d.exr", "--json")
    assert done.code == 1
    (missing, _) = json.loads(done.out)["errors"]
    assert missing["error"] == "shot.#.exr: frame 1003 is missing"


def test_the_rate_of_the_files(shot):
    for number in FRAMES:
        write(shot / f"shot.{number}.exr", (24000, 1001), 0x01000000 + number - 1001)
    done, _ = convert("shot.####.exr", "--timecode", "02:00:00:00")
    assert (done.code, done.err) == (0, "")
    found = tags("raw/shot.1002.dng")
    assert found[FRAME_RATE] == (24000, 1001)
    assert found[TIME_CODES][:4] == bytes([1, 0, 0, 2])
    done, _ = convert("shot.####.exr")
    assert tags("raw/shot.1002.dng")[TIME_CODES][:4] == bytes([1, 0, 0, 1])
    write(shot / "shot.1004.exr", (25, 1))
    (line,) = convert("shot.####.exr", out="two")[0].err.splitlines()
    assert "24000/1001 in shot.1001.exr (and 4 more files), 25 in shot.1004" in line
    assert not (shot / "two").exists()
    done, _ = convert("shot.####.exr", "--framerate", "24")
    assert (done.code, done.err) == (0, "")


def test_dropped_numbers_at_24_are_one_line(shot):
    for number in FRAMES:
        write(shot / f"shot.{number}.exr", None, 0x01000040 + number - 1001)
    done, found = convert("shot.####.exr", "--framerate", "24")
    (line,) = done.err.splitlines()
    assert done.code == 1 and found == []
    assert "shot.1001.exr: time code 01:00:00;00 drops frame numbers" in line
    assert "(and 5 more files)" in line
    done, _ = convert("shot.####.exr", "--framerate", "29.97")
    assert (done.code, done.err) == (0, "")
    assert tags("raw/shot.1002.dng")[TIME_CODES][:4] == bytes([0x41, 0, 0, 1])


def test_a_layer_that_is_not_there_is_one_line(shot):
    done, found = convert("shot.####.exr", "--layer", "sss")
    (line,) = done.err.splitlines()
    assert done.code == 1 and found == []
    assert "--layer sss: no layer of that name" in line and "5 more files" in line


BAD = [
    (["shot.####.exr", "--framerate", "fast"], "--framerate: frame rate"),
    (["shot.####.exr", "--timecode", "01:00:00:00"], "--framerate 24"),
    (
        ["shot.####.exr", "--framerate", "24", "--timecode", "01:00:00;00"],
        "drops frame",
    ),
    (["shot.####.exr", "--framerate", "24", "--timecode", "1"], "hh:mm:ss:ff"),
    (["shot.####.exr", "--frames", "9-1"], "--frames: 9-1"),
    (["shot.####.exr", "--frames", "1-4"], "--frames 1-4: no file has one"),
    (["still.exr", "--frames", "1-4"], "still.exr has no frame number"),
    (["plate.####.exr"], "plate.####.exr: no file"),
]


@pytest.mark.parametrize(("words", "said"), BAD, ids=str)
def test_errors_are_one_line_and_leave_nothing(shot, words, said):
    line = commands.fails("convert", *words, "-o", "raw", *BASE)
    assert said in line and not (shot / "raw").exists()


@pytest.mark.parametrize("compression", ["ljpeg", "none"])
def test_ffmpeg_plays_the_sequence(shot, program, compression):
    """It numbers frames from the first; their rate is asked of the player, which does
    not read FrameRate."""
    words = ["--framerate", "24", "--compression", compression]
    done, _ = convert("shot.####.exr", *words)
    assert done.code == 0, done.err
    words = ["-v", "error", "-count_frames", "-show_streams", "-of", "json"]
    first = ["-framerate", "24", "-start_number", "1001", "-i", "raw/shot.%04d.dng"]
    done = dng_files.run(program("ffprobe"), *words, *first)
    (stream,) = json.loads(done.stdout)["streams"]
    assert stream["nb_read_frames"] == "6" and stream["r_frame_rate"] == "24/1"
    assert (stream["width"], stream["height"]) == (48, 32)
    assert stream["pix_fmt"] == "bayer_grbg16le"
    movie = ["-c:v", "ffv1", "-pix_fmt", "rgb48le", "movie.mkv"]
    dng_files.run(program("ffmpeg"), "-v", "error", "-xerror", *first, *movie)
    done = dng_files.run(program("ffprobe"), *words, "movie.mkv")
    (stream,) = json.loads(done.stdout)["streams"]
    assert stream["nb_read_frames"] == "6" and stream["r_frame_rate"] == "24/1"


def test_libraw_and_exiftool_read_every_frame(shot, program):
    convert("shot.####.exr", "--framerate", "24", "--timecode", "01:00:00:00")
    for name in NAMES:
        with rawpy.imread(f"raw/{name}") as raw:
            assert raw.raw_image.shape == (32, 48)
    paths = [f"raw/{name}" for name in NAMES]
    done = dng_files.run(program("exiftool"), "-j", "-FrameRate", "-TimeCodes", *paths)
    said = json.loads(done.stdout)
    assert [file["FrameRate"] for file in said] == [24] * len(NAMES)
    assert [file["TimeCodes"][:11] for file in said] == [
        f"01:00:00.{number:02}" for number in range(len(NAMES))
    ]
