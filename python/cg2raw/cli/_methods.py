# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""--method, under the same name wherever RAW is simulated."""

import argparse

METHODS = ("graphics2raw", "upi")
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
