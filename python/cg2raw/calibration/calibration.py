# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Calibration: measurements, and the profile that follows from them."""

from dataclasses import dataclass

from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.updated_profile import updated_profile
from cg2raw.sensor import Sensor


@dataclass(frozen=True)
class Calibration(Measurements):
    """What calibrate found; see Measurements for its fields."""

    def updated_profile(self, sensor: Sensor | None = None) -> str:
        """Return the JSON of a sensor's profile with what was measured.

        sensor : in place of the one that was calibrated. The black level, the row of
        noise at the frames' ISO and effects that stand out are replaced; effects that
        were looked for and do not are taken out; all else stays.
        Raises ValueError naming field, value and bound."""
        return updated_profile(self, sensor or self.sensor)[0]

    def profile_notes(self) -> list[str]:
        """Return what stands out and cannot be written into a profile."""
        return updated_profile(self, self.sensor)[1]
