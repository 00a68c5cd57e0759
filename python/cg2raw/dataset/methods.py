# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Methods by which an image becomes RAW."""

from cg2raw.sensor import Sensor

# name : (sensor, shape, **run) -> what Sensor.simulation returns
METHODS = {"graphics2raw": Sensor.simulation}
