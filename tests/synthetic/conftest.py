# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The sensor that tests of the generator hide effects in, and its camera."""

import pytest

from cg2raw.synthetic.camera import camera_of
from cg2raw.synthetic.sensors import ISO, drawn_sensor


@pytest.fixture(scope="package")
def sensor():
    return drawn_sensor(3)


@pytest.fixture(scope="package")
def camera(sensor):
    return camera_of(sensor, "D65", ISO)
