# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measured reflectances of objects, halved.

IES TM-30-15's 4880 objects where luxpy's data files are found, else those that
colour-science has: CIE 224's, PhotoResearch's and the ColorChecker's."""

from pathlib import Path

import numpy as np

from studies.spectra.data import (
    SAME,
    distance,
    read_reflectances,
    reflectance_sets,
    usable,
)
from studies.world.colorimetry import Array
from studies.world.halves import Half, halved

TM30 = Path("rfls") / "IESTM30_15_R4880.npz"
DARKEST, BRIGHTEST = 0.003, 0.98
KEY = 1  # of the halves


def reflectances(luxpy: Path | None) -> dict[Half, Array]:
    """Return reflectances (n, 81) of each half.

    luxpy : its folder of data files, or None. Left out: what is almost black, what
    stands there twice, the Academy's 190, to which profiles and convention spectral
    were fitted, and of the training half what a test reflectance almost is.
    Raises ValueError for a file that is no good."""
    if luxpy is None:
        rows = np.concatenate(list(reflectance_sets([])[0].values()))
    else:
        rows, _ = usable(read_reflectances(luxpy / TM30))
    rows = rows.clip(DARKEST, BRIGHTEST)
    parts = halved(len(rows), KEY)
    train, test = (rows[parts[half]] for half in ("train", "test"))
    return {"train": train[distance(train, test) > SAME], "test": test}
