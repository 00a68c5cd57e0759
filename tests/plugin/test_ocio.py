# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""oiiotool with an OCIO config: --tocolorspace names the sensor and the light."""

import numpy as np
import PyOpenColorIO as ocio
import pytest

import cg2raw
from images import attributes, read_dn
from python.commands import run

RAW = "RAW - samsung-s20fe - 2856K"
GAINS = (0.6, 0.9, 0.35)  # a stand-in for the chain of a sensor
ACESCG = np.array(  # linear Rec.709 from ACEScg, to 4 digits
    [[1.7051, -0.6218, -0.0833], [-0.1303, 1.1408, -0.0105], [-0.0240, -0.1290, 1.1530]]
)


def matrix(rows):
    """Return the transform of a (3, 3) matrix."""
    full = np.eye(4)
    full[:3, :3] = rows
    return ocio.MatrixTransform(full.ravel().tolist())


@pytest.fixture(params=["lin_rec709", "ACEScg"])
def config(request, tmp_path):
    """Return (path, name of the role scene_linear) of a config with a RAW space."""
    made = ocio.Config()
    made.setVersion(2, 0)
    made.addColorSpace(ocio.ColorSpace(name="lin_rec709"))
    made.addColorSpace(
        ocio.ColorSpace(
            name="ACEScg",
            toReference=matrix(ACESCG),
        )
    )
    made.addColorSpace(
        ocio.ColorSpace(
            name=RAW,
            aliases=["raw_samsung_s20fe_2856k"],
            fromReference=matrix(np.diag(GAINS)),
        )
    )
    made.setRole("scene_linear", request.param)
    made.setRole("default", "lin_rec709")
    path = tmp_path / "config.ocio"
    path.write_text(made.serialize())
    return path, request.param


@pytest.mark.parametrize("name", [RAW, "raw_samsung_s20fe_2856k"])
def test_converted_pixels_are_raw(oiiotool, config, exr, scene, tmp_path, name):
    path, _ = config
    out = tmp_path / "shot.dng"
    convert = ["--colorconvert", "lin_rec709", name]
    oiiotool(
        exr, *convert, *attributes(iso=400, seed=2), "-o", out, env={"OCIO": str(path)}
    )
    expected = cg2raw.Sensor("samsung-s20fe").simulate(
        scene * np.array(GAINS, np.float32),
        illuminant="2856K",
        iso=400,
        seed=2,
        camera_input=True,
    )
    difference = np.abs(read_dn(out).astype(int) - expected)
    assert difference.max() <= 1  # OCIO may round a product otherwise than NumPy
    assert (difference > 0).mean() < 0.001


def test_scene_linear_is_what_the_config_says(oiiotool, config, exr, tmp_path):
    path, role = config
    out = tmp_path / "shot.dng"
    given = attributes(sensor="samsung-s20fe", illuminant="D65")
    space = ["--iscolorspace", "scene_linear"]
    done = oiiotool(
        exr, *space, *given, "-o", out, env={"OCIO": str(path)}, check=False
    )
    assert (done.returncode == 0) == (role == "lin_rec709"), done.stdout + done.stderr
    assert out.exists() == (role == "lin_rec709")


def test_linear_is_what_the_version_says(oiiotool, config, exr, tmp_path):
    path, role = config
    out = tmp_path / "shot.dng"
    given = attributes(sensor="samsung-s20fe", illuminant="D65")
    done = oiiotool(
        exr,
        "--iscolorspace",
        "linear",
        *given,
        "-o",
        out,
        env={"OCIO": str(path)},
        check=False,
    )
    # To OpenImageIO 2 it is the role; 3 has made it a name of Rec.709.
    if role == "ACEScg" and oiiotool.name == "oiio-system":
        assert done.returncode != 0
        assert '--tocolorspace "lin_rec709"' in done.stdout + done.stderr


@pytest.mark.parametrize("word", ["linear", "scene_linear"])
def test_the_command_takes_words_as_its_openimageio(
    config, exr, tmp_path, monkeypatch, word
):
    path, role = config
    monkeypatch.setenv("OCIO", str(path))
    light = ("--sensor", "samsung-s20fe", "--illuminant", "D65")
    words = (exr, "--iscolorspace", word, "-o", tmp_path / "shot.dng", *light)
    done = run("convert", *words)
    is_rec709 = word == "linear" or role == "lin_rec709"
    assert (done.code == 0) == is_rec709, done.err
    assert is_rec709 or "--tocolorspace lin_rec709" in done.err


def test_an_ocio_config_that_cannot_be_read(oiiotool, exr, tmp_path):
    out = tmp_path / "shot.dng"
    given = attributes(sensor="samsung-s20fe", illuminant="D65")
    broken = {"OCIO": str(tmp_path / "nowhere.ocio")}
    done = oiiotool(exr, *given, "-o", out, env=broken, check=False)
    assert done.returncode in (0, 1)
    assert "terminate" not in done.stderr
