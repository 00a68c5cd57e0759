# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The OpenImageIO module, imported when an image is read."""

from types import ModuleType

MISSING = "OpenImageIO is not installed for this Python: pip install OpenImageIO"


def openimageio() -> ModuleType:
    """Return the module OpenImageIO. Raises ValueError if it is not installed."""
    try:
        import OpenImageIO
    except ImportError:
        raise ValueError(MISSING) from None
    return OpenImageIO


def one_line(text: str) -> str:
    """Return a message of OpenImageIO in one line, which it may repeat."""
    lines = dict.fromkeys(" ".join(line.split()) for line in text.splitlines())
    return " ".join(lines).strip() or "cannot be read"
