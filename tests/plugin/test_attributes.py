# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Every attribute: what it takes, and what it says of other values."""

import pytest
from images import attributes

BASE = {"sensor": "samsung-s20fe", "illuminant": "D65"}
BAD = [
    ("sensor", "no-such-camera", "samsung-s20fe"),
    ("sensor", "/nowhere/x.json", "/nowhere/x.json"),
    ("illuminant", "dusk", "3200K"),
    ("illuminant", "900K", "1667"),
    ("illuminant", "as-shot", "dng:reference"),
    ("iso", "0", "dng:iso"),
    ("iso", "many", "dng:iso"),
    ("iso", "1000000", "one stop"),
    ("seed", "-1", "dng:seed"),
    ("seed", "1.5", "dng:seed"),
    ("seed", "5000000000", "type=string"),
    ("frame", "x", "dng:frame"),
    ("gain", "0", "dng:gain"),
    ("gain", "nan", "dng:gain"),
    ("convention", "adobe", "paper"),
    ("matrices", "none", "exact"),
    ("highlights", "2", "0 or 1"),
    ("effects", "some", "profile or none"),
    ("compression", "zip", "ljpeg"),
    ("preview", "maybe", "0 or 1"),
    ("tone_curve", "s-shaped", "linear"),
    ("reference", "/nowhere/x.dng", "/nowhere/x.dng"),
    ("colour", "red", "dng:sensor"),
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


@pytest.mark.parametrize("missing", ["sensor", "illuminant"])
def test_nothing_is_assumed(oiiotool, exr, tmp_path, missing):
    given = {name: value for name, value in BASE.items() if name != missing}
    out = tmp_path / "shot.dng"
    done = oiiotool(exr, *attributes(**given), "-o", out, check=False)
    assert done.returncode != 0
    assert f"dng:{missing}" in done.stdout + done.stderr
    assert not out.exists()


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
