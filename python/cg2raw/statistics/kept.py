# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Kept: frames that are read once, as long as they fit."""

import threading
from collections.abc import Callable

from cg2raw.arrays import RawImage, raw_plane

Reader = Callable[[], RawImage]  # () -> (H, W) uint16 DN
BYTES = 2**28  # that are kept


class Kept:
    """Keeps the first frames that are read, up to a number of bytes."""

    def __init__(self, most: int = BYTES) -> None:
        self._left = most
        self._guard = threading.Lock()

    def reader(self, read: Reader) -> Reader:
        """Return a reader that reads again what is not kept; it raises ValueError for
        what is no (H, W) array of uint16."""
        found: list[RawImage] = []

        def frame() -> RawImage:
            if found:
                return found[0]
            raw = raw_plane(read())
            with self._guard:
                if not found and raw.nbytes <= self._left:
                    self._left -= raw.nbytes
                    found.append(raw)
            return raw

        return frame
