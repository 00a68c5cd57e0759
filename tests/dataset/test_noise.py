# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The manifest's noise columns are those of the files, and enough to draw it again."""

import json

import numpy as np
import pyarrow.parquet
import pytest

import cg2raw
from dataset.data_sets import rows, write_image
from python.commands import run

NOISE = ("beta1", "beta2", "system_gain", "read_noise", "noise_effects")
SHAPE = ("tukey_lambda", "row_sigma", "outlier_fraction", "outlier_variance_ratio")
SIDE = 256  # pixels: a CFA site has 2^13 of them dark, and as many lit
# Standard error of a variance that so many normals estimate, and five of them.
TOLERANCE = 5 * (2 / 2**13) ** 0.5


@pytest.fixture(scope="module")
def steps(tmp_path_factory):
    """Return an image: black above, grey of 0.4 below, so that nothing clips."""
    pixels = np.zeros((SIDE, SIDE, 3), np.float32)
    pixels[SIDE // 2 :] = 0.4
    return write_image(tmp_path_factory.mktemp("in") / "steps.exr", pixels)


def pair_of(steps, out, words):
    """Return (row, noisy, clean) of a data set of one noisy file, (4, h, w) each."""
    options = ["--illuminants", "D65", "--format", "npy", *words.split()]
    done = run("dataset", steps, out, *options)
    assert done.code == 0, done
    row = next(row for row in rows(out) if row["iso"] is not None)
    return row, np.load(out / row["path"]), np.load(out / row["clean_path"])


def of_planes(row, name):
    """Return a column's numbers, row by row of the CFA, of the planes R, G1, G2, B."""
    red, blue = row["cfa"].index("R"), row["cfa"].index("B")
    return np.array(row[name])[[red, red ^ 1, blue ^ 1, blue]]


@pytest.mark.parametrize(
    "words",
    [
        "--sensors samsung-s20fe --iso clean,1600",
        "--sensors samsung-s20fe --iso clean,700 --digital-gain 0.8",
        "--sensors nikon-d850 --iso clean,6400 --noise physical",
        "--sensors samsung-s20fe --iso clean,3200 --method upi --seed 2",
    ],
)
def test_the_documented_formula_is_the_variance_of_the_file(steps, tmp_path, words):
    """variance = beta1 x + beta2, and 1/12 DN^2 of each of the two roundings."""
    if "upi" in words:
        words += " --illuminants 1"
    row, noisy, clean = pair_of(steps, tmp_path / "out", words)
    per_dn = 1 / (row["white_level"] - np.mean(row["black_level"]))
    noise, half = noisy - clean, SIDE // 4
    # A heavy tail scatters estimates of its variance more than normals do.
    tolerance = TOLERANCE * (2 if row["noise"] == "physical" else 1)
    beta1, beta2 = of_planes(row, "beta1"), of_planes(row, "beta2")
    for plane in range(4):
        for part in (slice(half), slice(half, None)):
            x = clean[plane, part].astype(float)
            expected = np.mean(beta1[plane] * np.maximum(x, 0) + beta2[plane])
            found = np.mean(noise[plane, part].astype(float) ** 2) - per_dn**2 / 6
            assert found == pytest.approx(expected, rel=tolerance)
    # In electrons: the slope of the photon transfer curve, and the dark noise.
    gain, read = of_planes(row, "system_gain"), of_planes(row, "read_noise")
    for plane in range(4):
        dark, lit = noise[plane, :half], noise[plane, half:]
        electrons = clean[plane, half:].mean() / per_dn / gain[plane]
        photons = (lit.var() - dark.var()) / (per_dn * gain[plane]) ** 2
        assert photons == pytest.approx(electrons, rel=2 * tolerance)
        dark_electrons = np.sqrt(dark.var() - per_dn**2 / 6) / per_dn / gain[plane]
        assert dark_electrons == pytest.approx(read[plane], rel=tolerance)


def test_columns_are_those_of_the_sensor_and_null_without_noise(steps, tmp_path):
    words = "--sensors samsung-s20fe,nikon-d850 --iso clean,250"
    pair_of(steps, tmp_path / "out", words)
    for row in rows(tmp_path / "out"):
        if row["iso"] is None:
            assert all(row[name] is None for name in (*NOISE, *SHAPE))
            continue
        known = cg2raw.Sensor(row["sensor"]).noise_at(row["iso"])
        for name in ("beta1", "beta2", *SHAPE):
            assert row[name] == known.get(name)
        assert row["noise_effects"] == ["shot_noise", "read_noise"]


def test_physical_noise_names_the_effects_that_draw_it(steps, tmp_path):
    words = "--sensors nikon-d850 --iso clean,800 --noise physical"
    row, _, _ = pair_of(steps, tmp_path / "out", words)
    drawn = ["poisson_shot_noise", "heavy_tailed_noise", "row_noise"]
    assert row["noise_effects"] == drawn
    known = {effect["name"] for effect in cg2raw.effects()}
    assert known >= set(drawn)
    table = pyarrow.parquet.read_table(tmp_path / "out/manifest.parquet").to_pylist()
    assert table == rows(tmp_path / "out")


def test_a_profile_without_photon_noise_has_no_electrons(steps, tmp_path):
    """A beta1 of 0 states no gain: the columns in electrons are null."""
    profile = json.loads(cg2raw.Sensor("samsung-s20fe").to_json())
    profile["id"] = "no-gain"
    for known in profile["noise"]:
        known["beta1"] = [0.0] * 4
    (tmp_path / "no-gain.json").write_text(json.dumps(profile))
    words = f"--sensors {tmp_path}/no-gain.json --iso clean,100"
    row, _, _ = pair_of(steps, tmp_path / "out", words)
    assert row["beta1"] == [0.0] * 4 and row["beta2"][0] > 0
    assert row["system_gain"] is None and row["read_noise"] is None


def test_two_patches_of_one_render_have_different_noise(tmp_path):
    grey = write_image(tmp_path / "in/grey.exr", np.full((40, 40, 3), 0.4, np.float32))
    words = "--sensors nikon-d850 --illuminants D65 --iso clean,6400 --format npy"
    words += " --patch-size 16 --patches 2"
    assert run("dataset", grey, tmp_path / "out", *words.split()).code == 0
    found = {(row["iso"], row["patch"]): row for row in rows(tmp_path / "out")}
    pixels = {
        key: np.load(tmp_path / "out" / row["path"]) for key, row in found.items()
    }
    np.testing.assert_array_equal(pixels[None, 0], pixels[None, 1])
    assert (pixels[6400, 0] != pixels[6400, 1]).mean() > 0.9
    assert found[6400, 0]["frame"] != found[6400, 1]["frame"]
