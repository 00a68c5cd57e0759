# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pixels of any type as DN."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_DN = 65535


def whole_dn(
    path: str, plane: NDArray[Any], pedestal: float = 0.0
) -> NDArray[np.float64]:
    """Return pixels less a pedestal. Raises ValueError for the first that is no DN."""
    without = plane.astype(np.float64) - pedestal
    with np.errstate(invalid="ignore"):
        wrong = ~((without >= 0) & (without <= MOST_DN) & (without == np.rint(without)))
    if wrong.any():
        row, col = np.argwhere(wrong)[0]
        less = f" without its PEDESTAL of {pedestal:g} DN" if pedestal else ""
        raise ValueError(
            f"{path}: {np.count_nonzero(wrong)} pixels are no DN, the first in stored "
            f"row {row}, column {col}: {without[row, col]:g}{less}; must be whole "
            f"numbers, 0 to {MOST_DN}: give the frame as the camera took it, not "
            "calibrated"
        )
    return without
