# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The files of shots: patterns of their names, frame numbers, what is missing."""

import glob
import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

from cg2raw import _core

ENDINGS = (".exr", ".hdr", ".png", ".tif", ".tiff")  # of images in a folder
# %04d or %d as printf has them, # or @ for digits as compositors do.
PLACE = re.compile(r"%(?:0(?P<width>\d+))?d|(?P<marks>#+|@+)")
RANGE = re.compile(r"(\d+)(?:-(\d+)(?:x(\d+))?)?")
MOST_FRAMES = 10_000_000  # of one list


@dataclass(frozen=True)
class Name:
    """What stands before and after the frame number in a file's path."""

    before: str
    after: str
    number: int

    @property
    def shot(self) -> str:
        """The path of the shot as a pattern that inputs may be, for messages."""
        return f"{self.before}#{self.after}"


def is_pattern(path: str) -> bool:
    """Return whether a path names the files of a shot rather than one that is there."""
    return bool(PLACE.search(os.path.basename(path))) and not os.path.exists(path)


def name_of(path: str) -> Name | None:
    """Return the Name of a file, by the rule for frame numbers; None without one."""
    number = _core.frame_from_name(path)
    folder, base = os.path.split(path)
    runs = [m for m in re.finditer(r"[0-9]+", os.path.splitext(base)[0])]
    for run in reversed(runs):
        if number is not None and int(run[0]) == number:
            before = os.path.join(folder, base[: run.start()])
            return Name(before, base[run.end() :], number)
    return None


def numbered(pattern: str, number: int) -> str:
    """Return the path that a pattern has for a frame; one # or @ alone is 4 digits."""
    folder, base = os.path.split(pattern)

    def digits(place: re.Match[str]) -> str:
        marks = place["marks"]
        width = int(place["width"] or 1) if marks is None else len(marks)
        return str(number).zfill(4 if marks and width == 1 else width)

    return os.path.join(folder, PLACE.sub(digits, base, count=1))


def files_of(pattern: str) -> list[str]:
    """Return the files of a pattern, by frame number. Raises ValueError, OSError.

    #### and %04d are four digits or more, @@@ three or more; # or @ alone and %d are
    any."""
    folder, base = os.path.split(pattern)
    place = PLACE.search(base)
    assert place is not None  # it is a pattern
    marks = place["marks"]
    least = int(place["width"] or 1) if marks is None else len(marks)
    name = re.compile(
        re.escape(base[: place.start()])
        + (f"([0-9]{{{least}}}|[1-9][0-9]{{{least},}})" if least > 1 else "([0-9]+)")
        + re.escape(base[place.end() :])
    )
    found = [(name.fullmatch(file), file) for file in os.listdir(folder or os.curdir)]
    files = sorted((int(m[1]), file) for m, file in found if m)
    if not files:
        raise ValueError(f"{pattern}: no file of that name, with a number in it")
    return [os.path.join(folder, file) for _, file in files]


def expanded(inputs: Iterable[str]) -> list[str]:
    """Return the files that words name: files, patterns, globs, and folders' images.

    Raises ValueError, OSError for those that name none."""
    files: list[str] = []
    for word in inputs:
        if is_pattern(word):
            files += files_of(word)
        elif os.path.isdir(word):
            files += images_of(word)
        elif glob.has_magic(word) and not os.path.exists(word):
            found = sorted(glob.glob(word))
            if not found:
                raise ValueError(f"{word}: no file of that name")
            files += found
        else:
            files.append(word)
    return files


def images_of(folder: str) -> list[str]:
    """Return the images that lie in a folder, by name. Raises ValueError, OSError."""
    names = [
        name
        for name in sorted(os.listdir(folder))
        if name.lower().endswith(ENDINGS) and not name.startswith(".")
    ]
    if not names:
        raise ValueError(f"{folder}: has no image ({' '.join(ENDINGS)})")
    return [os.path.join(folder, name) for name in names]


def frame_list(words: str) -> list[int]:
    """Return the frames of 1001-1240, 1-100x2 or 1,3,5-9, rising. Raises ValueError."""
    frames: list[int] = []
    for word in words.split(","):
        match = RANGE.fullmatch(word.strip())
        if not match:
            raise ValueError(
                f"{words}: must be frames as 1001-1240, 1-100x2 or 1,3,5-9"
            )
        first, step = int(match[1]), int(match[3] or 1)
        last = int(match[2] or match[1])
        if last < first or step < 1 or (last - first) // step >= MOST_FRAMES:
            raise ValueError(f"{words}: {word.strip()} must rise, by at least 1")
        frames += range(first, last + 1, step)
    twice = sorted(frame for frame, count in Counter(frames).items() if count > 1)
    if twice:
        raise ValueError(f"{words}: frame {listed(twice)} is there twice; name it once")
    return sorted(frames)


def listed(frames: Sequence[int]) -> str:
    """Return rising numbers as people list them: 3, 7-9."""
    runs: list[list[int]] = []
    for frame in frames:
        if runs and frame == runs[-1][-1] + 1:
            runs[-1][1:] = [frame]
        else:
            runs.append([frame])
    return ", ".join("-".join(map(str, run)) for run in runs)


@dataclass(frozen=True)
class Shot:
    """The files of one shot, and what is wrong with them.

    files : {frame: path}. missing : frames between the first and the last, or of those
    that were asked for, that have no file. twice : {frame: paths} of those with
    several, which are not among the files."""

    name: str
    files: dict[int, str]
    missing: list[int]
    twice: dict[int, list[str]]

    @property
    def first(self) -> int:
        """The number of the first frame, also if it is missing."""
        return min([*self.files, *self.missing, *self.twice])

    def faults(self) -> Iterator[tuple[str, str]]:
        """Yield (file or shot, what is wrong with it), one line each."""
        if self.missing:
            several = len(self.missing) > 1
            yield (
                self.name,
                f"frame{'s' if several else ''} {listed(self.missing)} "
                f"{'are' if several else 'is'} missing",
            )
        for frame, paths in self.twice.items():
            others = ", ".join(os.path.basename(path) for path in paths[1:])
            yield (
                paths[0],
                f"is frame {frame}, as {others} is; neither is done: keep one",
            )


def shots_of(paths: Iterable[str], frames: Collection[int] | None) -> list[Shot]:
    """Return the Shots among files with numbers, in the order of their first files.

    frames : those that are asked for; None for all."""
    groups: dict[str, dict[int, list[str]]] = {}
    for path in paths:
        name = name_of(path)
        if name and (frames is None or name.number in frames):
            groups.setdefault(name.shot, {}).setdefault(name.number, []).append(path)
    return [shot_of(name, group, frames) for name, group in groups.items()]


def shot_of(
    name: str, group: dict[int, list[str]], frames: Collection[int] | None
) -> Shot:
    """Return the Shot of files by number."""
    wanted = range(min(group), max(group) + 1) if frames is None else frames
    return Shot(
        name=name,
        files={n: group[n][0] for n in sorted(group) if len(group[n]) == 1},
        missing=[n for n in wanted if n not in group],
        twice={n: group[n] for n in sorted(group) if len(group[n]) > 1},
    )
