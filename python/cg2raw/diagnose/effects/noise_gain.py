# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""NoiseGain: the family of effects that multiply a variance of the noise table."""

from typing import Any, ClassVar

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Estimates, Values


class NoiseGain(Effect):
    """Its value is the log of a factor of one of the betas of the noise model."""

    step: ClassVar[float] = 0.01
    signature: ClassVar[frozenset[str]] = frozenset({"noise"})
    in_photon_transfer: ClassVar[bool] = True

    def change_noise_table(self, profile: dict[str, Any], values: Values) -> bool:
        factor = float(np.exp(values[0]))
        for row in profile.get("noise", []):
            beta = row[self.scales]
            row[self.scales] = (
                [b * factor for b in beta] if isinstance(beta, list) else beta * factor
            )
        return True

    def size(self, values: Estimates) -> str:
        (estimate,) = values.values()
        low, high = np.exp(estimate.ci95)
        return (
            f"variance is {np.exp(estimate.value):.4g} times the profile's "
            f"({low:.4g} to {high:.4g})"
        )
