# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The files of shots: patterns of their names, frame numbers, what is missing."""

import glob
import math
import os
import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from cg2raw import _core

ENDINGS = (".exr", ".hdr", ".png", ".tif", ".tiff")  # of images in a folder
# %04d or %d as printf has them, # or @ for digits as compositors do.
PLACE = re.compile(r"%(?:0(?P<width>\d+))?d|(?P<marks>#+|@+)")
RANGE = re.compile(r"(-?[0-9]+)(?:-(-?[0-9]+)(?:x([0-9]+))?)?")
MOST_DIGITS = 18  # of a frame number, as frame_name in scene_file.h has it
MOST_LISTED = 20  # ranges that a message lists


def is_pattern(path: str) -> bool:
    """Return whether a path names the files of a shot rather than one that is there."""
    return bool(PLACE.search(os.path.basename(path))) and not os.path.exists(path)


def numbered(pattern: str, number: int) -> str:
    """Return the path that a pattern has for a frame; one # or @ alone is 4 digits.

    A sign stands before the digits of # and @; %04d counts it, as printf does."""
    folder, base = os.path.split(pattern)

    def digits(place: re.Match[str]) -> str:
        marks = place["marks"]
        if marks is None:
            return f"{number:0{int(place['width'] or 1)}d}"
        width = 4 if len(marks) == 1 else len(marks)
        return f"{'-' if number < 0 else ''}{abs(number):0{width}d}"

    return os.path.join(folder, PLACE.sub(digits, base, count=1))


def files_of(pattern: str) -> list[str]:
    """Return the files of a pattern, by frame number. Raises ValueError, OSError.

    #### and %04d are four digits or more, @@@ three or more; # or @ alone and %d are
    any. Numbers below 0 have a sign before them, which may count as a digit."""
    folder, base = os.path.split(pattern)
    place = PLACE.search(base)
    assert place is not None  # it is a pattern
    marks = place["marks"]
    least = int(place["width"] or 1) if marks is None else len(marks)
    digits, signed = "[0-9]+", "-[0-9]+"
    if least > 1:
        longer = f"[1-9][0-9]{{{least},}}"
        digits = f"[0-9]{{{least}}}|{longer}"
        signed = f"-(?:[0-9]{{{least - 1},{least}}}|{longer})"
    below = _core.frame_name(f"{base[: place.start()]}-1.exr")
    if below is not None and below.number < 0:  # the - is a sign
        digits = f"{digits}|{signed}"
    before, after = re.escape(base[: place.start()]), re.escape(base[place.end() :])
    name = re.compile(f"{before}({digits}){after}")
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


def frame_list(words: str) -> list[range]:
    """Return the frames of 1001-1240, 1-100x2 or -3,1,5-9, rising and apart.

    Raises ValueError."""
    frames = sorted(
        (frame_range(word.strip(), words) for word in words.split(",")),
        key=lambda part: part[0],
    )
    twice, ended = [], list[range]()
    for part in frames:
        ended = [other for other in ended if other[-1] >= part[0]]
        twice += [both for other in ended if (both := common(other, part))]
        ended.append(part)
    if twice:
        raise ValueError(f"{words}: frame {listed(twice)} is there twice; name it once")
    return joined(frames)


def frame_range(word: str, words: str) -> range:
    """Return the frames of one word among @words. Raises ValueError."""
    match = RANGE.fullmatch(word)
    if not match:
        raise ValueError(f"{words}: must be frames as 1001-1240, 1-100x2 or -3,1,5-9")
    texts = (match[1], match[2] or match[1], match[3] or "1")
    if any(len(text.lstrip("-")) > MOST_DIGITS for text in texts):
        raise ValueError(f"{words}: a frame number has at most {MOST_DIGITS} digits")
    first, last, step = map(int, texts)
    if last < first:
        raise ValueError(f"{words}: {word} must rise, as {last}-{first}")
    if step < 1:
        raise ValueError(f"{words}: the step of {word} must be at least 1")
    return range(first, last + 1, step)


def common(one: range, other: range) -> range:
    """Return the frames that are in both ranges."""
    shared = math.gcd(one.step, other.step)
    steps, rest = divmod(other[0] - one[0], shared)
    if rest:
        return range(0)
    whole, turn = one.step // shared * other.step, other.step // shared
    first = one[0] + steps * pow(one.step // shared, -1, turn) % turn * one.step
    least = max(one[0], other[0])
    first += -((first - least) // whole) * whole
    return range(first, min(one[-1], other[-1]) + 1, whole)


def joined(frames: Iterable[range]) -> list[range]:
    """Return rising ranges, those that follow on each other as one."""
    runs: list[range] = []
    for part in frames:
        part = part if len(part) > 1 else range(part[0], part[0] + 1)
        if runs and part.step == runs[-1].step == 1 and part[0] == runs[-1].stop:
            part = range(runs.pop()[0], part.stop)
        runs.append(part)
    return runs


def listed(frames: Iterable[range]) -> str:
    """Return rising ranges as --frames takes them: 3, 7-9, 11-19x2."""
    runs = joined(frames)
    words = [
        str(run[0])
        if len(run) == 1
        else f"{run[0]}-{run[-1]}" + (f"x{run.step}" if run.step > 1 else "")
        for run in runs[:MOST_LISTED]
    ]
    more = sum(len(run) for run in runs[MOST_LISTED:])
    return ", ".join(words) + (f" and {more} more" if more else "")


def without(frames: Iterable[range], there: Iterable[int]) -> list[range]:
    """Return rising ranges without some frames."""
    numbers, rest = sorted(there), []
    for part in frames:
        start = 0
        first = bisect_left(numbers, part[0])
        for number in numbers[first : bisect_right(numbers, part[-1])]:
            if number in part:
                place = part.index(number)
                rest.append(part[start:place])
                start = place + 1
        rest.append(part[start:])
    return [part for part in rest if part]


@dataclass(frozen=True)
class Shot:
    """The files of one shot, and what is wrong with them.

    files : {frame: path}. missing : frames between the first and the last, or of those
    that were asked for, that have no file. twice : {frame: paths} of those with
    several, which are not among the files."""

    name: str
    files: dict[int, str]
    missing: list[range]
    twice: dict[int, list[str]]

    @property
    def first(self) -> int:
        """The number of the first frame, also if it is missing."""
        return min([*self.files, *self.twice, *(part[0] for part in self.missing)])

    def faults(self) -> Iterator[tuple[str, str]]:
        """Yield (file or shot, what is wrong with it), one line each."""
        if self.missing:
            several = len(self.missing) > 1 or len(self.missing[0]) > 1
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


def shots_of(paths: Iterable[str], frames: Sequence[range] | None) -> list[Shot]:
    """Return the Shots among files with numbers, in the order of their first files.

    frames : those that are wanted, as of frame_list; None for all."""
    groups: dict[str, dict[int, list[str]]] = {}
    for path in paths:
        name = _core.frame_name(path)
        if name and (frames is None or any(name.number in part for part in frames)):
            shot = groups.setdefault(f"{name.before}#{name.after}", {})
            shot.setdefault(name.number, []).append(path)
    return [shot_of(name, group, frames) for name, group in groups.items()]


def shot_of(
    name: str, group: dict[int, list[str]], frames: Sequence[range] | None
) -> Shot:
    """Return the Shot of files by number."""
    wanted = [range(min(group), max(group) + 1)] if frames is None else frames
    return Shot(
        name=name,
        files={n: group[n][0] for n in sorted(group) if len(group[n]) == 1},
        missing=without(wanted, group),
        twice={n: group[n] for n in sorted(group) if len(group[n]) > 1},
    )
