# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shots on the command line: which files they have, and what each frame says of them.

Files are shots if a pattern, --frames, --framerate or --timecode says so; else nothing
is asked of their numbers."""

import argparse
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from cg2raw import _core
from cg2raw.cli._outputs import check_apart, check_folder, outputs_of
from cg2raw.io import frame_files
from cg2raw.io.frame_files import Shot
from cg2raw.short_messages import words_of

CODE = re.compile(r"\d\d:\d\d:\d\d[:;]\d\d")  # a time code, in messages


def add_shot(group: argparse._ArgumentGroup) -> None:
    """Declare the options of shots."""
    add = group.add_argument
    add("--frames", metavar="LIST", help="1001-1240, 1-100x2, -3,1,5-9; default: all")
    add(
        "--framerate",
        metavar="FPS",
        help="24, 23.976, 24000/1001 ...; default: FramesPerSecond of the files",
    )
    add("--timecode", metavar="HH:MM:SS:FF", help="of the first frame; ; drops frames")
    add("--reel", metavar="NAME", help="ReelName of all frames")
    add("--camera-label", metavar="NAME", help="CameraLabel of all frames")
    add(
        "--shading",
        choices=("tagged", "baked"),
        help="lens shading undone by GainMaps, or left in; default: baked in shots",
    )


@dataclass
class Frames:
    """What is to be done.

    files : inputs in order. said : {input: fields of write_dng's shot}. faults : (file
    or shot, the line that says what is wrong), of what cannot be done."""

    files: list[str]
    said: dict[str, dict[str, Any]] = field(default_factory=dict)
    faults: list[tuple[str, str]] = field(default_factory=list)


def frames_asked(arguments: argparse.Namespace) -> Frames:
    """Return the Frames of a command line. Raises ValueError, OSError."""
    labels = labels_of(arguments)
    files = frame_files.expanded(arguments.inputs)
    wanted = None
    if arguments.frames is not None:
        wanted = named("--frames", frame_files.frame_list, arguments.frames)
    patterns = any(frame_files.is_pattern(word) for word in arguments.inputs)
    if wanted is None and not (patterns or arguments.framerate or arguments.timecode):
        return Frames(files, dict.fromkeys(files, labels))
    shots = frame_files.shots_of(files, wanted)
    others = [path for path in files if _core.frame_name(path) is None]
    if wanted is not None and (others or not shots):
        raise ValueError(
            f"--frames {arguments.frames}: "
            + (
                f"{others[0]} has no frame number"
                if others
                else "no file has one of these"
            )
        )
    frames = Frames([path for shot in shots for path in shot.files.values()] + others)
    frames.faults = [
        (what, f"{what}: {text}") for shot in shots for what, text in shot.faults()
    ]
    rate = check_headers(frames, arguments)
    codes = time_codes(arguments.timecode, rate, shots, others)
    for path in frames.files:
        frames.said[path] = {**labels, **codes.get(path, {})}
    return frames


def named(option: str, parse: Any, words: str) -> Any:
    """Return parse(words); its ValueError begins with the option."""
    try:
        return parse(words)
    except ValueError as error:
        raise ValueError(f"{option}: {error}") from None


def labels_of(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return what all frames say alike. Raises ValueError."""
    labels: dict[str, Any] = {}
    if arguments.framerate is not None:
        labels["frame_rate"] = named(
            "--framerate", _core.frame_rate_text, arguments.framerate
        )
    if arguments.reel is not None:
        labels["reel_name"] = arguments.reel
    if arguments.camera_label is not None:
        labels["camera_label"] = arguments.camera_label
    return labels


def check_headers(frames: Frames, arguments: argparse.Namespace) -> str:
    """Return the rate of all @frames, perhaps empty, and take out those that cannot be
    read or lack --layer. Raises ValueError for two rates."""
    rates: dict[str, list[str]] = {}
    bad: dict[str, list[tuple[str, str]]] = {}  # alike but for path and time code
    for path in frames.files:
        try:
            rate = checked_rate(path, arguments)
        except (ValueError, OSError) as error:
            text = words_of(error)
            text = text if path in text else f"{path}: {text}"
            bad.setdefault(CODE.sub("", text.replace(path, "")), []).append(
                (path, text)
            )
        else:
            rates.setdefault(rate, []).append(path)
    for group in bad.values():
        path, text = group[0]
        frames.faults.append((path, text + also(group)))
        lost = {path for path, _ in group}
        frames.files = [path for path in frames.files if path not in lost]
    if arguments.framerate is not None:
        return str(_core.frame_rate_text(arguments.framerate))
    if len(rates) > 1:
        raise ValueError(
            "the files have different frame rates, "
            + ", ".join(
                f"{rate or 'none'} in {p[0]}{also(p)}" for rate, p in rates.items()
            )
            + ": say --framerate, or convert them apart"
        )
    return next(iter(rates), "")


def checked_rate(path: str, arguments: argparse.Namespace) -> str:
    """Return the frame rate in a file's header. Raises ValueError, OSError.

    The file must have --layer, and its time code be one at its rate or --framerate."""
    from cg2raw.io.image_file import stated_shot

    said = stated_shot(path, arguments.layer)
    stated = str(said["frame_rate"])
    if arguments.framerate is not None:
        said["frame_rate"] = arguments.framerate
    shot = _core.Shot(**said)
    if shot.time_code and shot.frame_rate and arguments.timecode is None:
        _core.advanced_time_code(shot.time_code, shot.frame_rate, 0)
    return stated


def also(files: Sequence[Any]) -> str:
    """Return how many files there are beside the first."""
    return f" (and {len(files) - 1} more files)" if len(files) > 1 else ""


def time_codes(
    first: str | None, rate: str, shots: Iterable[Shot], others: Iterable[str]
) -> dict[str, dict[str, str]]:
    """Return {file: {"time_code"}}: by its number from the first of its shot; others by
    their place. Raises ValueError."""
    if first is None:
        return {}
    if not rate:
        raise ValueError(
            f"--timecode {first}: counts how many frames a second? Add --framerate 24, "
            "or whatever it is"
        )
    named("--timecode", lambda word: _core.advanced_time_code(word, rate, 0), first)
    places = {path: n for n, path in enumerate(others)}
    for shot in shots:
        places |= {path: n - shot.first for n, path in shot.files.items()}
    return {
        path: {"time_code": _core.advanced_time_code(first, rate, place)}
        for path, place in places.items()
    }


def outputs_of_shot(files: Sequence[str], output: str) -> list[str]:
    """Return the path for each of @files: by a pattern as raw/shot.####.dng, or as
    outputs_of does. Raises ValueError."""
    if not files:
        return []
    if not frame_files.is_pattern(output):
        return outputs_of(files, output, ".dng")
    if not output.lower().endswith(".dng"):
        raise ValueError(f"-o {output}: must end in .dng, or be a folder")
    check_folder(os.path.dirname(output) or os.curdir)
    outputs = []
    for path in files:
        name = _core.frame_name(path)
        if name is None:
            raise ValueError(f"-o {output}: {path} has no frame number")
        outputs.append(frame_files.numbered(output, name.number))
        made = _core.frame_name(outputs[-1])
        if name.number < 0 and (made is None or made.number != name.number):
            raise ValueError(
                f"-o {output}: frame {name.number} would become {outputs[-1]}, whose - "
                "is no sign: put a dot before the number"
            )
    check_apart(files, outputs)
    return outputs
