# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A DNG by way of OCIO is the DNG that the plugin converts by itself."""

import numpy as np
import pytest
from cg2raw_ocio.config import config_text, make_config
from images import attributes, read_dn

from cg2raw import _core

# Bits of a sensor, and the share of words that may differ by 1.
SHARES = {10: 0.0005, 12: 0.001, 14: 0.003}
SENSORS = {"samsung-s20fe": 10, "nikon-d40": 12, "canon-600d": 14}
RUNS = [
    ("samsung-s20fe", "2856K", "interior"),
    ("nikon-d40", "D65", "night_street"),
    ("canon-600d", "sample:1", "interior"),
]


def check(oiiotool, repository, folder, sensor, light, picture):
    """Write a picture by both routes and compare the words."""
    scene = repository / "tests" / "data" / f"{picture}.exr"
    path = folder / "config.ocio"
    path.write_text(config_text(make_config([_core.load_profile(sensor)], [light])))
    by_ocio, direct = folder / "ocio.dng", folder / "direct.dng"
    env = {"OCIO": str(path)}
    space = f"RAW - {sensor} - {light}"
    oiiotool(scene, "--tocolorspace", space, "-o", by_ocio, env=env)
    given = attributes(sensor=sensor, illuminant=light)
    oiiotool(scene, *given, "-o", direct, env=env)
    difference = np.abs(read_dn(by_ocio).astype(int) - read_dn(direct))
    bits = SENSORS[sensor]
    share = (difference > 0).mean()
    print(f"{oiiotool.name} {sensor} {light} {picture}: {share:.4%}")
    assert difference.max() <= 1
    assert share <= SHARES[bits]


@pytest.mark.parametrize(("sensor", "light", "picture"), RUNS)
def test_both_routes(oiiotool, repository, tmp_path, sensor, light, picture):
    check(oiiotool, repository, tmp_path, sensor, light, picture)


@pytest.mark.slow
@pytest.mark.parametrize("picture", ["interior", "night_street"])
@pytest.mark.parametrize("light", ["A", "D65", "9000K", "2000K"])
@pytest.mark.parametrize("sensor", SENSORS)
def test_both_routes_in_depth(oiiotool, repository, tmp_path, sensor, light, picture):
    check(oiiotool, repository, tmp_path, sensor, light, picture)


def test_the_sensors_have_the_bits_of_the_table(repository):
    for sensor, bits in SENSORS.items():
        path = repository / "plugins" / "profiles" / f"{sensor}.json"
        assert _core.load_profile(str(path)).bits == bits
