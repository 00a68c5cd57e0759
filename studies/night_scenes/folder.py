# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The folder of frames: names, what is done, and how a frame gets its name.

A frame is NAME.exr with its description NAME.json. It is rendered under another name,
and takes its own when it is complete, after its description: so what has the name of a
frame is one."""

import contextlib
import fcntl
import json
import os
from dataclasses import dataclass
from pathlib import Path

from .exr_file import complete_size

GENERATOR = 1  # raised when the same index no longer gives the same picture
LOCK = ".night_scenes.lock"


class Refused(Exception):
    """A reason for which nothing can go on, to be said in one line."""


@dataclass(frozen=True)
class Settings:
    """What all frames of a folder share: width in pixels (16:9), paths per pixel."""

    width: int
    samples: int

    @property
    def height(self):
        """Return the height in pixels."""
        return round(self.width * 9 / 16)

    def as_json(self):
        """Return what a description says of them."""
        return {"generator": GENERATOR, "width": self.width, "samples": self.samples}


def name(index):
    """Return a frame's name without its ending."""
    return f"night_{index:04d}"


class Folder:
    """A folder of frames that one run writes; use it in a with statement."""

    def __init__(self, path, settings):
        self.path, self.settings = Path(path), settings
        self.lock = None

    def __enter__(self):
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            # Kept open: the lock ends with the process, however that ends.
            self.lock = open(self.path / LOCK, "w")
        except OSError as error:
            raise Refused(f"{self.path}: {error.strerror}") from None
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self.lock.close()
            raise Refused(f"{self.path}: another run writes this folder") from None
        self.sweep()
        return self

    def __exit__(self, *_):
        self.sweep()
        with contextlib.suppress(OSError):
            os.unlink(self.path / LOCK)
        self.lock.close()

    def sweep(self):
        """Remove what runs left half-written."""
        for part in self.path.glob("night_*.part"):
            part.unlink(missing_ok=True)

    def frame(self, index):
        """Return the path of a frame."""
        return self.path / f"{name(index)}.exr"

    def part(self, index):
        """Return the path that a frame is rendered to."""
        return self.path / f"{name(index)}.exr.{os.getpid()}.part"

    def is_done(self, index):
        """Return whether the frame is there and complete.

        Raises Refused if it was made with other settings: a set must not be mixed."""
        path = self.frame(index)
        try:
            size = complete_size(path)
        except (OSError, ValueError):
            return False
        wanted = (self.settings.width, self.settings.height)
        if size != wanted:
            raise Refused(
                f"{path}: is {size[0]}x{size[1]}, not {wanted[0]}x{wanted[1]}: give "
                "another folder, or the same --width"
            )
        self.check_description(path.with_suffix(".json"))
        return True

    def check_description(self, path):
        """Raise Refused unless the description at @path has this run's settings."""
        try:
            found = json.loads(path.read_text())
        except (OSError, ValueError):
            return  # the picture alone is worth keeping
        for key, value in self.settings.as_json().items():
            if found.get(key) != value:
                raise Refused(
                    f"{path}: {key} is {found.get(key)}, not {value}: give another "
                    "folder, or remove the frames"
                )

    def accept(self, index, scene):
        """Give a rendered frame its name, its description first.

        Raises Refused if the file is not complete: mostly the disk is full."""
        part, frame = self.part(index), self.frame(index)
        text = json.dumps({**self.settings.as_json(), "scene": scene}, indent=1)
        try:
            complete_size(part)
            described = frame.with_suffix(".json.part")
            described.write_text(text + "\n")
            os.replace(described, frame.with_suffix(".json"))
            os.replace(part, frame)
        except OSError as error:
            raise Refused(f"{frame}: {error.strerror}") from None
        except ValueError as error:
            raise Refused(f"{frame}: {error}: {self.room()}") from None

    def room(self):
        """Say how much room is left, which explains most failures."""
        with contextlib.suppress(OSError):
            state = os.statvfs(self.path)
            return f"{state.f_bavail * state.f_frsize // 2**20} MiB are left there"
        return "the folder is gone"
