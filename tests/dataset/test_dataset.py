# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The same options and images are the same bytes, whoever makes them and how often."""

import fcntl
import shutil
from types import SimpleNamespace

import numpy as np
import pytest
import rawpy

import cg2raw
from cg2raw.dataset.plan import Plan
from dataset.data_sets import (
    FILES,
    OPTIONS,
    check_agreement,
    contents,
    rows,
    scene,
    write_image,
)
from python.commands import fails, run

NOISY = "--sensors samsung-s20fe --illuminants A,sample:3 --iso clean,800".split()


@pytest.fixture
def copy(images, tmp_path):
    """Return a copy of the images that may be altered."""
    return shutil.copytree(images, tmp_path / "in")


def make(images, out, *options):
    """Make a data set that must succeed; return what was printed."""
    done = run("dataset", images, out, *(options or OPTIONS))
    assert (done.code, done.err) == (0, ""), done
    return done.out


def test_number_of_workers_decides_no_byte(images, tmp_path):
    run("dataset", images, tmp_path / "one", *NOISY, "--workers", "1")
    run("dataset", images, tmp_path / "two", *NOISY, "--workers", "2")
    assert contents(tmp_path / "one") == contents(tmp_path / "two")
    check_agreement(tmp_path / "one")
    assert len(rows(tmp_path / "one")) == 5 * 4


def test_order_of_images_decides_no_byte(images, tmp_path):
    files = sorted(images.rglob("*.exr"))
    for name, order in (("up", files), ("down", files[::-1])):
        assert run("dataset", *order, tmp_path / name, *NOISY).code == 0
    assert contents(tmp_path / "up") == contents(tmp_path / "down")


def test_folders_are_called_as_images_and_not_as_their_files(tmp_path):
    names = ("a.exr", "night.v2.exr", "street/day.0001.EXR", "lamp.tif", "a/b.exr")
    for number, name in enumerate(names):
        write_image(tmp_path / "in" / name.lower(), scene(seed=number))
    (tmp_path / "in/street/day.0001.exr").rename(tmp_path / "in/street/day.0001.EXR")
    make(tmp_path / "in", tmp_path / "out", *NOISY)
    found = {row["input"]: row["path"] for row in rows(tmp_path / "out")}
    assert all((tmp_path / "out" / path).is_file() for path in found.values())
    folders = {name: path.rpartition("/")[0] for name, path in found.items()}
    assert folders == {name: name[:-4] for name in names}


@pytest.mark.parametrize(
    ("words", "curve"),
    [("", True), ("--linearize srgb", True), ("--iscolorspace lin_rec709", False)],
)
def test_whole_numbers_are_what_is_said_of_them(tmp_path, words, curve):
    """Where the file says nothing (a.tif); b.png states sRGB."""
    codes = np.linspace(0, 250, 24 * 36 * 3).reshape(24, 36, 3).astype(np.uint8)
    for name in ("a.tif", "b.png"):
        write_image(tmp_path / "in" / name, codes, "uint8")
    options = f"--sensors nikon-d40 --illuminants A --workers 1 {words}".split()
    done = run("dataset", tmp_path / "in", tmp_path / "out", *options)
    light = codes / 255.0
    if curve:  # IEC 61966-2-1
        power = ((light + 0.055) / 1.055) ** 2.4
        light = np.where(light <= 0.04045, light / 12.92, power)
    expected = cg2raw.Sensor("nikon-d40").simulate(light, illuminant="A")
    made = {
        row["input"]: tmp_path / "out" / row["path"] for row in rows(tmp_path / "out")
    }
    assert (done.code, set(made)) == (
        (0, {"a.tif", "b.png"}) if words else (1, {"b.png"})
    )
    transfers = {row["transfer"] for row in rows(tmp_path / "out")}
    assert transfers == {"srgb" if curve else "linear"}
    assert words or "a.tif: its whole numbers" in done.err and "--linearize" in done.err
    for path in made.values():
        with rawpy.imread(str(path)) as raw:
            np.testing.assert_array_equal(raw.raw_image_visible, expected)


def test_a_file_depends_on_no_other_image(images, tmp_path):
    make(images, tmp_path / "all", *NOISY)
    files = sorted(images.glob("*.exr"))
    assert run("dataset", *files[:1], tmp_path / "one", *NOISY).code == 0
    both = contents(tmp_path / "all"), contents(tmp_path / "one")
    same = [path for path in both[1] if path.endswith(".dng")]
    assert len(same) == 4
    assert all(both[0][path] == both[1][path] for path in same)


def test_seed_decides_lights_noise_and_crops(images, tmp_path):
    options = "--sensors samsung-s20fe --illuminants 1 --iso 800 --crop 8x6".split()
    for seed in "12":
        make(images, tmp_path / seed, *options, "--seed", seed)
    one, two = rows(tmp_path / "1"), rows(tmp_path / "2")
    assert all(a["sha256"] != b["sha256"] for a, b in zip(one, two, strict=True))
    assert all(a["neutral"] != b["neutral"] for a, b in zip(one, two, strict=True))
    assert [row["crop"] for row in one] != [row["crop"] for row in two]
    assert len({row["illuminant"] for row in one}) == 5  # another for each image


def test_crops_lie_in_the_image_and_reach_its_edges():
    plan = SimpleNamespace(crop=(8, 6), seed=1)
    crops = {Plan.crop_at(plan, f"{n}", 0, 9, 8) for n in range(200)}
    assert crops == {(x, y, 8, 6) for x in range(2) for y in range(3)}


def test_made_again_nothing_is_made(images, tmp_path):
    make(images, tmp_path / "out")
    before = contents(tmp_path / "out")
    times = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.dng")}
    assert f"{5 * FILES} of them kept" in make(images, tmp_path / "out")
    assert contents(tmp_path / "out") == before
    assert times == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.dng")}


def test_lost_and_cut_files_are_made_again(images, tmp_path):
    make(images, tmp_path / "out")
    before = contents(tmp_path / "out")
    lost, cut = sorted(tmp_path.rglob("*.dng"))[3:5]
    lost.unlink()
    cut.write_bytes(cut.read_bytes()[:100])
    assert f"{5 * FILES - 2} of them kept" in make(images, tmp_path / "out")
    assert contents(tmp_path / "out") == before


def test_changed_and_new_images_alone_are_made(copy, tmp_path):
    make(copy, tmp_path / "out")
    write_image(copy / "0.exr", scene(seed=1000))
    write_image(copy / "new.exr", scene(seed=1001))
    assert f"{4 * FILES} of them kept" in make(copy, tmp_path / "out")
    make(copy, tmp_path / "fresh")
    assert contents(tmp_path / "out") == contents(tmp_path / "fresh")


def test_an_image_that_became_bad_leaves_nothing(copy, tmp_path):
    make(copy, tmp_path / "out")
    (copy / "0.exr").write_text("no image")
    assert run("dataset", copy, tmp_path / "out", *OPTIONS).code == 1
    assert not list((tmp_path / "out/0").glob("*"))
    check_agreement(tmp_path / "out")


def test_images_that_went_away_are_an_error(copy, tmp_path):
    make(copy, tmp_path / "out")
    (copy / "photo.png").unlink()
    message = fails("dataset", copy, tmp_path / "out", *OPTIONS)
    assert "photo.png" in message and "put it back" in message


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (["--seed", "3"], "--seed 0, not 3"),
        (["--digital-gain", "1"], "--digital-gain 1.0,0.8, not 1.0"),
        (["--iso", "clean,100"], "--iso clean, not clean,100.0"),
        (["--sensors", "samsung-s20fe"], "--sensors nikon-d40,samsung-s20fe, not"),
        (["--illuminants", "A"], "--illuminants 2, not A"),
        (["--convention", "paper"], "--convention dng, not paper"),
        (["--crop", "4x4"], "--crop None, not 4,4"),
        (["--format", "npy"], "--format dng, not npy"),
    ],
    ids=lambda words: words[0] if isinstance(words, list) else "",
)
def test_other_options_are_an_error(images, tmp_path, changed, said):
    options = [*OPTIONS, *changed]
    if changed[0] == "--iso":  # only one of the sensors has noise
        options = ["--sensors", "samsung-s20fe", *OPTIONS[2:]]
        make(images, tmp_path / "out", *options)
        options += changed
    else:
        make(images, tmp_path / "out")
    before = contents(tmp_path / "out")
    message = fails("dataset", images, tmp_path / "out", *options)
    assert said in message and "another OUT" in message
    assert contents(tmp_path / "out") == before


def test_another_process_in_the_folder_is_an_error(images, tmp_path):
    make(images, tmp_path / "out")
    with (tmp_path / "out/.cg2raw/lock").open("w") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        message = fails("dataset", images, tmp_path / "out", *OPTIONS)
    assert "another cg2raw" in message


def test_a_folder_of_other_files_is_refused(images, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    assert "holds files of no data set" in fails("dataset", images, tmp_path, *OPTIONS)


def test_the_data_set_may_lie_among_the_images(copy, tmp_path):
    options = "--sensors nikon-d40 --illuminants 1 --format exr".split()
    make(copy, copy / "out", *options)
    assert "5 of them kept" in make(copy, copy / "out", *options)
