# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Options that say of images what their files do not."""

import argparse


def add_encoding(group: argparse._ArgumentGroup) -> None:
    """Declare the options on what the numbers of an image mean."""
    add = group.add_argument
    add("--iscolorspace", metavar="NAME", help="of the pixels, whatever the file says")
    add(
        "--linearize",
        choices=("srgb",),
        help="undo sRGB's curve: in pictures that are sRGB, or whole numbers that "
        "state no colour space",
    )
