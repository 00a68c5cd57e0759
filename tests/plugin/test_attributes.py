# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Every attribute: what it takes, and what it says of other values."""

import json

import pytest

import cg2raw
from cg2raw.io.image_file import read_image
from images import attributes, read_dn

BASE = {"sensor": "samsung-s20fe", "illuminant": "D65"}
BAD = [  # one of each layer; the rules are those of tests/export
    ("iso", "1000000", "one stop"),
    ("seed", "5000000000", "type=string"),
    ("colour", "red", "dng:colour is unknown; known: dng:sensor"),
]


@pytest.mark.parametrize(("name", "value", "said"), BAD)
def test_bad_values_get_one_clear_error(oiiotool, exr, tmp_path, name, value, said):
    out = tmp_path / "shot.dng"
    arguments = attributes(**{**BASE, name: value})
    done = oiiotool(exr, *arguments, "-o", out, check=False)
    message = done.stdout + done.stderr
    assert done.returncode != 0
    assert said in message
    assert "Traceback" not in message and "terminate" not in message
    assert [p.name for p in tmp_path.iterdir()] == ["scene.exr"]


def test_iso_of_a_sensor_without_measured_noise(oiiotool, exr, tmp_path):
    out = tmp_path / "shot.dng"
    arguments = attributes(sensor="nikon-d40", illuminant="D65", iso=800)
    done = oiiotool(exr, *arguments, "-o", out, check=False)
    assert done.returncode != 0
    assert "no measured noise" in done.stdout + done.stderr
    oiiotool(exr, *arguments, *attributes(effects="none"), "-o", out)
    assert out.exists()


def test_noise_of_an_iso_may_be_physical(oiiotool, exr, tmp_path):
    """The model changes the draw, not the variance that the DNG states."""
    profile = json.loads(cg2raw.Sensor("samsung-s20fe").to_json())
    for row in profile["noise"]:
        row.update(tukey_lambda=-0.05, row_sigma=0.3 * min(row["beta2"]) ** 0.5)
    path = tmp_path / "shaped.json"
    path.write_text(json.dumps(profile))
    dn, stated = {}, {}
    for noise in ("", "gaussian", "Physical"):
        out = tmp_path / f"noise-{noise}.dng"
        given = attributes(**BASE, iso=800) + (attributes(noise=noise) if noise else [])
        oiiotool(exr, *given, *attributes(sensor=path), "-o", out)
        dn[noise] = read_dn(out)
        stated[noise] = cg2raw.read_dng_metadata(str(out)).noise_profile
    assert (dn[""] == dn["gaussian"]).all()
    assert (dn[""] != dn["Physical"]).mean() > 0.5
    assert stated[""] == stated["gaussian"] == stated["Physical"]


def test_a_profile_says_how_noise_is_drawn(oiiotool, exr, tmp_path):
    """Where the command does not, in the plugin as in Python."""
    profile = json.loads(cg2raw.Sensor("samsung-s20fe").to_json())
    profile["noise_effects"] = ["poisson_shot_noise", "heavy_tailed_noise"]
    for row in profile["noise"]:
        row.update(tukey_lambda=0.14, row_sigma=0.0)
        row.update(outlier_fraction=0.02, outlier_variance_ratio=25.0)
    path = tmp_path / "heavy.json"
    path.write_text(json.dumps(profile))
    rgb = read_image(exr).pixels
    run = {"illuminant": "D65", "iso": 800}
    dn = {}
    for noise in (None, "gaussian", "physical"):
        out = tmp_path / f"noise-{noise}.dng"
        given = attributes(**{**BASE, "sensor": path}, iso=800)
        given += attributes(noise=noise) if noise else []
        oiiotool(exr, *given, "-o", out)
        dn[noise] = read_dn(out)
        seen = cg2raw.Sensor(path).simulate(rgb, noise=noise, **run)
        assert (dn[noise] == seen).all()
    assert (dn[None] == dn["physical"]).all()
    assert (dn[None] != dn["gaussian"]).mean() > 0.5


def test_physical_noise_says_what_a_profile_lacks(oiiotool, exr, tmp_path):
    given = attributes(**BASE, iso=800, noise="physical")
    done = oiiotool(exr, *given, "-o", tmp_path / "shot.dng", check=False)
    assert done.returncode != 0
    assert "tukey_lambda and row_sigma" in done.stdout + done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["scene.exr"]


@pytest.mark.parametrize("iso", ["800", "800.0"])
@pytest.mark.parametrize("kind", ["", ":type=float", ":type=int", ":type=string"])
def test_numbers_may_have_any_type(oiiotool, exr, tmp_path, iso, kind):
    if kind == ":type=int" and "." in iso:
        pytest.skip("not an int")
    out, same = tmp_path / "shot.dng", tmp_path / "same.dng"
    base = attributes(**BASE)
    oiiotool(exr, *base, f"--attrib{kind}", "dng:iso", iso, "-o", out)
    oiiotool(exr, *base, "--attrib", "dng:iso", 800, "-o", same)
    assert out.read_bytes() == same.read_bytes()
