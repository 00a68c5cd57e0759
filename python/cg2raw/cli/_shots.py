# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shots on the command line: which files they have, and what each frame says of them.

Files are shots if a pattern, --frames, --framerate or --timecode says so; else nothing
is asked of their numbers."""

import argparse
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from cg2raw import _core
from cg2raw.cli._numbers import number_list
from cg2raw.cli._outputs import check_apart, check_folder, outputs_of
from cg2raw.io import frame_files
from cg2raw.io.frame_files import Shot
from cg2raw.short_messages import words_of

if TYPE_CHECKING:  # only a conversion loads its modules
    from cg2raw.conversion import Request

CODE = re.compile(r"\d\d:\d\d:\d\d[:;]\d\d")  # a time code, in messages


@dataclass
class Frames:
    """What is to be done.

    files : inputs in order. places : {input: frames from the first of its shot}, where
    a time code counts them. faults : (file or shot, the line that says what is wrong),
    of what cannot be done."""

    files: list[str]
    places: dict[str, int] = field(default_factory=dict)
    faults: list[tuple[str, str]] = field(default_factory=list)


def resolve_inputs(arguments: argparse.Namespace, request: "Request") -> Frames:
    """Return the Frames of a command line. Raises ValueError, OSError."""
    files = frame_files.expanded(arguments.inputs)
    wanted = None
    if arguments.frames is not None:
        wanted = named("--frames", frame_files.frame_list, arguments.frames)
    patterns = any(frame_files.is_pattern(word) for word in arguments.inputs)
    is_shot = patterns or {"framerate", "timecode"} & request.options.keys()
    if wanted is None and not is_shot:
        return Frames(files)
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
    if "timecode" in request.options:
        frames.places = places_in(shots, others)
    check_headers(frames, request)
    return frames


def named(option: str, parse: Any, words: str) -> Any:
    """Return parse(words); its ValueError begins with the option."""
    try:
        return parse(words)
    except ValueError as error:
        raise ValueError(f"{option}: {error}") from None


def check_headers(frames: Frames, request: "Request") -> None:
    """Take out those of @frames that cannot be read, or not as the options say.

    Raises ValueError for two frame rates."""
    from cg2raw.conversion import stated_shot

    rates: dict[str, list[str]] = {}
    bad: dict[str, list[tuple[str, str]]] = {}  # alike but for path and time code
    for path in frames.files:
        try:
            own = replace(request, place=frames.places.get(path))
            rate = stated_shot(path, own).frame_rate or ""
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
    if len(rates) > 1:
        raise ValueError(
            "the files have different frame rates, "
            + ", ".join(
                f"{rate or 'none'} in {p[0]}{also(p)}" for rate, p in rates.items()
            )
            + ": say --framerate, or convert them apart"
        )


def also(files: Sequence[Any]) -> str:
    """Return how many files there are beside the first."""
    return f" (and {len(files) - 1} more files)" if len(files) > 1 else ""


def places_in(shots: Iterable[Shot], others: Iterable[str]) -> dict[str, int]:
    """Return {file: frames from the first of its shot}; others by their order."""
    places = {path: n for n, path in enumerate(others)}
    for shot in shots:
        places |= {path: n - shot.first for n, path in shot.files.items()}
    return places


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


def bracket_outputs(
    outputs: Sequence[str], bracket: str | None
) -> dict[str, tuple[str, str | None]]:
    """Return {file: (output, stops of the bracket, None without one)}; a bracket has
    its stops in the names of its files, before the frame number of a shot.

    bracket : "-2,0,2". Raises ValueError."""
    if bracket is None:
        return {output: (output, None) for output in outputs}
    steps = number_list("--bracket", bracket)
    return {
        bracket_name(output, step): (output, f"{step:g}")
        for output in outputs
        for step in steps
    }


def bracket_name(output: str, stops: float) -> str:
    """Return "raw/a_ev+2.dng" of "raw/a.dng", "raw/a_ev+2.0007.dng" of
    "raw/a.0007.dng"."""
    name = _core.frame_name(output)
    stem, ending = os.path.splitext(output)
    if name is not None and name.before.endswith("."):
        stem = name.before.removesuffix(".")
        ending = output[len(stem) :]
    return f"{stem}_ev{stops:+g}{ending}"
