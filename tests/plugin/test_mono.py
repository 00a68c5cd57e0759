# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""A monochrome sensor through the plugin: no light is needed, and no RAW space."""

import numpy as np
import pytest

import cg2raw
from images import attributes, read_dn
from oracles import cameras


@pytest.fixture
def profile(tmp_path):
    path = tmp_path / "mono.json"
    path.write_text(cameras.mono_text(id="mono"))
    return path


def test_it_writes_what_the_core_simulates(oiiotool, exr, scene, tmp_path, profile):
    out = tmp_path / "shot.dng"
    oiiotool(exr, *attributes(sensor=profile, iso=100, seed=3), "-o", out)
    raw = cg2raw.Sensor(profile).simulate(scene, iso=100, seed=3)
    np.testing.assert_array_equal(read_dn(out), raw)


def test_its_dng_is_a_reference(oiiotool, exr, scene, tmp_path, profile):
    reference, out = tmp_path / "reference.dng", tmp_path / "shot.dng"
    sensor = cg2raw.Sensor(profile)
    cg2raw.write_dng(reference, sensor.simulate(scene))
    oiiotool(exr, *attributes(reference=reference), "-o", out)
    np.testing.assert_array_equal(read_dn(out), sensor.simulate(scene))


def test_it_has_no_raw_space(oiiotool, exr, tmp_path, profile):
    words = attributes(sensor=profile)
    space = ("--iscolorspace", "RAW - mono - D65")
    done = oiiotool(exr, *space, *words, "-o", tmp_path / "x.dng", check=False)
    assert done.returncode != 0
    assert "mono is monochrome and has no RAW colour space" in done.stderr
