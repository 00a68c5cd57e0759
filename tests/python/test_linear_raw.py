# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw profile of demosaicked DNGs: ProRAW, and a linear conversion."""

import json

import numpy as np
import pytest

import cg2raw
from python import commands

PRORAW = "meta_only/iphone12pro_proraw_header_exiv2.dng"
LOSSY = "canon6d_lossy_linear_photoprism.dng"


def real(camera_data, name):
    path = camera_data / "real" / name
    if not path.exists():
        pytest.skip(f"no {path}")
    return path


def profile_of(path, out, cfa="RGGB"):
    """Return (fields, report) of the profile that cg2raw makes of a file."""
    done = commands.run("profile", path, "--cfa", cfa, "-o", out, "--json")
    assert (done.code, done.err) == (0, "")
    return json.loads(out.read_text()), json.loads(done.out)


def test_a_profile_of_proraw(camera_data, tmp_path):
    path = real(camera_data, PRORAW)
    fields, report = profile_of(path, tmp_path / "phone.json")
    assert (fields["make"], fields["model"]) == ("Apple", "iPhone 12 Pro")
    assert (fields["width"], fields["height"]) == (4032, 3024)
    assert fields["cfa"] == "RGGB"
    # exiftool's numbers.
    assert fields["black_level"] == [0] * 4 and fields["white_level"] == 65535
    assert fields["calibration_illuminant_1"] == "A"
    assert fields["calibration_illuminant_2"] == "D65"
    np.testing.assert_allclose(
        np.ravel(fields["color_matrix_2"])[:3],
        [0.9145434499, -0.3222275078, -0.1262248605],
        atol=1e-9,
    )
    (neutral,) = fields["illuminants"]["neutrals"]
    assert neutral == pytest.approx([0.448975116, 0.5408688784], abs=1e-6)
    (row,) = fields["noise"]
    assert (row["beta1"], row["beta2"]) == ([3e-05] * 4, [3e-08] * 4)
    assert "a mosaic is noisier" in json.dumps(report)


def test_it_simulates(camera_data, tmp_path):
    path, out = real(camera_data, PRORAW), tmp_path / "phone.json"
    fields, _ = profile_of(path, out, "BGGR")
    (row,) = fields["noise"]
    raw = cg2raw.Sensor(str(out)).simulate(
        np.full((64, 96, 3), 0.5, np.float32), illuminant="D65", iso=row["iso"]
    )
    cg2raw.write_dng(tmp_path / "shot.dng", raw)
    metadata = cg2raw.read_dng_metadata(str(tmp_path / "shot.dng"))
    assert metadata.cfa == "BGGR" and metadata.model == "iPhone 12 Pro"


def test_a_linear_conversion_is_of_the_sensor_before_it(camera_data, tmp_path):
    """Adobe's has AsShotNeutral of 1, as its AnalogBalance balanced it."""
    path = real(camera_data, LOSSY)
    fields, _ = profile_of(path, tmp_path / "canon.json")
    (neutral,) = fields["illuminants"]["neutrals"]
    balance, stored = (2.158672, 1.414752), (1 / 0.996616, 0.995727 / 0.996616)
    expected = [n / b for n, b in zip(stored, balance, strict=True)]
    assert neutral == pytest.approx(expected, abs=1e-5)
    # CameraCalibration1 of red, and Adobe's matrix of the Canon EOS 6D.
    np.testing.assert_allclose(
        np.ravel(fields["color_matrix_2"])[:3],
        np.multiply(0.9883, [0.7034, -0.0804, -0.1014]),
        atol=1e-6,
    )


def test_the_cfa_is_asked_for(camera_data, tmp_path):
    path = real(camera_data, PRORAW)
    line = commands.fails("profile", path, "-o", tmp_path / "phone.json")
    assert "does not reveal the sensor's CFA" in line and "--cfa RGGB" in line
    assert not (tmp_path / "phone.json").exists()


def test_a_mosaic_says_its_own(tmp_path):
    photo = commands.write_dng(tmp_path / "a.dng")
    line = commands.fails("profile", photo, "--cfa", "RGGB")
    assert "says its own CFA: leave the CFA out" in line
