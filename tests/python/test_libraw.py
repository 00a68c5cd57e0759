# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""RAW files through LibRaw: known cameras are found again, the rest is refused."""

import dataclasses
import os
import struct
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest

import cg2raw
from cg2raw.io import libraw
from cg2raw.io.json_text import checked
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from cg2raw.profile import from_raw_files
from cg2raw.profile.from_raw_files import profile_from_raw_files
from python.commands import fails, run, write_dng

# Nikon D1, XYZ to camera for D65, times 10^4. Source: LibRaw 0.22, colordata.cpp.
D1_MATRIX = (7637, -2199, -974, -9109, 17099, 2043, -2822, 3306, 8372)


@pytest.mark.parametrize("cfa", ["RGGB", "GRBG", "GBRG", "BGGR"])
def test_a_known_camera_is_found_again(tmp_path, cfa):
    fields = {"cfa": cfa, "black_level": [60, 64, 68, 72], "white_level": 3880}
    fields["shape"] = (40, 64)
    path = write_dng(tmp_path / "a.dng", "A", **fields)
    file, sensor = from_raw_files.read(path), cg2raw.Sensor("nikon-d40")
    assert (file.make, file.model) == (sensor.make, sensor.model)
    assert (file.cfa, file.shape) == (cfa, (40, 64))
    assert file.black_level == (60, 64, 68, 72) and file.white_level == 3880
    red, _, blue = sensor.illuminant("A").neutral
    assert file.as_shot == pytest.approx((red, 1, blue), abs=1e-4)
    daylight = sensor.calibrations[1]["camera_from_xyz"].ravel()
    np.testing.assert_allclose(file.camera_from_xyz, daylight, atol=1e-4)


@pytest.mark.parametrize("top", [0, 1, 2, 13])
@pytest.mark.parametrize("left", [0, 1, 26])
@pytest.mark.parametrize("side", [2, 6])
def test_the_phase_is_that_of_the_visible_corner(top, left, side):
    repeat = [[0, 1], [3, 2]] if side == 2 else np.arange(36).reshape(6, 6)
    frame = np.tile(repeat, (20, 20))
    raw = SimpleNamespace(
        raw_pattern=frame[:side, :side],
        sizes=SimpleNamespace(top_margin=top, left_margin=left),
        raw_color=lambda row, column: frame[row, column],  # rawpy: of the full frame
    )
    corner = frame[top : top + side, left : left + side]
    assert libraw.corner_of(raw) == corner.ravel().tolist()


def sizes(top, left, height, width, raw_height, raw_width):
    return SimpleNamespace(
        top_margin=top, left_margin=left, height=height, width=width,
        raw_height=raw_height, raw_width=raw_width,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("stored", "side", "expected"),
    [
        (
            sizes(51, 152, 3456, 5184, 3516, 5344),  # as a Canon's, with two borders
            2,
            [("left", 51, 8, 3456, 140), ("top", 9, 152, 38, 5184)],
        ),
        (
            sizes(20, 30, 60, 90, 120, 160),
            6,
            [
                ("left", 20, 12, 60, 12),
                ("right", 20, 126, 60, 24),
                ("bottom", 86, 30, 24, 90),
            ],
        ),
        (sizes(0, 20, 40, 60, 40, 80), 2, [("left", 0, 8, 40, 8)]),
        (sizes(19, 19, 40, 60, 59, 79), 2, []),
        (sizes(0, 0, 40, 60, 40, 60), 2, []),
    ],
)
def test_borders_keep_4_pixels_from_the_picture_and_8_from_the_edge(
    stored, side, expected
):
    """They begin at a repeat of the CFA from the picture's corner, and are whole
    repeats, 8 pixels or more; by hand."""
    active, borders = libraw.areas_of(stored, side)
    picture = stored.top_margin, stored.left_margin, stored.height, stored.width
    assert active == Area("active", *picture)
    assert list(borders) == [Area(*one) for one in expected]


@pytest.mark.parametrize("read", [libraw.dng, libraw.camera_raw])
def test_a_header_says_what_frames_of_one_setting_share(tmp_path, read):
    path, sensor = str(tmp_path / "a.dng"), cg2raw.Sensor("samsung-s20fe")
    raw = sensor.simulate(np.zeros((40, 64, 3)), illuminant="A", iso=400)
    for shot, seconds in (({"exposure_time": 0.25}, 0.25), ({}, None)):
        cg2raw.write_dng(path, raw, shot=shot)
        [file] = read(path)
        header = file.header
        assert (header.make, header.model) == (sensor.make, sensor.model)
        assert (header.bits, header.white_level, header.cfa) == (10, 1023, "GRBG")
        assert (header.iso, header.exposure_time) == (400, seconds)
        assert dict(header.settings) == {
            "make": sensor.make,
            "model": sensor.model,
            "white level": "1023 DN",
        }
        np.testing.assert_array_equal(file.mosaic(), raw)


def example(**changes):
    """Return the header of a camera that does not exist."""
    file = RawHeader(
        "a.nef",
        Area("active", 0, 0, 40, 60),
        make="ACME WORKS",
        model="X 1",
        cfa="RGGB",
        black_level=(10.0, 12.0, 12.0, 10.0),
        white_level=4000,
        camera_from_xyz=tuple(np.array(D1_MATRIX) / 1e4),
        as_shot=(0.5, 1.0, 0.7),
    )
    return dataclasses.replace(file, **changes)


def test_files_of_one_camera_become_its_profile():
    files = [
        example(),
        example(as_shot=(0.6, 1.0, 0.6), black_level=(12.0, 14.0, 14.0, 12.0)),
        example(path="c.nef", as_shot=None),
    ]
    fields, notes = profile_from_raw_files(files)
    profile, _ = checked(fields, "made")
    assert (profile.id, profile.unique_camera_model) == ("acme-x-1", "ACME X 1")
    assert profile.bits == 12 and profile.noise == []
    assert profile.illuminants["neutrals"] == [[0.5, 0.7], [0.6, 0.6]]
    assert profile.black_level == pytest.approx([32 / 3, 38 / 3, 38 / 3, 32 / 3], 1e-4)
    assert [c["light_source"] for c in profile.calibrations] == ["D65"]
    assert any("black levels differ" in note for note in notes)
    assert any("1 of 3 files record no white balance" in note for note in notes)
    for white, bits in ((63, 8), (255, 8), (256, 9)):  # no profile has fewer than 8
        fields, _ = profile_from_raw_files([example(white_level=white)])
        assert fields["bits"] == bits


@pytest.mark.parametrize(
    "change",
    [
        {"model": "X 2"},
        {"white_level": 1023},
        {"cfa": "BGGR"},
        {"active": Area("active", 0, 0, 40, 61)},
    ],
)
def test_files_of_two_cameras_or_modes_are_refused(change):
    with pytest.raises(ValueError, match="b.nef: (model|white_level|cfa|shape) "):
        profile_from_raw_files([example(), example(path="b.nef", **change)])


GAINS = {
    (2.0, 1.0, 1.6, 1.0): (0.5, 1.0, 0.625),
    (512.0, 256.0, 320.0, 0.0): (0.5, 1.0, 0.8),
    (3.0, 1.0, 7.0, 1.0): (0.333333, 1.0, 0.142857),  # as a DNG has them
    (1.0, 1.0, 1.0, 1.0): None,
    (0.0, 0.0, 0.0, 0.0): None,
    (2.0, 1.0, -1.0, 1.0): None,
}


@pytest.mark.parametrize("gains", GAINS)
def test_the_neutral_is_one_over_the_gains(gains):
    assert libraw.neutral_of(gains) == GAINS[gains]


@pytest.mark.parametrize(
    ("lacks", "words"),
    [
        ({"camera_from_xyz": None}, "no colour matrix.*Adobe DNG Converter"),
        ({"model": ""}, "names no camera: give --make and --model"),
    ],
)
def test_a_camera_that_is_not_known_says_so(monkeypatch, lacks, words):
    file = RawFile(example(**lacks), lambda levels: None)
    monkeypatch.setattr(libraw, "camera_raw", lambda path: [file])
    with pytest.raises(ValueError, match=f"a.nef: .*{words}"):
        from_raw_files.read("a.nef")


def test_a_camera_without_mosaic_says_so():
    raw = SimpleNamespace(raw_type=SimpleNamespace(name="Stack"))
    with pytest.raises(ValueError, match="a.nef: holds no mosaic"):
        libraw.fields_of(raw, "a.nef")


def test_a_real_nef(camera_data, tmp_path):
    path, out = camera_data / "real/nikon_d1_imagemeta.nef", tmp_path / "d1.json"
    done = run("profile", path, "-o", out)
    assert done.code == 0 and "no white balance" in done.out
    sensor = cg2raw.Sensor(out)
    assert (sensor.id, sensor.cfa, sensor.bits) == ("nikon-d1", "BGGR", 12)
    assert (sensor.width, sensor.height) == (2012, 1324)
    [calibration] = sensor.calibrations
    np.testing.assert_allclose(
        calibration["camera_from_xyz"].ravel() * 1e4, D1_MATRIX, atol=0.5
    )


@pytest.mark.parametrize("name", ["Nikon.nef", "CanonRaw.cr2"])
def test_files_that_are_only_a_header(camera_data, name, capfd):
    path = camera_data / "real" / "meta_only" / name
    assert f"{name}: LibRaw cannot read it" in fails("profile", path)
    assert capfd.readouterr() == ("", "")  # nor do the libraries speak by themselves


@pytest.mark.parametrize(("stored", "degrees"), [(0, None), (150, 22.0), (122, -6.0)])
def test_the_heat_inside_a_canon(camera_data, program, tmp_path, stored, degrees):
    """Of a real CR2's ShotInfo, whose twelfth number it is; exiftool agrees."""
    data = bytearray((camera_data / "real/meta_only/CanonRaw.cr2").read_bytes())
    numbers = struct.pack("<5H", 0, 224, 96, 192, 125)  # ShotInfo from its first on
    assert data.count(numbers) == 1
    struct.pack_into("<H", data, data.index(numbers) + 2 * (12 - 1), stored)
    path = tmp_path / "a.cr2"
    path.write_bytes(data)
    assert libraw.camera_temperature(path) == degrees
    command = [program("exiftool"), "-s3", "-CameraTemperature", path]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert said.strip() == ("" if degrees is None else f"{degrees:g} C")


def test_no_maker_note_has_no_temperature(tmp_path):
    assert libraw.camera_temperature(write_dng(tmp_path / "a.dng", "A")) is None
    (tmp_path / "b.cr2").write_bytes(b"II*\0" + b"\xff" * 100)
    assert libraw.camera_temperature(tmp_path / "b.cr2") is None


def test_a_dng_that_libraw_crops_otherwise_is_refused(tmp_path, monkeypatch):
    path = write_dng(tmp_path / "a.dng", shape=(64, 96))
    raw = SimpleNamespace(sizes=SimpleNamespace(width=90, height=60))
    monkeypatch.setattr(libraw, "opened", lambda _: nullcontext(raw))
    with pytest.raises(ValueError) as error:
        libraw.dng(str(path))
    assert str(error.value) == (
        f"{path}: its active area is 96x64, LibRaw's 90x60: convert it with Adobe DNG "
        "Converter or dnglab"
    )


def test_threads_read_at_a_time_and_libraries_say_nothing(tmp_path, capfd):
    path = str(write_dng(tmp_path / "one.dng", shape=(64, 96)))
    before = os.listdir("/proc/self/fd")
    inside = threading.Barrier(2, timeout=60)

    def read():
        with libraw.opened(path) as raw:
            inside.wait()  # for the other, who has a file of its own open
            os.write(2, b"noise")
            shape = raw.raw_image.shape
            inside.wait()
        return shape

    with ThreadPoolExecutor(2) as pool:
        shapes = [pool.submit(read) for _ in range(2)]
        assert [shape.result() for shape in shapes] == [(64, 96)] * 2
    assert os.listdir("/proc/self/fd") == before
    os.write(2, b"said again")
    assert capfd.readouterr().err == "said again"


def test_a_progress_bar_is_seen_meanwhile():
    pty = pytest.importorskip("pty")
    terminal, stderr = pty.openpty()
    script = (
        "import os, time\n"
        "from cg2raw.cli._progress import stages\n"
        "from cg2raw.io.libraw import no_words_of_libraries\n"
        "with stages() as progress, no_words_of_libraries():\n"
        "    progress('halfway', 0.5); time.sleep(0.5); os._exit(0)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        stderr=stderr,
        timeout=60,
        env=dict(os.environ, TERM="xterm"),
    )
    os.close(stderr)
    assert done.returncode == 0
    os.set_blocking(terminal, False)
    assert b"halfway" in os.read(terminal, 10_000)
    os.close(terminal)
