# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files that do not belong together are refused; what they cannot tell is said."""

import shutil
from types import SimpleNamespace

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose.captures.consistency import dn_per_electron, gain_notes
from cg2raw.diagnose.captures.reader import read_captures
from diagnose import capture_files as files
from dng import dng_files


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder of frames and of files that are none, or of another kind."""
    folder = tmp_path_factory.mktemp("files")
    for name in ("a.npy", "b.npy"):
        files.frame(folder, name, frame=ord(name[0]))
    files.frame(folder, "a.dng")
    shutil.copy(folder / "a.npy", folder / "copy.npy")
    np.save(folder / "small.npy", np.zeros((4, 4), np.uint16))
    np.save(folder / "float.npy", np.zeros((48, 64), np.float32))
    np.save(folder / "small_render.npy", np.zeros((8, 8, 3), np.float32))
    np.save(folder / "two_rows.npy", np.zeros((2, 64), np.uint16))
    np.save(folder / "three_columns.npy", np.zeros((48, 3), np.uint16))
    (folder / "text.npy").write_text("no array")
    (folder / "cut.dng").write_bytes((folder / "a.dng").read_bytes()[:300])
    (folder / "text.nef").write_text("no RAW")
    dng_files.write(folder / "bggr.dng", files.other_sensor(cfa="BGGR"))
    dng_files.write(folder / "bits.dng", files.other_sensor(bits=14, white_level=16000))
    dng_files.write(folder / "white.dng", files.other_sensor(white_level=900))
    return folder


def dark(name, more=""):
    return f"{{file: {name}, kind: dark{more}}}"


A, TOP = dark("a.npy"), f"sensor: {files.SENSOR}"
CHART = "file: a.dng, kind: chart"
CHECKER = f"{CHART}, chart: colorchecker, corners"
# Lines of frames, words of the message (...: and others), and the manifest's top.
BAD = [
    ([A, dark("./a.npy")], ":4: frames[1].file ... is that of line 3", TOP),
    ([A, dark("copy.npy")], ":4: frames[1].file ... has the bytes of that", TOP),
    ([dark("two_rows.npy")], "two_rows.npy is 64x2; frames must be at least 4 p", TOP),
    ([dark("three_columns.npy")], ":3: frames[0].file three_columns.npy is 3x48;", TOP),
    ([A, dark("small.npy")], "small.npy is 4x4, a.npy 64x48; all frames", TOP),
    ([dark("float.npy")], "float.npy: raw must be (H, W) uint16", TOP),
    ([dark("text.npy")], "text.npy: is no .npy file, or cut off", TOP),
    ([dark("cut.dng")], ":3: frames[0].file cannot be used", TOP),
    ([dark("text.nef")], "text.nef: LibRaw cannot read it", TOP),
    ([dark("bggr.dng")], "its CFA is BGGR, that of samsung-s20fe", TOP),
    ([dark("bits.dng")], "bits.dng: its bit depth is 14, that of", TOP),
    ([dark("white.dng")], "say white level 900 DN, samsung-s20fe 1023 DN", TOP),
    (["{file: a.dng, kind: scene, scene: small_render.npy}"],
     "[0].scene small_render.npy is 8x8, the frames are 64x48; it must", TOP),
    (["{file: a.dng, kind: scene, scene: text.nef}"],
     "frames[0].scene cannot be used", TOP),
    ([dark("a.npy", ", mask: small.npy")], "[0].mask small.npy is 4x4, the", TOP),
    ([A], "captures.yaml:2: mask small.npy is 4x4, the", f"{TOP}\nmask: small.npy"),
    ([dark("a.npy", ", illuminant: sunny")], 'illuminant is "sunny":', TOP),
    ([dark("a.npy", ", iso: 9e6")], "iso 9e+06, of a.npy:", TOP),
    ([dark("a.npy", ", set: s"), "{file: a.dng, kind: flat, scene: 1, set: s}"],
     ':4: frames[1].set "s" holds a flat here and a dark in line 3', TOP),
    ([dark("a.npy", ", set: s, group: fit"), dark("b.npy", ", set: s, group: report")],
     ':4: frames[1].group is "report", but that of set "s" in line 3 is "fit"', TOP),
    ([dark("a.npy", ", group: fit"), dark("b.npy", ", group: select")],
     'leaves no frame for the group "report"', TOP),
    ([A], 'captures.yaml:1: sensor is "nikon"', "sensor: nikon"),
    ([A], 'sensor is "./x.json"', "sensor: ./x.json"),
    ([A], 'sensor is "cut.dng"', "sensor: cut.dng"),
    ([f"{{{CHART}, patches: [{{area: [44, 0, 8, 8], xyz: [1,1,1]}}]}}"],
     "patches[0].area ends at row 52, column 8; the frame has 48 rows", TOP),
    ([f"{{{CHECKER}: [[1, 1], [1, 99], [30, 60], [30, 1]]}}"],
     "corners: [1, 99] is outside the frame", TOP),
    ([f"{{{CHECKER}: [[1, 1], [30, 60], [1, 60], [30, 1]]}}"],
     "corners: are no quadrangle", TOP),
    ([f"{{{CHECKER}: [[1, 1], [1, 60], [10, 10], [40, 1]]}}"],  # not convex
     "corners: are no quadrangle", TOP),
]  # fmt: skip


@pytest.mark.parametrize(("lines", "words", "top"), BAD, ids=range(len(BAD)))
def test_files_that_do_not_belong_together(folder, lines, words, top):
    path = files.manifest(folder, lines, top)
    with pytest.raises(ValueError) as error:
        read_captures(path)
    message = str(error.value)
    assert message.startswith(str(path)) and "\n" not in message
    assert all(word in message for word in words.split("..."))


def test_levels_that_differ_a_little_are_noted(tmp_path):
    dng_files.write(tmp_path / "a.dng", files.other_sensor(black_level=[66] * 4))
    captures = read_captures(files.manifest(tmp_path, ["{file: a.dng, kind: dark}"]))
    [note] = [note for note in captures.notes if "black level" in note]
    assert "say black level 66 DN, samsung-s20fe 64 DN" in note


def test_an_iso_that_is_not_the_file_s_is_noted(tmp_path):
    lines = []
    for index in range(3):
        files.frame(tmp_path, f"{index}.dng", frame=index)  # of ISO 100
        iso = "200" if index else "100"
        lines.append(f"{{file: {index}.dng, kind: dark, iso: {iso}}}")
    words = "1.dng, 2.dng: the file says ISO 100, the manifest 200, which is used"
    assert words in read_captures(files.manifest(tmp_path, lines)).notes


def test_frames_of_one_iso_have_one_setting(tmp_path):
    fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")
    for index, gain in enumerate((120, 120, 40)):
        image = fits.PrimaryHDU(files.frame(tmp_path, "raw.npy", frame=index))
        image.header["GAIN"] = gain
        image.writeto(tmp_path / f"{index}.fits")
    lines = [f"{{file: {n}.fits, kind: dark, iso: {100 + n // 2}}}" for n in range(3)]
    assert read_captures(files.manifest(tmp_path, lines)).captures
    words = r":5: frames\[2\].file .*2.fits: its GAIN is 40, that of .*0.fits is 12"
    with pytest.raises(ValueError, match=words):
        read_captures(
            files.manifest(tmp_path, [w.replace("101", "100") for w in lines])
        )


LIGHT = "exposure_time: 1"
FLAT = "kind: flat, illuminant: A, scene"


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        ([f"kind: dark, {LIGHT}"] * 3, ["only darks"]),
        ([f"{FLAT}: 1"], ["one frame only", "no darks", "no scenes", "flats of one"]),
        ([f"{FLAT}: 1", f"{FLAT}: 2"], ["no darks", "no scenes"]),
        ([f"{FLAT}: unknown"] * 2, ["no darks", "no scenes"]),
        (
            [f"kind: dark, {LIGHT}"] * 2 + [f"{FLAT}: 1"] * 2,
            ["darks of one exposure time", "no scenes", "flats of one level"],
        ),
        (
            ["kind: dark, exposure_time: 9", f"kind: dark, {LIGHT}"]
            + ["kind: scene, scene: r.npy, illuminant: A"],
            [],
        ),
    ],
)
def test_what_captures_cannot_tell_is_said(tmp_path, frames, words):
    np.save(tmp_path / "r.npy", files.picture())
    fields = [f"iso: 100, {words}" for words in frames]
    notes = files.read_series(tmp_path, fields).notes
    notes = [n for n in notes if "divided" not in n and "optical centre" not in n]
    assert len(notes) == len(words)
    for note, word in zip(notes, words, strict=True):
        assert note.startswith(word)


@pytest.mark.parametrize(
    ("degrees", "words"),
    [
        ((-5.0, -4.82), None),
        ((-5.0, -3.5), None),  # 1.5 C exactly
        ((None, -5.0), None),
        ((0.5, 0.0, 3.0), "at 0 C in 1.npy and at 3 C in 2.npy: dark current, which"),
        # 2 to the power of 7 / 7 and of 7 / 5
        ((20.0, None, 27.0, 24.0), "at 20 C in 0.npy and at 27 C in 2.npy: dark current"
         ", which doubles every 5 to 7 C, is 2 to 2.64 times as large there"),
    ],
)  # fmt: skip
def test_a_sensor_that_warmed_up_is_said(tmp_path, degrees, words):
    said = ["" if warm is None else f", temperature: {warm}" for warm in degrees]
    notes = files.read_series(tmp_path, ["kind: dark" + words for words in said]).notes
    told = [note for note in notes if "the sensor was at" in note]
    assert bool(told) == bool(words)
    assert not words or words in told[0]


@pytest.mark.parametrize(("share", "notes"), [(1.0, 0), (1.3, 1), (0.7, 1)])
def test_a_gain_in_headers_that_the_profile_has_not_is_said(share, notes):
    sensor = cg2raw.Sensor(files.SENSOR)
    told = share / dn_per_electron(sensor, files.ISO)
    frame = SimpleNamespace(
        header=SimpleNamespace(electrons_per_dn=told),
        capture=SimpleNamespace(iso=files.ISO, name="a.fits"),
    )
    assert len(gain_notes([frame], sensor)) == notes
