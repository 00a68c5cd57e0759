# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Every attribute: what it takes, and what it says of other values."""

import pytest

from images import attributes

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


@pytest.mark.parametrize("kind", ["", ":type=float", ":type=int", ":type=string"])
def test_numbers_may_have_any_type(oiiotool, exr, tmp_path, kind):
    out, same = tmp_path / "shot.dng", tmp_path / "same.dng"
    base = attributes(**BASE)
    oiiotool(exr, *base, f"--attrib{kind}", "dng:iso", 800, "-o", out)
    oiiotool(exr, *base, "--attrib", "dng:iso", 800, "-o", same)
    assert out.read_bytes() == same.read_bytes()
