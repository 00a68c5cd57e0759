# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Options that cannot be are one line that says what to do."""

import hashlib
import json

import pytest

import cg2raw
from cg2raw.cli.dataset import bytes_words
from cg2raw.dataset.job import plan_at
from cg2raw.dataset.options import difference, make_plan
from dataset.data_sets import FIELDS, scene, write_image
from oracles import cameras
from python.commands import fails, run

BAD = [
    ("--illuminants 0", "1 to 100000"),
    ("--illuminants as-shot", "needs a DNG"),
    ("--illuminants A,a", "name it once"),
    ("--illuminants 99K", "illuminant"),
    ("--illuminants A --light-draws measured", "name them, as measured:0-9"),
    ("--illuminants 1 --light-draws measured --method upi", "not with --method upi"),
    (
        "--illuminants 1 --light-draws measured --sensors canon-70d",
        "has no measured neutrals",
    ),
    ("--illuminants 1 --digital-gain 0", "digital gain"),
    ("--illuminants 1 --digital-gain 1,1.0", "name it once"),
    ("--illuminants 1 --digital-gain much", "must be a number or sample"),
    (
        "--illuminants 1 --digital-gain sample --sensors nikon-d40",
        "no digital_gain to sample",
    ),
    ("--illuminants 1 --iso 100 --sensors nikon-d40", "no measured noise"),
    ("--illuminants 1 --iso 999999", "outside"),
    ("--illuminants 1 --iso 100 --noise physical", "--noise gaussian"),
    ("--illuminants 1 --iso dirty", "must be a number or clean"),
    ("--illuminants 1 --sensors nikon-d4", "did you mean nikon-d40"),
    ("--illuminants 1 --patches 3", "of which size"),
    ("--illuminants 1 --crop 4", "WxH"),
    ("--illuminants 100001", "--illuminants 100001: must be 1 to 100000"),
    ("--illuminants 1 --crop 4x4 --patches 100001", "--patches 100001: must be 1 to"),
    ("--illuminants 1 --patch-size 1", "--patch-size 1: must be at least 2 pixels"),
    ("--illuminants 1 --crop 4x4 --patch-size 4", "give one of them"),
    ("--illuminants 1 --type uint16", "a DNG is uint16"),
    ("--illuminants 1 --format exr --type uint16", "--format npy"),
    ("--illuminants 1 --format npy --compression none", "of DNGs"),
    ("--illuminants 1 --format npy --sensors fujifilm-x-m1", "--format dng"),
    ("--illuminants 1 --seed -1", "seed"),
    ("--illuminants 1 --workers 2 --scheduler tcp://127.0.0.1:1", "its own workers"),
]


@pytest.mark.parametrize(("options", "said"), BAD, ids=[words for words, _ in BAD])
def test_bad_options(images, tmp_path, options, said):
    sensor = [] if "--sensors" in options else ["--sensors", "samsung-s20fe"]
    message = fails("dataset", images, tmp_path / "out", *sensor, *options.split())
    assert said in message
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "options", ["", "--illuminants 1 --workers 0", "--illuminants 1 --patches x"]
)
def test_usage(images, tmp_path, options):
    assert fails("dataset", images, tmp_path / "out", *options.split(), code=2)


def test_images_that_are_not_there(images, tmp_path):
    def message(*inputs):
        return fails("dataset", *inputs, tmp_path / "out", "--illuminants", "1")

    assert "no such file" in message(tmp_path / "none")
    assert "is a folder" in message(images, images / "0.exr")
    (tmp_path / "0.exr").write_bytes(b"")
    assert "has the name of" in message(images / "0.exr", tmp_path / "0.exr")
    (tmp_path / "empty").mkdir()
    assert "holds no EXR" in message(tmp_path / "empty")


@pytest.mark.parametrize("other", ["a.tif", "a.EXR"])
def test_two_images_that_would_have_one_folder_are_refused(tmp_path, other):
    for name in ("a.exr", other):
        (tmp_path / "in/b").mkdir(parents=True, exist_ok=True)
        (tmp_path / "in/b" / name).write_bytes(b"")
    words = [tmp_path / "out", "--illuminants", "1"]
    both = sorted([tmp_path / "in/b/a.exr", tmp_path / "in/b" / other])
    for inputs, folder in (([tmp_path / "in"], "b/"), (both, "")):
        first, second = sorted(["a.exr", other])
        assert fails("dataset", *inputs, *words).endswith(
            f"{folder}{first} and {folder}{second}: would both be {folder}a/ in the "
            "data set; rename one of them"
        )
    assert not (tmp_path / "out").exists()


def test_images_that_differ_by_case_need_a_disk_that_tells_them(tmp_path, monkeypatch):
    from cg2raw.dataset import run as module

    for name in ("a.exr", "A.exr"):
        write_image(tmp_path / "in" / name, scene())
    words = [tmp_path / "in", tmp_path / "out", *"--illuminants A".split()]
    words += ["--sensors", "nikon-d40"]
    with monkeypatch.context() as patch:
        patch.setattr(module, "folds_case", lambda out: True)
        message = fails("dataset", *words)
        assert "A.exr and a.exr: would both be a/ in the data set" in message
    assert run("dataset", *words).code == 0
    assert len(list((tmp_path / "out").glob("[aA]/*.dng"))) == 2
    assert not module.folds_case(tmp_path / "out")
    (tmp_path / "out/.CG2RAW").symlink_to(".cg2raw")  # as a disk that folds has it
    assert module.folds_case(tmp_path / "out")


@pytest.mark.parametrize(
    ("other", "fields", "reason"),
    [
        ("mono", {"illuminants": 2}, "--illuminants 2: draws neutrals, and mono is m"),
        (
            "canon-70d",
            {"illuminants": 2, "light_draws": "measured"},
            "--light-draws measured: ",
        ),
        ("nikon-d40", {"isos": (800,)}, "--iso 800: not with nikon-d40: "),
        ("fujifilm-x-m1", {"format": "exr"}, "fujifilm-x-m1"),
    ],
)
def test_a_sensor_that_cannot_is_left_out_and_another_stays(other, fields, reason):
    mono = cg2raw.Sensor.from_json(cameras.mono_text(id="mono"))
    sensor = mono if other == "mono" else cg2raw.Sensor(other)
    fields, left_out = FIELDS | fields, []
    plan = make_plan(
        [sensor, cg2raw.Sensor("samsung-s20fe")], left_out.append, **fields
    )
    assert plan.sensors == ("samsung-s20fe",)
    (sentence,) = left_out
    assert reason in sentence
    with pytest.raises(ValueError, match="--sensors: none is left that can do what"):
        make_plan([sensor], left_out.append, **fields)


def test_a_worker_takes_no_plan_but_the_one_that_was_begun(tmp_path):
    """As on machines of a cluster, which need one folder and one version."""
    plan = make_plan([cg2raw.Sensor("nikon-d40")], pytest.fail, **FIELDS)
    text, path = plan.to_json(), tmp_path / "dataset.json"
    sha256 = hashlib.sha256(text.encode()).hexdigest()
    with pytest.raises(ValueError, match="dataset.json: a worker does not see it: OUT"):
        plan_at(str(tmp_path), sha256)
    path.write_text(text + " ")
    with pytest.raises(ValueError, match="has changed while the data set was being"):
        plan_at(str(tmp_path), sha256)
    path.write_text(text)
    assert plan_at(str(tmp_path), sha256) == plan
    older = json.dumps(json.loads(text) | {"cg2raw": "0.0.1"})
    path.write_text(older)
    words = f"is of cg2raw 0.0.1, and a worker has {cg2raw.__version__}: install"
    with pytest.raises(ValueError, match=words):
        plan_at(str(tmp_path), hashlib.sha256(older.encode()).hexdigest())
    assert difference(text, plan) is None
    assert "was made by cg2raw 0.0.1, this is" in difference(older, plan)


@pytest.mark.parametrize(
    ("count", "words"),
    [
        (0, "0 bytes"),
        (999, "999 bytes"),
        (1000, "1 kB"),
        (999_499, "999 kB"),
        (999_600, "1 MB"),
        (1.234e9, "1.23 GB"),
        (45e12, "45 TB"),
    ],
)
def test_bytes_have_three_digits(count, words):
    assert bytes_words(count) == words


def test_all_sensors_leave_out_what_they_cannot(images, tmp_path):
    words = "--illuminants A --iso clean,100 --format npy --type uint16".split()
    done = run("dataset", images / "0.exr", tmp_path / "out", *words)
    assert done.code == 0
    lines = done.err.splitlines()
    assert len(lines) == 2 and all("skipped: " in line for line in lines)
    assert "fujifilm-x-m1" in lines[0] and "--iso 100: not with" in lines[1]
    made = {path.name for path in (tmp_path / "out/0").iterdir()}
    assert {"nikon-d40_l0_g1_clean.npy", "nikon-d850_l0_g1_iso100.npy"} <= made
    assert "nikon-d40_l0_g1_iso100.npy" not in made
