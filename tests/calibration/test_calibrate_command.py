# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw calibrate: from files to a profile and a page."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from calibration.planted import GAIN, RANGE, frames_of, sensor_of
from cg2raw import write_dng
from cg2raw.calibration import UniformFrame
from cg2raw.cli._frame_table import read_frame_table
from cg2raw.cli._uniform_frames import Said, files_in, kind_of, uniform_frame
from cg2raw.cli.calibrate import gain_notes
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from cg2raw.statistics.kept import Kept
from python.commands import fails, run

EFFECTS = {"dsnu": {"sigma": 2 / RANGE}, "prnu": {"sigma": 0.01}}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Return a folder with my.json, frames.csv, biases/, darks/ and flats/ of .npy,
    and all.npz."""
    folder = tmp_path_factory.mktemp("frames")
    sensor = sensor_of(EFFECTS, shape=(96, 128))
    (folder / "my.json").write_text(sensor_of(shape=(96, 128)).to_json())
    lines, stored = ["frame,exposure_s,temperature_c"], {}
    for frame in frames_of(sensor, biases=3, darks=3, flats=3):
        place = folder / ("biases" if not frame.exposure_time else f"{frame.kind}s")
        place.mkdir(exist_ok=True)
        stored[frame.name] = frame.pixels()
        np.save(place / f"{frame.name}.npy", stored[frame.name])
        lines.append(f"{frame.name},{frame.exposure_time},20.0")
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
    np.savez(folder / "all.npz", **stored)
    return folder


def command(files, *frames, **options):
    """Run cg2raw calibrate on some of the files."""
    options = {"frames": files / "frames.csv", "sensor": files / "my.json"} | options
    words = [w for k, v in options.items() if v for w in (f"--{k}", v)]
    return run("calibrate", *frames, "--iso", 100, *words)


def test_a_profile_is_written_over_its_own(files, tmp_path):
    mine = tmp_path / "my.json"
    mine.write_bytes((files / "my.json").read_bytes())
    done = command(files, files / "biases", files / "flats", sensor=mine, output=mine)
    assert done.code == 0, done.err
    assert "temporal dark noise" in done.out and "e-/DN" in done.out
    profile = json.loads(mine.read_text())
    assert [e["name"] for e in profile["effects"]] == ["dsnu", "prnu"]
    assert profile["noise"][0]["beta1"][0] * RANGE == pytest.approx(1 / GAIN, rel=0.1)
    assert "calibrate" in profile["sources"]["noise"]


def test_an_npz_of_all_frames_gives_the_same(files, tmp_path):
    shown = [*(files / "biases").iterdir(), *(files / "flats").iterdir()]
    np.savez(tmp_path / "all.npz", **{path.stem: np.load(path) for path in shown})
    first = command(files, files / "biases", files / "flats", output="-")
    second = command(files, tmp_path / "all.npz", output="-")
    assert first.code == second.code == 0, first.err + second.err
    assert json.loads(first.out)["noise"] == json.loads(second.out)["noise"]


def test_numbers_for_programs_and_a_page(files, tmp_path):
    done = run(
        "calibrate", files / "all.npz", "--frames", files / "frames.csv", "--json",
        "-s", files / "my.json", "--iso", 100, "--report", tmp_path / "page",
    )  # fmt: skip
    assert done.code == 0, done.err
    by_name = {row["name"]: row for row in json.loads(done.out)["numbers"]}
    assert by_name["gain"]["value"]["value"] == pytest.approx(GAIN, rel=0.05)
    assert by_name["saturation"]["value"] is None
    page = (tmp_path / "page" / "calibration.html").read_text()
    for words in (
        "Photon transfer",
        "Signal to noise",
        "Dark current",
        "Bias profiles",
    ):
        assert words in page
    # Curves: five, of which the bias has two; maps: bias, dark current, PRNU, shading.
    assert page.count("<svg ") == 6 and page.count("<img ") == 4
    assert "#5a9216" in page and ">Gb<" in page  # sites have their colours and names
    assert "<script" not in page and len(page) < 500_000


def test_dngs_say_their_own_exposure_and_iso(tmp_path):
    sensor = sensor_of(shape=(96, 128))
    for number in range(4):
        light = np.full((96, 128, 3), 0.3 * (number > 1), np.float32)
        raw = sensor.simulate(
            light, illuminant="neutral:1:1", iso=100, frame=number, seed=3,
            convention="sensor", camera_input=True, exposure_time=0.5,
        )  # fmt: skip
        write_dng(tmp_path / f"{number}.dng", raw)
    (tmp_path / "my.json").write_text(sensor.to_json())
    done = run("calibrate", tmp_path, "-s", tmp_path / "my.json", "-o", "-")
    assert done.code == 0, done.err
    row = json.loads(done.out)["noise"][0]
    assert row["iso"] == 100
    assert row["beta1"][0] * RANGE == pytest.approx(1 / GAIN, rel=0.1)


def test_what_is_wrong_is_said_in_one_line(files, tmp_path):
    mine, table = files / "my.json", tmp_path / "frames.csv"
    assert "give darks and flats" in fails("calibrate", "-s", mine)
    assert "holds no frames" in fails("calibrate", tmp_path, "-s", mine)
    assert "must end in .json" in fails("calibrate", files, "-s", mine, "-o", "x.txt")
    table.write_text("frame,exposure_s\nother,1\n")
    words = fails("calibrate", files / "darks", "-s", mine, "--frames", table)
    assert "names none of the frames" in words
    np.save(tmp_path / "eight.npy", np.zeros((96, 128), np.uint8))
    assert "uint16" in fails("calibrate", tmp_path / "eight.npy", "-s", mine)
    faint = np.full((96, 128), 256 + 0.02 * RANGE, np.uint16)
    np.save(tmp_path / "faint.npy", faint)
    assert "Say it: --darks" in fails("calibrate", tmp_path / "faint.npy", "-s", mine)


def fits_files(files, folder, header_of):
    """Write the frames of a folder as FITS, with what header_of says of a number."""
    fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")
    for number, path in enumerate(sorted(files.glob("*s/*.npy"))):
        image = fits.PrimaryHDU(np.load(path))
        image.header.update(header_of(number))
        image.writeto(folder / f"{path.stem}.fits")


@pytest.mark.parametrize(
    ("header_of", "words"),
    [
        (
            lambda n: {"EGAIN": 1 if n < 6 else 2.5},
            "flat-6.fits: its EGAIN is 2.5, that of {}/dark-0.fits is 1: ",
        ),
        (
            lambda n: {"GAIN": 120 if n % 2 else 40},
            "GAIN is 120, that of {}/dark",
        ),
        (lambda n: {"ISOSPEED": 100 + 700 * (n > 7)}, "ISOSPEED is 800, that of {}/da"),
        (lambda n: {"OFFSET": n}, "its OFFSET is 1, that of {}/dark-0.fits is 0: "),
        (lambda n: {"ISOSPEED": 800}, "dark-0.fits: its ISO is 800, --iso 100: leave"),
    ],
)
def test_frames_of_two_settings_are_refused(files, tmp_path, header_of, words):
    fits_files(files, tmp_path, header_of)
    words = words.format(tmp_path)
    assert words in fails("calibrate", tmp_path, "-s", files / "my.json", "--iso", 100)


def test_what_the_reader_says_of_a_file_reaches_the_user(files, tmp_path):
    fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")
    for path in [*(files / "biases").iterdir(), *(files / "flats").iterdir()]:
        images = [fits.PrimaryHDU(), fits.ImageHDU(np.load(path) + np.uint16(7))]
        images[1].header.update({"PEDESTAL": -7, "EGAIN": 2 * GAIN})
        fits.HDUList([*images, fits.ImageHDU(np.load(path))]).writeto(
            tmp_path / f"{path.stem}.fit"
        )
    words = "dark-0.fit: holds 2 images: 1 (128x96), 2 (128x96); choose one (--image 2)"
    assert words in fails("calibrate", tmp_path, "-s", files / "my.json")
    done = command(files, tmp_path, image="1")
    assert done.code == 0, done.err
    assert "dark-0.fit, dark-1.fit, dark-2.fit and 3 more: a PEDESTAL of 7" in done.out
    assert f"headers say {2 * GAIN:g} electrons per DN (dark-0.fit the" in done.out


def test_png_files_of_a_folder_are_frames_if_there_are_no_others(tmp_path):
    for name in ("a.png", "b.PNG", "notes.txt", "c.jpg"):
        (tmp_path / name).touch()
    assert files_in([str(tmp_path)]) == [str(tmp_path / n) for n in ("a.png", "b.PNG")]
    (tmp_path / "a.dng").touch()
    assert files_in([str(tmp_path)]) == [str(tmp_path / "a.dng")]


def test_a_row_of_a_table_is_of_all_frames_in_a_file():
    header = RawHeader("x/a.tif", Area("active", 0, 0, 4, 4), frame="a.tif[1]")
    file = RawFile(header, lambda levels: np.zeros((4, 4), np.uint16))
    for name in ("a", "a.tif", "a.tif[1]"):
        table = {name: Said(exposure_time=3.0)}
        found = uniform_frame(file, sensor_of(), table, Said(kind="dark"), Kept())
        assert (found.name, found.exposure_time) == ("a.tif[1]", 3.0)


def test_a_file_says_before_its_table_and_that_before_the_command_line():
    header = RawHeader("a.dng", Area("active", 0, 0, 4, 4), exposure_time=2.0)
    file = RawFile(header, lambda levels: np.zeros((4, 4), np.uint16))
    table = {"a.dng": Said(exposure_time=3.0, iso=200, kind="flat")}
    given = Said(exposure_time=4.0, iso=400, temperature=20.0)
    found = uniform_frame(file, sensor_of(), table, given, Kept())
    said = found.exposure_time, found.iso, found.temperature, found.kind
    assert said == (2.0, 200, 20.0, "flat")
    found = uniform_frame(file, sensor_of(), table, Said(kind="dark"), Kept())
    assert found.kind == "dark"


@pytest.mark.parametrize(
    ("stated", "measured", "is_said"),
    [(None, 2.0, False), (2.0, None, False), (2.09, 2.0, False), (1.89, 2.0, True)],
)
def test_a_gain_of_headers_is_compared_with_the_measured_one(stated, measured, is_said):
    area = Area("active", 0, 0, 4, 4)
    headers = [
        RawHeader("a.fits", area),
        RawHeader("b.fits", area, electrons_per_dn=stated),
    ]
    gain = measured and SimpleNamespace(value=measured)
    found = SimpleNamespace(figure=lambda name: gain)
    assert gain_notes(headers, found) == is_said * [
        "gain: headers say 1.89 electrons per DN (b.fits the first), the frames 2: "
        "what was measured is used"
    ]


def test_a_table_says_what_files_do_not(tmp_path):
    """Exposure in s, temperature in degrees Celsius; an empty cell says nothing."""
    table = tmp_path / "frames.csv"
    rows = ["dark-0,0,-273.15,", "flat-0,1e6,200,FLAT", "a,,,dark"]
    table.write_text("\n".join(["frame,exposure_s,temperature_c,kind", *rows]))
    assert read_frame_table(str(table)) == {
        "dark-0": Said(exposure_time=0.0, temperature=-273.15),
        "flat-0": Said(exposure_time=1e6, temperature=200.0, kind="flat"),
        "a": Said(kind="dark"),
    }


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("frame\na", "has no column exposure_s; the first row must name the columns"),
        ("exposure_s\n1", "has no column frame; the first row must name the columns"),
        ("frame,exposure_s\na,minus one", ':2: exposure_s is "minus one"'),
        ("frame,exposure_s\na,-1", r':2: exposure_s is "-1"; .* from 0 to 1e\+06,'),
        (
            "frame,exposure_s,temperature_c\na,1,-300",
            ':2: temperature_c is "-300"; must be a finite number from -273.15 to 200',
        ),
        ("frame,exposure_s\na,1\na,2", ":3: frame a is there twice"),
        (
            "frame,exposure_s,kind\na,1,bias",
            ':2: kind is "bias"; must be dark, flat or empty',
        ),
    ],
)
def test_a_table_that_is_no_good_is_refused(tmp_path, lines, words):
    table = tmp_path / "frames.csv"
    table.write_text(lines)
    with pytest.raises(ValueError, match=f"frames.csv:?.*{words}"):
        read_frame_table(str(table))


@pytest.mark.parametrize(
    ("seconds", "share", "kind"),
    [(None, 0.009, "dark"), (1.0, 0.031, "flat"), (0.0, 0.5, "dark"), (1.0, 0.02, "")],
)
def test_a_frame_is_dark_or_flat_by_its_median_over_black(seconds, share, kind):
    """Rows of stars, or of hot pixels, make no flat of a dark."""
    sensor = sensor_of()
    raw = np.full((40, 60), sensor.black_level[0] + share * sensor.signal_range)
    raw[:15] = sensor.white_level
    frame = UniformFrame("a", "dark", lambda: raw.astype(np.uint16), seconds)
    if kind:
        assert kind_of(frame, sensor) == kind
    else:
        with pytest.raises(ValueError, match="a: its level is 2.0% of white: a long"):
            kind_of(frame, sensor)
