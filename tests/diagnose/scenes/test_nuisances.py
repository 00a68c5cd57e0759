# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is not known of captures: how far it may be off, and whose it is."""

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.scenes.nuisances import SLOPE, laplacian, nuisances_of, wings
from diagnose.planted import capture_of, frames_of, sensor_of

SENSOR = sensor_of()


def nuisances(kind="scene", n=1, **given):
    capture = capture_of(kind, 1, shape=(48, 60))
    [frame] = frames_of(SENSOR, [capture])
    found = nuisances_of(CaptureSet(SENSOR, [capture], **given), frame, n)
    return {one.name: one for one in found}


@pytest.mark.parametrize("frames", [1, 4])
@pytest.mark.parametrize(("declared", "each"), [({}, 0.005), ({"light": 0.03}, 0.03)])
def test_light_that_jitters_is_a_frame_s_own(frames, declared, each):
    """The mean of four frames is off by half as much as one."""
    given = {"nuisances": frozenset({"light"}), "uncertainty": declared}
    [light] = nuisances(n=frames, **given).values()
    assert light.own and light.deviation == pytest.approx(each / np.sqrt(frames))


def test_a_smooth_error_is_of_a_set_and_less_the_finer_it_is():
    found = nuisances(nuisances=frozenset({"radiance"}))
    assert not any(one.own for one in found.values())
    assert len(found) == 27  # products of polynomials of up to degree 6 in all
    assert found["field 0 1"].deviation == pytest.approx(0.01)
    assert found["field 2 3"].deviation == pytest.approx(0.002)


def test_slopes_and_laplacians_are_those_of_polynomials():
    """Exact up to the sixth degree, and up to the third."""
    steps = np.arange(-3.0, 4.0)
    assert [SLOPE @ steps**n for n in range(7)] == pytest.approx([0, 1, 0, 0, 0, 0, 0])
    y, x = np.mgrid[-4:5, -4:5].astype(float)
    camera = (3 * y**2 + 2 * y**3 + 5 * x**2 + 7 * x * y + x + 4)[None, None]
    inner = laplacian(camera)[0, 0, 1:-1, 1:-1]
    assert inner == pytest.approx((2 * (3 + 5) + 12 * y)[1:-1, 1:-1])


def test_wings_of_a_point_fall_with_the_third_power_and_keep_its_light():
    camera = np.zeros((1, 1, 161, 161))
    camera[..., 80, 80] = 1
    point = wings(camera)[0, 0]
    assert point[80, 80] == pytest.approx(-1)
    near, far = point[80, [68, 92]], point[[56, 104], 80]  # 12 and 24 px away
    assert near == pytest.approx(8 * far) and (far > 0).all()
    assert point[80, 81:90] == pytest.approx(0) and point.sum() == pytest.approx(0)
    everywhere = wings(np.full((1, 3, 20, 30), 0.7))
    assert everywhere == pytest.approx(0)  # to the borders


def test_darks_have_none():
    every = frozenset({"light", "radiance", "registration", "exposure"})
    assert nuisances("dark", nuisances=every) == {}
