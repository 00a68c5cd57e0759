# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A data set keeps the profiles that it was made with, also those of one's own."""

import json
import shutil

import numpy as np
import pytest

import cg2raw
from cg2raw.dataset import sensor_of
from dataset.data_sets import rows, scene, write_image
from python.commands import fails, run

FEW = "--illuminants D65 --iso clean,800".split()


@pytest.fixture
def studio(tmp_path, monkeypatch, repository):
    """Return a folder to work in, with renders/ and a profile of one's own."""
    folder = tmp_path / "studio"
    write_image(folder / "renders/a.exr", scene())
    text = (repository / "plugins/profiles/samsung-s20fe.json").read_text()
    uneven = {"name": "prnu", "parameters": {"sigma": 0.01}}
    own = json.loads(text) | {"id": "my-phone", "effects": [uneven]}
    (folder / "my-phone.json").write_text(json.dumps(own))
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def out(studio):
    """Return a data set whose profile was given by a relative path, and is gone."""
    words = ["renders", "out", "--sensors", "my-phone.json", *FEW]
    assert run("dataset", *words).code == 0
    (studio / "my-phone.json").unlink()
    return studio / "out"


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Work in another folder."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")


def resumed(studio, out, sensors):
    """Return what the command says that goes on with two finished files."""
    done = run("dataset", studio / "renders", out, "--sensors", sensors, *FEW)
    assert done.code == 0 and "2 of them kept" in done.out, done
    return done.err


def test_lights_are_drawn_near_the_profiles_own_neutrals(studio):
    path = studio / "my-phone.json"
    two = [[0.40, 0.80], [0.42, 0.78], [0.41, 0.79]]
    profile = json.loads(path.read_text()) | {"illuminants": {"neutrals": two}}
    path.write_text(json.dumps(profile))
    words = "renders out --sensors my-phone.json --illuminants 20".split()
    assert run("dataset", *words, "--light-draws", "measured").code == 0
    found = list(rows(studio / "out"))
    assert len({row["illuminant"] for row in found}) == 20
    sensor = cg2raw.Sensor(path)
    for row in found:
        assert row["illuminant"].startswith("measured:")
        red, _, blue = sensor.illuminant(row["illuminant"]).neutral
        assert 0.40 <= red <= 0.42 and abs(red + blue - 1.2) < 2e-6


def test_a_row_is_made_again_from_the_data_set_alone(out, studio, tmp_path, elsewhere):
    moved = tmp_path / "moved"
    shutil.copytree(out, moved)
    with pytest.raises(ValueError, match="my-phone"):
        cg2raw.Sensor("my-phone")
    for row in rows(moved):
        sensor = sensor_of(moved, row)
        assert sensor.id == "my-phone" and sensor.effects[0]["name"] == "prnu"
        keys = ("illuminant", "iso", "seed", "frame", "digital_gain", "convention")
        rgb = scene().astype(np.float16).astype(np.float32)  # as the file has it
        frame = sensor.simulate(rgb, **{key: row[key] for key in keys})
        cg2raw.write_dng(tmp_path / "again.dng", frame, preview=False)
        assert (tmp_path / "again.dng").read_bytes() == (
            moved / row["path"]
        ).read_bytes()


def test_the_same_command_resumes_in_another_folder(out, studio, elsewhere):
    said = resumed(studio, out, "my-phone.json")
    assert "my-phone.json is not there" in said and "dataset.json keeps" in said


def test_an_id_is_enough(out, studio, elsewhere):
    assert resumed(studio, out, "my-phone") == ""


def test_a_lost_file_is_made_again_with_the_kept_profile(out, studio, elsewhere):
    path = next(out.rglob("*iso800.dng"))
    before = path.read_bytes()
    path.unlink()
    done = run("dataset", studio / "renders", out, "--sensors", "my-phone", *FEW)
    assert done.code == 0 and "1 of them kept" in done.out
    assert path.read_bytes() == before


def test_a_path_of_another_name_is_told_the_ids(out, studio, elsewhere):
    words = [studio / "renders", out, "--sensors", "profile.json", *FEW]
    message = fails("dataset", *words)
    assert "profile.json" in message and "keeps my-phone: name it by that" in message


def test_a_profile_that_has_changed_is_an_error(out, studio, repository):
    text = (repository / "plugins/profiles/samsung-s20fe.json").read_text()
    changed = json.loads(text) | {"id": "my-phone"}
    (studio / "my-phone.json").write_text(json.dumps(changed))
    words = ["renders", "out", "--sensors", "my-phone.json", *FEW]
    assert "profiles) have changed" in fails("dataset", *words)


def edited(out, change):
    """Change the object in dataset.json."""
    found = json.loads((out / "dataset.json").read_text())
    change(found)
    (out / "dataset.json").write_text(json.dumps(found))


def test_a_kept_profile_that_was_edited_is_an_error(out, studio, elsewhere):
    def brighten(found):
        found["profiles"]["my-phone"]["white_level"] = 1000

    [row, _] = rows(out)
    edited(out, brighten)
    words = [studio / "renders", out, "--sensors", "my-phone", *FEW]
    message = fails("dataset", *words)
    assert "dataset.json: the profile of my-phone has another SHA-256" in message
    with pytest.raises(ValueError, match="another SHA-256"):
        sensor_of(out, row)


def test_a_row_of_another_data_set_is_an_error(out):
    [row, _] = rows(out)
    with pytest.raises(ValueError, match="keeps no profile of nikon-d40; my-phone"):
        sensor_of(out, row | {"sensor": "nikon-d40"})
    with pytest.raises(ValueError, match="is not the row's, 0000"):
        sensor_of(out, row | {"profile_sha256": "0" * 64})


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"profiles": 1}'])
def test_a_damaged_plan_is_one_line(out, studio, text):
    [row, _] = rows(out)
    (out / "dataset.json").write_text(text)
    with pytest.raises(ValueError, match=r"dataset\.json: is damaged"):
        sensor_of(out, row)
    words = ["renders", "out", "--sensors", "my-phone", *FEW]
    assert "dataset.json" in fails("dataset", *words)


def test_a_data_set_begun_without_hashes_goes_on(out, studio, elsewhere):
    """As all did until dataset.json had profile_sha256."""
    edited(out, lambda found: found.pop("profile_sha256"))
    resumed(studio, out, "my-phone")
    assert "profile_sha256" in json.loads((out / "dataset.json").read_text())
