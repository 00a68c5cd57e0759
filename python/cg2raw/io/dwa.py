# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""DWA-compressed EXRs: the same pixels at every reading.

OpenEXR's C library chooses what decodes DWA when a process first does so. While one
thread chooses, others decode by what is slower and rounds otherwise: once in some
hundred processes, pixels of the first rows are off by a half float's last bits."""

import threading
from typing import Any

_chosen = threading.Event()
_choosing = threading.Lock()


def choose_decoder(source: Any, spec: Any) -> None:
    """Decode a row, or a tile, of an open ImageInput alone, if it is compressed so and
    nothing was decoded before in this process. @source stays where it is, and what is
    wrong with the file is left to who reads all of it."""
    if not spec.get_string_attribute("compression").startswith("dwa"):
        return
    with _choosing:
        if _chosen.is_set():
            return
        x, y, z = spec.x, spec.y, spec.z
        if spec.tile_width:
            right = x + min(spec.tile_width, spec.width)
            below = y + min(spec.tile_height, spec.height)
            found = source.read_tiles(x, right, y, below, z, z + 1, 0, 1, "half")
        else:
            found = source.read_scanlines(y, y + 1, z, 0, 1, "half")
        source.geterror()  # none of this row's is left for who reads on
        if found is not None:
            _chosen.set()
