# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor's numbers from darks and flats, by photon transfer.

calibrate(sensor, frames) measures, in the physical order of EMVA Standard 1288, release
4.0, black level and its structure, temporal noise, dark current, gain, and the response
to uniform light; the Calibration that it returns writes them into a profile.
"""

from cg2raw.calibration.calibrate import calibrate
from cg2raw.calibration.calibration import Calibration
from cg2raw.calibration.frames import UniformFrame
from cg2raw.calibration.measured import Measured

__all__ = ["Calibration", "Measured", "UniformFrame", "calibrate"]
