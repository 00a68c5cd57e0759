# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Noise differs from frame to frame of a shot, and is the same in the same frame."""

import numpy as np

import cg2raw
from images import attributes, read_dn
from python import commands

RUN = {"sensor": "samsung-s20fe", "illuminant": "D65", "iso": 1600}
NOISY = attributes(**RUN)


def frame(scene, number):
    """Return the DN of a frame."""
    run = {"illuminant": "D65", "iso": 1600, "frame": number}
    return np.asarray(cg2raw.Sensor("samsung-s20fe").simulate(scene, **run))


def test_frames_of_a_sequence_differ(oiiotool, exr, scene, tmp_path):
    for number in (8, 9, 10):
        (tmp_path / f"in.{number:04}.exr").write_bytes(exr.read_bytes())
    arguments = ["--frames", "8-10", tmp_path / "in.#.exr", *NOISY]
    oiiotool(*arguments, "-o", tmp_path / "out.#.dng")
    files = [tmp_path / f"out.{number:04}.dng" for number in (8, 9, 10)]
    for number, file in zip((8, 9, 10), files, strict=True):
        np.testing.assert_array_equal(read_dn(file), frame(scene, number))
    before = [file.read_bytes() for file in files]
    assert len(set(before)) == 3
    oiiotool(*arguments, "-o", tmp_path / "out.#.dng")
    assert [file.read_bytes() for file in files] == before
    words = [word for name, value in RUN.items() for word in (f"--{name}", value)]
    inputs = sorted(tmp_path.glob("in.*.exr"))
    done = commands.run("convert", *inputs, "-o", tmp_path / "command", *words)
    assert (done.code, done.err) == (0, "")
    again = sorted((tmp_path / "command").iterdir())
    assert [file.read_bytes() for file in again] == before


def test_frames_below_0(oiiotool, exr, scene, tmp_path):
    out = tmp_path / "out.-007.dng"
    oiiotool(exr, *NOISY, "-o", out)
    np.testing.assert_array_equal(read_dn(out), frame(scene, -7))
    oiiotool(exr, *NOISY, *attributes(frame=-8), "-o", out)
    np.testing.assert_array_equal(read_dn(out), frame(scene, -8))


def test_a_dng_is_raw_already(oiiotool, exr, tmp_path):
    """Where OpenImageIO has LibRaw, our reader is that of the extension cg2raw."""
    dng, out = tmp_path / "a.cg2raw", tmp_path / "b.dng"
    oiiotool(exr, *NOISY, "-o", tmp_path / "a.dng")
    (tmp_path / "a.dng").rename(dng)
    done = oiiotool(dng, *NOISY, "-o", out, check=False)
    said = done.stdout + done.stderr
    assert done.returncode != 0 and "RAW already" in said and "develop" in said
    assert not out.exists() and "chnames" not in said
    words = ["-o", out, "--sensor", "nikon-d40", "--illuminant", "D65"]
    converted = commands.run("convert", dng, *words)
    assert converted.code == 1 and "develop it first" in converted.err


def test_a_time_code_is_a_frame_number(oiiotool, exr, scene, tmp_path):
    code = ["--attrib:type=timecode", "smpte:TimeCode", "01:02:03:04"]
    out, numbered = tmp_path / "shot.dng", tmp_path / "shot.0007.dng"
    oiiotool(exr, *code, *NOISY, "-o", out, "-o", numbered)
    np.testing.assert_array_equal(read_dn(out), frame(scene, 1020304))
    np.testing.assert_array_equal(read_dn(numbered), frame(scene, 7))
