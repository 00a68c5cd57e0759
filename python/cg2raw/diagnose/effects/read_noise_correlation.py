# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Read noise correlation: the read noise of neighbours in a row correlates."""

from collections.abc import Mapping
from typing import Any

from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Parameter,
)
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.sensor import Sensor

SOFTENED = (
    "Darks, and flats from dim to bright: read noise correlates with the next pixel of "
    "the row in darks, and ever less in brighter flats; what a lens or a filter of the "
    "file softens stays as soft in flats, and does not know rows."
)


class ReadNoiseCorrelation(Effect):
    name = "read_noise_correlation"
    title = "read noise correlation"
    where = "neighbours in a row share read noise, most of all in darks"
    of_mean = False
    fitted = (Parameter("coefficient", -0.5, 0.5),)
    signature = frozenset({"noise"})
    told_apart = {"noise_reduction": SOFTENED, "blur": SOFTENED, "crosstalk": SOFTENED}

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        return listed_values(sensor, self.name)

    def size(self, values: Estimates) -> str:
        one = values["coefficient"]
        low, high = one.ci95
        return (
            f"correlation {one.value:.3g} ({low:.3g} to {high:.3g}) with the next "
            "pixel of the row"
        )


EFFECT = ReadNoiseCorrelation()
