# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""NoiseModel: the variance of a signal, and how its noise is drawn."""

from collections.abc import Mapping
from dataclasses import dataclass, field

LEAST_VARIANCE = 1e-12


@dataclass(frozen=True)
class NoiseModel:
    """variance(x) = beta1 x + beta2, x in 0..1 above black; one value a CFA site.

    beta2 : without that of rows, where the profile draws them.
    measured : False if it was estimated from the captures, and so proves nothing.
    drawn : how the profile says that noise is drawn beyond its variance: values of
        effects by name, in the units that are fitted.
    """

    beta1: tuple[float, ...]
    beta2: tuple[float, ...]
    measured: bool = True
    drawn: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
