# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What people call a camera."""

import re


def camera_name(make: str, model: str) -> str:
    """Return the first word of a make, then the model, which may begin with that word
    already, in any case: "NIKON CORPORATION", "NIKON D40" is a "NIKON D40"."""
    brand = (make.split() or [""])[0]
    said = re.match(rf"{re.escape(brand)}(?!\w)", model, re.IGNORECASE)
    return model if said else f"{brand} {model}".strip()
