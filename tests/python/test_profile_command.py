# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw profile: what goes in is found again, and what is wrong is said in a line."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import cg2raw
from cg2raw.profile.noise_option import noise_row
from python.commands import fails, run, write_dng

LIGHTS = ("A", "3500K", "D50", "neutral:0.6:0.5")


@pytest.fixture
def dngs(tmp_path):
    """Return four DNGs of one camera under four lights."""
    return [write_dng(tmp_path / f"{i}.dng", light) for i, light in enumerate(LIGHTS)]


def read(path):
    """Return the JSON at @path."""
    return json.loads(path.read_text())


def test_the_camera_of_a_dng_is_found_again(tmp_path):
    out = tmp_path / "my.json"
    done = run("profile", write_dng(tmp_path / "a.dng"), "-o", out)
    assert done.code == 0 and done.err == ""
    was, made = cg2raw.Sensor("nikon-d40"), cg2raw.Sensor(out)
    for name in ("make", "model", "cfa", "bits", "white_level", "black_level"):
        assert getattr(made, name) == getattr(was, name)
    for ours, theirs in zip(made.calibrations, was.calibrations, strict=True):
        assert ours["light_source"] == theirs["light_source"]
        np.testing.assert_allclose(
            ours["camera_from_xyz"], theirs["camera_from_xyz"], atol=1e-4
        )
    for words in (
        "NIKON D40",
        "1 DNG",
        "A; D65",
        "missing   noise",
        f"wrote     {out}",
    ):
        assert words in done.out


def test_neutrals_of_all_files_are_kept(dngs, tmp_path):
    out = tmp_path / "my.json"
    done = run("profile", *dngs, "-o", out, "--json")
    report, sensor = json.loads(done.out), cg2raw.Sensor("nikon-d40")
    expected = [sensor.illuminant(light).neutral for light in LIGHTS]
    expected = np.array(expected)[:, [0, 2]]
    neutrals = np.array(read(out)["illuminants"]["neutrals"])
    np.testing.assert_allclose(neutrals, expected, atol=1e-5)
    lights = report["illuminants"]
    assert report["files"] == lights["count"] == 4
    np.testing.assert_allclose(lights["mean"], neutrals.mean(axis=0))
    np.testing.assert_allclose(lights["sd"], neutrals.std(axis=0, ddof=1))
    assert lights["cct"] == pytest.approx([2856, 5003], abs=3)


def test_what_is_missing_is_said_once_and_of_the_finished_profile(dngs, tmp_path):
    photo = write_dng(tmp_path / "one.dng", iso=800, profile="samsung-s20fe")
    report = json.loads(run("profile", photo, "--json", "-o", tmp_path / "a.json").out)
    starts = [line.partition(":")[0] for line in report["missing"]]
    assert report["notes"] == [] and starts == [
        "second colour matrix",
        "forward matrix",
        "3 neutrals that span an area (there are 1)",
        "noise at a second ISO",
        "lens shading (GainMap)",
    ]
    words = ("--iso-noise", "100:1e-3,0", "--json", "-o", tmp_path / "a.json")
    report = json.loads(run("profile", *dngs, *words).out)
    starts = [line.partition(":")[0] for line in report["missing"]]
    assert starts[1:] == ["noise at a second ISO", "lens shading (GainMap)"]


def test_a_file_given_twice_counts_once(dngs, tmp_path):
    out = tmp_path / "my.json"
    (tmp_path / "link.dng").symlink_to(dngs[0])
    done = run("profile", dngs[0], dngs[1], tmp_path / "link.dng", "-o", out)
    assert len(read(out)["illuminants"]["neutrals"]) == 2
    assert "more than once" in done.out


def test_without_output_the_profile_is_on_stdout(dngs):
    done = run("profile", dngs[0])
    assert cg2raw.Sensor.from_json(done.out).cfa == "BGGR"
    assert "missing" in done.err
    assert run("profile", dngs[0], "--quiet").err == ""


def test_options_replace_what_the_file_says(dngs, tmp_path):
    out, table = tmp_path / "my.json", tmp_path / "grey.csv"
    table.write_text("r,g,b\n1,2,1\n1,4,2\n3,4,1\n")
    names = ("--id", "mine-1", "--make", "Acme", "--model", "One")
    run("profile", dngs[0], "-o", out, "--neutrals", table, *names)
    fields = read(out)
    assert [fields[name] for name in ("id", "make", "model")] == list(names[1::2])
    assert fields["illuminants"]["neutrals"] == [[0.5, 0.5], [0.25, 0.5], [0.75, 0.25]]
    assert "grey.csv" in fields["sources"]["illuminants"]


def test_noise_by_hand_replaces_the_rows_of_its_iso(tmp_path):
    photo = write_dng(tmp_path / "a.dng", iso=800, profile="samsung-s20fe")
    out, noise = tmp_path / "my.json", "--iso-noise"
    run("profile", photo, "-o", out)
    [measured] = read(out)["noise"]
    run(
        "profile",
        photo,
        "-o",
        out,
        noise,
        "100:.1,.2,.3,.4,.5,.6",
        noise,
        "1600:1e-3,0",
    )
    rows = read(out)["noise"]
    assert [row["iso"] for row in rows] == [100, 800, 1600] and rows[1] == measured
    assert rows[0]["beta1"] == [0.3, 0.1, 0.5, 0.3]  # GRBG
    assert rows[0]["beta2"] == [0.4, 0.2, 0.6, 0.4]
    assert rows[2]["beta1"] == [1e-3] * 4 and rows[2]["beta2"] == [0] * 4
    run("profile", photo, "-o", out, noise, "800:.1,.2")
    assert read(out)["noise"][0]["beta1"] == [0.1] * 4
    assert not any("NoiseProfile" in text for text in read(out)["sources"].values())


@pytest.mark.parametrize(
    ("word", "cfa", "row"),
    [
        ("0.5:1,0", "RGGB", (0.5, [1] * 4, [0] * 4)),
        ("1e7:0,1", "MONO", (1e7, [0], [1])),
        ("9:1,.2,.3,.4,.5,.6", "GBRG", (9, [0.3, 0.5, 1, 0.3], [0.4, 0.6, 0.2, 0.4])),
    ],
)
def test_bounds_of_noise_are_legal(word, cfa, row):
    found = noise_row(word, cfa)
    assert (found["iso"], found["beta1"], found["beta2"]) == row


BAD_NOISE = {
    "100": "0 numbers|is no number",
    "100:1e-3": "1 numbers",
    "100:1,2,3": "3 numbers",
    "100:2,0": "2 must be within 0 to 1",
    "100:-1e-3,0": "must be within 0 to 1",
    "0:1e-3,0": "iso 0 must be above 0",
    "10000001:1e-3,0": "up to 1e+07",
    "100:0,1.001": "1.001 must be within 0 to 1",
    "nan:1e-3,0": "'nan' is no number",
    "100:1e-3,x": "'x' is no number",
}


@pytest.mark.parametrize("word", BAD_NOISE)
def test_bad_noise_is_refused(dngs, word):
    line = fails("profile", dngs[0], "--iso-noise", word)
    assert any(part in line for part in BAD_NOISE[word].split("|"))


def test_an_iso_is_given_once(dngs):
    words = ("--iso-noise", "100:1e-3,0") * 2
    assert "ISO 100 is given twice" in fails("profile", dngs[0], *words)


def bad_files(tmp_path, good):
    """Return {what the message says: path} of files that are no reference."""
    text, cut, folder = (tmp_path / name for name in ("t.dng", "cut.dng", "d.dng"))
    text.write_text("this is no photo\n" * 100)
    cut.write_bytes(good.read_bytes()[:300])
    folder.mkdir()
    (tmp_path / "empty.dng").touch()
    (tmp_path / "t.nef").write_text("this is no photo\n" * 100)
    return {
        "is no file": tmp_path / "absent.dng",
        "does not start with II or MM": text,
        "cut.dng: ": cut,
        "is a folder": folder,
        "empty.dng: ": tmp_path / "empty.dng",
    }


def test_each_bad_file_alone_is_one_line(dngs, tmp_path):
    for reason, path in bad_files(tmp_path, dngs[0]).items():
        line = fails("profile", path, "-o", tmp_path / "my.json")
        assert reason in line and str(path) in line
    assert "LibRaw cannot read" in fails("profile", tmp_path / "t.nef")
    assert "No such file" in fails("profile", tmp_path / "absent.nef")
    assert not (tmp_path / "my.json").exists()


def test_all_bad_files_are_named_or_skipped(dngs, tmp_path):
    bad, out = bad_files(tmp_path, dngs[0]), tmp_path / "my.json"
    files = [*dngs, *bad.values()]
    done = run("profile", *files, "-o", out)
    assert done.code == 1 and not out.exists()
    assert all(str(path) in done.err for path in bad.values())
    assert "5 of 9 files cannot be used; --skip-bad" in done.err
    done = run("profile", *files, "-o", out, "--skip-bad", "--json")
    assert done.code == 0 and len(json.loads(done.out)["skipped"]) == 5
    assert len(read(out)["illuminants"]["neutrals"]) == 4
    done = run("profile", *bad.values(), "-o", out, "--skip-bad")
    assert done.code == 1 and "none of the 5 files can be used" in done.err


def test_two_cameras_are_no_sensor(dngs, tmp_path):
    other = write_dng(tmp_path / "s20.dng", profile="samsung-s20fe")
    line = fails("profile", dngs[0], other, "-o", tmp_path / "my.json")
    assert "NIKON D40" in line or "Nikon D40" in line
    assert "SM-G780F" in line


def test_dngs_and_other_raw_files_are_not_mixed(dngs, tmp_path):
    (tmp_path / "x.NEF").touch()
    line = fails("profile", dngs[0], tmp_path / "x.NEF")
    assert "not both" in line
    line = fails("profile", tmp_path / "x.NEF", "--cfa", "RGGB")
    assert "x.NEF: says its own CFA: leave --cfa out" in line


BAD_OUTPUTS = [
    (("-o", "{0}/no/such/my.json"), "there is no folder"),
    (("-o", "{0}/my.dng"), "must end in .json"),
    (("--plot", "{0}/my.jpg"), "must end in .png"),
    (("--neutrals", "{0}/n.json", "-o", "{0}/n.json"), "one of the files to be read"),
    (("-o", "{0}"), "is not a regular file: choose another name"),
    (("-o", "/dev/full"), "No space left"),
    (("--id", "My Camera"), "id "),
    (("--bits", "12"), "--bits: the files say it; it goes with --ssf alone"),
    (("--neutrals", "{0}/absent.csv"), "No such file"),
]


@pytest.mark.parametrize(("words", "reason"), BAD_OUTPUTS, ids=lambda w: w[-1])
def test_bad_outputs_and_options(dngs, tmp_path, words, reason):
    before = dngs[0].read_bytes()
    words = [word.format(tmp_path) for word in words]
    assert reason in fails("profile", dngs[0], *words)
    assert dngs[0].read_bytes() == before
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".dng"] * 4


def test_a_photo_is_never_overwritten(tmp_path):
    photo = write_dng(tmp_path / "a.dng")
    (tmp_path / "link.json").symlink_to(photo)
    before = photo.read_bytes()
    fails("profile", photo, "-o", tmp_path / "link.json")
    assert photo.read_bytes() == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write to any folder")
def test_a_read_only_folder(dngs, tmp_path):
    folder = tmp_path / "ro"
    folder.mkdir(0o500)
    assert "Permission denied" in fails("profile", dngs[0], "-o", folder / "my.json")


def test_names_of_files_need_not_be_ascii(dngs, tmp_path):
    photo = dngs[0].rename(tmp_path / "caf\u00e9 [1].dng")
    done = run("profile", photo, "-o", tmp_path / "caf\u00e9.json")
    assert done.code == 0
    assert "caf\u00e9 [1].dng" in str(read(tmp_path / "caf\u00e9.json")["sources"])
    assert "is not UTF-8" in fails("profile", os.fsdecode(b"\xff.dng"))
    assert "is not UTF-8" in fails("profile", photo, "-o", os.fsdecode(b"\xff.json"))
    assert "a b.nef: No such file" in fails("profile", "a\nb.nef")


def test_same_files_same_bytes(dngs, tmp_path):
    texts = []
    for name in ("1.json", "2.json"):
        run("profile", *dngs, "-o", tmp_path / name)
        texts.append((tmp_path / name).read_bytes())
    assert texts[0] == texts[1]
    assert all(len(line) < 200 for line in texts[0].splitlines())


def test_wrong_command_lines_exit_2(dngs):
    assert "unrecognized" in fails("profile", dngs[0], "--skipbad", code=2)


def test_version():
    assert run("--version").out == f"cg2raw {cg2raw.__version__}\n"


def test_help_does_not_load_what_only_some_commands_need():
    code = (
        "import sys, cg2raw.cli; cg2raw.cli.make_parser(); "
        "print({'matplotlib', 'rawpy', 'rich', 'exifread'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout == "set()\n", done.stderr


REAL = {
    "Hero6_GOPR0024.dng": ("gopro-hero6-black", "RGGB", 16383, [100]),
    "Fusion_GPFR7066.dng": ("gopro-fusion", "RGGB", 16383, [100]),
    "bmpcc_twelvemonkeys.dng": ("blackmagic-pocket-cinema-camera", "GBRG", 51080, []),
    "canon550d_colorchart_tinydng.dng": ("canon-eos-kiss-x4", "RGGB", 15000, []),
}


@pytest.mark.parametrize("name", REAL)
def test_real_dngs(camera_data, tmp_path, name):
    out = tmp_path / "my.json"
    assert run("profile", camera_data / "real" / name, "-o", out).code == 0
    fields = read(out)
    isos = [row["iso"] for row in fields.get("noise", [])]
    found = (fields["id"], fields["cfa"], fields["white_level"], isos)
    assert found == REAL[name]


def test_lens_shading_of_a_real_dng_is_an_effect(camera_data):
    photo = camera_data / "real" / "Hero6_GOPR0024.dng"
    done = run("profile", photo)
    [effect] = cg2raw.Sensor.from_json(done.out).effects
    assert effect["name"] == "lens_shading" and effect["parameters"]["r2"] < -0.1
    assert "effects   lens_shading" in done.err
    assert "missing   lens shading" not in done.err


REFUSED = ("oiio_testsuite_bayer_r5.dng", "canon6d_lossy_linear_photoprism.dng")


@pytest.mark.parametrize("name", REFUSED)
def test_real_dngs_that_are_no_reference(camera_data, name):
    assert name in fails("profile", camera_data / "real" / name)
