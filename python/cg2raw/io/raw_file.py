# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Open a RAW frame of any format: one table, for all that read frames."""

from collections.abc import Callable

from cg2raw.io import fits_file, grey_file, libraw, npy_file
from cg2raw.io.raw_header import RawFile

# (whether a file is of the format, its frames), the first that holds counts.
FORMATS: tuple[
    tuple[Callable[[str], bool], Callable[[str, str | None], list[RawFile]]], ...
] = (
    (fits_file.is_fits, fits_file.frames),
    (npy_file.is_npy, npy_file.frames),
    (npy_file.is_npz, npy_file.frames_of_npz),
    (grey_file.is_grey, grey_file.frames),
    (libraw.is_dng, libraw.dng),
    (lambda path: True, libraw.camera_raw),
)


def frames_in(path: str, image: str | None = None) -> list[RawFile]:
    """Return the frames that a file holds, at least one.

    image : name or number of one of several images in the file, or "all", if that is
    not clear. Raises ValueError that says what is wrong and what to do, OSError."""
    return next(frames for holds, frames in FORMATS if holds(path))(path, image)


def open_raw(path: str, image: str | None = None) -> RawFile:
    """Return the one frame of a file; else as frames_in."""
    found = frames_in(path, image)
    if len(found) > 1:
        raise ValueError(
            f"{path}: holds {len(found)} frames, {found[0].header.name} the first; "
            "must be one frame: save each as a file of its own"
        )
    return found[0]
