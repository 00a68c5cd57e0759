# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""--method and --convention, under the same names wherever RAW is simulated."""

import argparse

METHODS = ("graphics2raw", "upi")
CONVENTIONS = ("dng", "paper", "sensor", "spectral")
FORMER = {"g2r": "graphics2raw"}  # what `cg2raw convert` called it at first


def add_method(group: argparse._ArgumentGroup) -> None:
    """Declare --method."""
    group.add_argument(
        "--method",
        type=lambda word: FORMER.get(word, word),
        choices=METHODS,
        default=METHODS[0],
        help="graphics2raw (default): the sensor under its own lights (Seo et al., "
        "2023); upi: drawn matrix and white balance (Brooks et al., 2019)",
    )


def add_convention(group: argparse._ArgumentGroup, default: str | None) -> None:
    """Declare --convention. default : its value where it is not given."""
    group.add_argument(
        "--convention",
        choices=CONVENTIONS,
        default=default,
        help="dng (default): the inverse of a DNG renderer; paper: as published; "
        "sensor: clips and has noise as a camera; spectral: sensor, by spectra",
    )
