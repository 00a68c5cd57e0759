# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is not known of captures: how far it may be off, and whose it is."""

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.scenes.nuisances import nuisances_of
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


def test_darks_have_none():
    every = frozenset({"light", "radiance", "registration", "exposure"})
    assert nuisances("dark", nuisances=every) == {}
