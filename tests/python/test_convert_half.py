# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw convert: half floats of an EXR are the numbers that they are."""

import numpy as np
import pytest

from dataset import data_sets
from python import commands

BASE = ["--sensor", "samsung-s20fe", "--illuminant", "D65"]


@pytest.mark.parametrize("exposure", [None, "0.7"])
def test_half_floats_are_the_same_numbers(scene, tmp_path, exposure):
    """They are never made float32 as a whole, unless an exposure multiplies them."""
    halves = scene.astype(np.float16)
    narrow = data_sets.write_image(tmp_path / "half.exr", scene, "half")
    wide = data_sets.write_image(
        tmp_path / "float.exr", halves.astype(np.float32), "float"
    )
    words = [*BASE, "--iso", 800] + (["--exposure", exposure] if exposure else [])
    for path in (narrow, wide):
        done = commands.run("convert", path, "-o", path.with_suffix(".dng"), *words)
        assert (done.code, done.err) == (0, "")
        assert "1 NaN values became 0, 1 infinite ones" in done.out
    dng = [path.with_suffix(".dng").read_bytes() for path in (narrow, wide)]
    assert dng[0] == dng[1]
