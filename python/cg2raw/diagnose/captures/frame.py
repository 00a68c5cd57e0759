# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""A frame of a manifest: what its entry and its file say, as a capture."""

from dataclasses import dataclass

from cg2raw.diagnose.captures.capture import Capture
from cg2raw.diagnose.captures.manifest import FrameEntry
from cg2raw.diagnose.captures.patch_means import PatchMeans
from cg2raw.io.raw_header import RawFile, RawHeader


@dataclass(frozen=True)
class TableFile(RawFile):
    """A table of patch means in the place of a RAW file; it has no pixels to read."""

    means: PatchMeans


@dataclass(frozen=True)
class Frame:
    """A frame before it is divided: its Capture, and those of its masked borders."""

    entry: FrameEntry
    header: RawHeader
    capture: Capture
    borders: tuple[Capture, ...]
