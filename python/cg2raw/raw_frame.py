# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""RawFrame: DN with the simulation that made them."""

from typing import Any

import numpy as np

from cg2raw import _core


class RawFrame(np.ndarray[Any, np.dtype[np.uint16]]):
    """(H, W) uint16 DN that remembers the simulation it came from.

    DN may be altered before they are written: what keeps the shape keeps `simulation`.
    A piece of another shape has none. write_dng refuses that, and flipped or transposed
    views, whose CFA would be another."""

    simulation: _core.Simulation | None = None

    def __array_finalize__(self, source: Any) -> None:
        same = source is not None and source.shape == self.shape
        self.simulation = getattr(source, "simulation", None) if same else None

    def __reduce__(self) -> Any:
        reduced: Any = super().__reduce__()
        make, arguments, state = reduced
        return make, arguments, (state, self.simulation)

    def __setstate__(self, state: Any) -> None:
        of_array, simulation = state
        super().__setstate__(of_array)
        self.simulation = simulation
