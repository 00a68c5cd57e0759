# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The README: each of its commands runs as it stands there, and its numbers are true.

Of "Install" by slow tests: tests/python/test_demo.py, tests/packaging/test_wheel.py."""

import json
import re
import shutil
import subprocess

import numpy as np
import pytest
import yaml

import cg2raw
from cg2raw.io.image_file import read_image
from conftest import ROOT
from images import read_dn, write_image
from pages import environment_of, write_studio_config
from readme import README, sections

TEXT = README.read_text()
SCENE = np.random.default_rng(1).uniform(0, 1.5, (48, 64, 3)).astype(np.float32)
GREY = 0.5  # of white, in flats
ISO = 800


def shoot(path, light, frame, illuminant="D65"):
    """Write the DNG of one exposure of even light by a camera that has noise."""
    path.parent.mkdir(exist_ok=True)
    raw = cg2raw.Sensor("samsung-s20fe").simulate(
        np.full((48, 48, 3), light, np.float32),
        illuminant=illuminant,
        iso=ISO,
        frame=frame,
        convention="sensor",
    )
    cg2raw.write_dng(path, raw)


def write_inputs(folder):
    """Write small files of the names that the README uses."""
    data = folder / "tests/data"
    data.mkdir(parents=True)
    (data / "interior.exr").symlink_to(ROOT / "tests/data/interior.exr")
    write_image(folder / "shot.exr", SCENE)
    (folder / "renders").mkdir()
    write_image(folder / "renders/a.exr", SCENE[:16, :24])
    write_studio_config(folder / "studio.ocio")
    frames = []
    for number in range(3):
        shoot(folder / f"IMG_{number}.dng", GREY, number, f"{2500 + 400 * number}K")
        for first, kind, light in ((10, "dark", 0.0), (20, "flat", GREY)):
            file = f"{kind}s/{number}.dng"
            shoot(folder / file, light, first + number)
            frames.append({"file": file, "kind": kind})
            if light:
                frames[-1]["scene"] = light
    captures = {"sensor": "my-camera.json", "frames": frames}
    (folder / "captures.yaml").write_text(yaml.safe_dump(captures))


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """Return the folder in which all commands ran but those of "Install"."""
    folder = tmp_path_factory.mktemp("readme")
    write_inputs(folder)
    environment = environment_of(folder, "oiio-system")
    for heading, blocks in sections().items():
        for language, code in blocks:
            if language != "sh" or heading == "Install":
                continue
            # Every line counts, not the last one alone.
            done = subprocess.run(
                ["bash", "-euo", "pipefail", "-c", code],
                cwd=folder,
                env=environment,
                capture_output=True,
                text=True,
            )
            assert done.returncode == 0, f"{code}\n{done.stdout}{done.stderr}"
            shutil.copy(folder / "shot.dng", folder / f"{heading}.dng")
    return folder


def test_every_command_is_one_that_tests_run():
    """In a block of a language that they know; Python's are in test_docs.py."""
    found = [language for blocks in sections().values() for language, _ in blocks]
    assert set(found) == {"sh", "python"}
    assert TEXT.count("```") == 2 * len(found)
    assert not re.search(r"^(    |\t)", re.sub(r"(?s)```.*?```", "", TEXT), re.M)


def test_the_first_raw_file(ran):
    rgb = read_image(ROOT / "tests/data/interior.exr").pixels
    sensor = cg2raw.Sensor("samsung-s20fe")
    raw = sensor.simulate(rgb, illuminant="2856K", iso=3200)
    np.testing.assert_array_equal(read_dn(ran / "First RAW file.dng"), raw)
    assert read_image(ran / "shot.png").pixels.shape == rgb.shape


def test_ocio_is_within_one_dn_of_the_attributes(ran):
    difference = read_dn(ran / "shot.dng").astype(int) - read_dn(ran / "ocio.dng")
    assert abs(difference).max() <= 1


def test_ocio_adds_spaces_to_the_studio_s(ran):
    merged = (ran / "studio_raw.ocio").read_text()
    assert merged.count("RAW - ") > merged.count("RAW - nikon-d40 - ") > 0


def test_the_data_set_has_both_kinds_of_manifest_and_clean_and_noisy_frames(ran):
    rows = (ran / "out/manifest.jsonl").read_text().splitlines()
    isos = {json.loads(row)["iso"] for row in rows}
    assert isos == {None, 100, 3200} and (ran / "out/manifest.parquet").exists()


def test_the_profile_is_measured_and_consistent(ran):
    [row] = json.loads((ran / "my-camera.json").read_text())["noise"]
    assert row["iso"] == ISO
    verdict = json.loads((ran / "report/verdict.json").read_text())
    assert verdict["verdict"] == "consistent", verdict


def rows_of_sensors():
    """Return {id: (what the table says of noise, and notes)}, and the row of others."""
    table = TEXT.partition("| bundled |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| (.+?) \| (.+?) \| (.*?) \|$", table, re.MULTILINE)
    *named, others = [row for row in rows if "---" not in row[0]]
    return {
        name: row[1:] for row in named for name in re.findall("`([^`]+)`", row[0])
    }, others


def profiles():
    """Return {id: profile} of the bundled sensors."""
    files = sorted((ROOT / "plugins/profiles").glob("*.json"))
    return {file.stem: json.loads(file.read_text()) for file in files}


def test_the_sensors_are_those_of_the_table():
    named, (others, _, _) = rows_of_sensors()
    found = profiles()
    noisy = {name: profile for name, profile in found.items() if profile.get("noise")}
    assert set(named) == set(noisy)
    for name, (noise, notes) in named.items():
        isos = [row["iso"] for row in noisy[name]["noise"]]
        ends = dict.fromkeys(f"{iso:g}" for iso in (isos[0], isos[-1]))
        assert noise == "ISO " + "-".join(ends)
        assert ("physical" in notes) == ("tukey_lambda" in noisy[name]["noise"][0])
        assert ("one colour matrix" in notes) == ("color_matrix_2" not in found[name])
        effects = [effect["name"] for effect in found[name].get("effects", [])]
        assert ("lens shading" in notes) == ("lens_shading" in effects)
    rest = {name: found[name] for name in found if name not in named}
    assert len(rest) == 11 and others.startswith("eleven more, by ")
    makers = {profile["make"].split()[0].title() for profile in rest.values()}
    said = set(others.removeprefix("eleven more, by ").split(", "))
    assert makers == said


def test_the_numbers_are_those_of_effects_and_of_the_diagnosis():
    assert f"{len(cg2raw.effects())} effects of optics" in TEXT
    # All but quantisation, as docs/diagnose.md says.
    assert f"{len(cg2raw.effects()) - 1} can be named" in TEXT
    real = (ROOT / "docs/diagnose-real.md").read_text()
    assert "it names 15 effects" in TEXT and "Fifteen effects" in real


def test_the_pictures_are_small():
    named = re.findall(r"\]\((docs/images/\w+\.png)\)", TEXT)
    assert named[0] == "docs/images/hero.png" and len(named) == 2
    assert all(5_000 < (ROOT / name).stat().st_size < 500_000 for name in named)


@pytest.mark.slow
def test_the_first_picture_is_what_its_script_draws(tmp_path):
    pillow = pytest.importorskip("PIL.Image")
    drawn = tmp_path / "hero.png"
    subprocess.run([ROOT / "studies/run", "readme-picture", drawn], check=True)
    pictures = [
        np.asarray(pillow.open(path).convert("RGB"), float)
        for path in (drawn, ROOT / "docs/images/hero.png")
    ]
    # Other versions of pillow choose other colours of the palette.
    assert abs(pictures[0] - pictures[1]).mean() < 4
