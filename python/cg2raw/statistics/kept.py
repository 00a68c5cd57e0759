# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Kept: frames that are read once, as long as they fit."""

import threading
from collections.abc import Callable

from cg2raw.arrays import RawImage, raw_plane

Reader = Callable[[], RawImage]  # () -> (H, W) uint16 DN
BYTES = 2**27  # that are kept


class Kept:
    """Keeps the first frames that are read, up to a number of bytes."""

    def __init__(self, most: int = BYTES) -> None:
        self._left = most
        self._guard = threading.Lock()

    def reader(self, read: Reader) -> Reader:
        """Return a reader that reads again what is not kept; it raises ValueError for
        what is no (H, W) array of uint16. One of a Kept is returned as it is."""
        return read if isinstance(read, _KeptReader) else _KeptReader(self, read)

    def has_room(self, raw: RawImage) -> bool:
        """Return whether a frame fits, and take its bytes."""
        with self._guard:
            fits = raw.nbytes <= self._left
            self._left -= raw.nbytes * fits
            return fits


class _KeptReader:
    def __init__(self, kept: Kept, read: Reader) -> None:
        self._kept, self._read = kept, read
        self._frame: RawImage | None = None

    def __call__(self) -> RawImage:
        if self._frame is not None:
            return self._frame
        raw = raw_plane(self._read())
        if self._frame is None and self._kept.has_room(raw):
            self._frame = raw
        return raw
