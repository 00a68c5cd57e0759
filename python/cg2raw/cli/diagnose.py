# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Find where simulation and measurement disagree, name the effect, add it.

captures.yaml lists RAW frames, what was in front of the lens, and the sensor whose
profile is tested. A third of the sets is fitted, a third decides, and the numbers that
are shown are of the last third. REPORT gets report.html with its pictures, verdict.json
for programs, and profile.json: the sensor with the effects that were found; there is
none if they do not make the held-out frames, edge to edge, more likely.

Verdicts, and their exit codes with --exit-code: consistent 0, explained 10, ambiguous
11, partially_explained 12, unexplained 13, incomplete 14: the time limit or Ctrl-C came
before all was decided. Ctrl-C ends the work, not the report, which then says so; it
exits with 130, with --exit-code by the verdict.

examples:
  cg2raw diagnose captures.yaml -o report/
  cg2raw diagnose --check captures.yaml
  cg2raw diagnose --verify captures.yaml --against report/profile.json
  cg2raw diagnose --hide lens_shading=0.3,row_noise=0.2 -s nikon-d40 -o blind/
"""

import argparse
import dataclasses
import difflib
import re
import sys
from typing import TYPE_CHECKING, Any

from cg2raw.system import keep_freed_memory

if TYPE_CHECKING:  # only the work itself loads its modules
    from cg2raw.diagnose.captures.capture import CaptureSet
    from cg2raw.diagnose.diagnosis import Diagnosis


INTERRUPTED = 130
TIME_LIMIT = 600.0  # s
LEAST_PIXELS = 1000  # fewer show nothing
SECONDS = {"": 1.0, "s": 1.0, "min": 60.0, "h": 3600.0}
# Options that go with some modes alone; "" is the diagnosis itself.
OPTIONS = {
    "output": ("", "hide"),
    "force": ("",),
    "alpha": ("", "verify"),
    "max": ("",),
    "without": ("",),
    "only": ("",),
    "pixels": ("", "verify"),
    "time_limit": ("",),
    "exit_code": ("", "verify"),
    "against": ("verify",),
    "sensor": ("hide",),
    "seed": ("hide",),
}
SPELT = {"output": "-o"}  # where not as the option


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw diagnose."""
    add = parser.add_argument
    add("captures", nargs="?", metavar="CAPTURES.yaml", help="what was captured")
    add("-o", "--output", metavar="REPORT", help="folder; replaces a report")
    add("--force", action="store_true", help="write among other files in REPORT")
    add("--quiet", action="store_true", help="no verdict, no progress; errors alone")
    add_search(parser.add_argument_group("search"))
    group = parser.add_argument_group("instead of a diagnosis")
    modes = group.add_mutually_exclusive_group()
    add = modes.add_argument
    add("--check", action="store_true", help="look at the frames' integrity alone")
    add("--verify", action="store_true", help="held-out gap before and --against")
    add("--hide", metavar="EFFECTS", help="make captures with these hidden effects")
    add = group.add_argument
    add("--against", metavar="PROFILE", help="the profile that --verify tries")
    add("-s", "--sensor", metavar="SENSOR", help="of --hide: id or profile")
    add("--seed", type=int, metavar="N", help="of --hide")


def add_search(group: argparse._ArgumentGroup) -> None:
    """Declare the options on what is looked for."""
    add = group.add_argument
    add("--alpha", type=share, metavar="P", help="risk of a false name (default 0.01)")
    add(
        "--max",
        type=count,
        metavar="N",
        help="most effects that are added to explain images, beside those that darks "
        "and flats decide (default 6)",
    )
    add("--without", metavar="NAMES", help="effects that are not looked for")
    add("--only", metavar="NAMES", help="effects that alone are looked for")
    add(
        "--pixels",
        type=pixels,
        metavar="N",
        help="of each image that are fitted: tiles from its middle to its corners "
        "(default 65536, fewer of more than 64 frames)",
    )
    add(
        "--time-limit",
        type=duration,
        metavar="TIME",
        help="ends the work with what is decided: 90s, 10min, 2h (default 10min)",
    )
    add("--exit-code", action="store_true", help="the verdict as exit code")


def share(text: str) -> float:
    """Return a number between 0 and 1."""
    number = float(text)
    if not 0 < number < 1:
        raise argparse.ArgumentTypeError(f"{text} must be between 0 and 1")
    return number


def count(text: str) -> int:
    """Return a whole number above 0."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} must be a whole number above 0")
    return int(text)


def pixels(text: str) -> int:
    """Return a number of pixels that is worth a diagnosis."""
    if not text.isdecimal() or int(text) < LEAST_PIXELS:
        raise argparse.ArgumentTypeError(
            f"{text} must be a whole number of pixels, at least {LEAST_PIXELS}"
        )
    return int(text)


def duration(text: str) -> float:
    """Return the seconds of a time above 0: a number, with s, min or h behind it."""
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(s|min|h|)", text)
    seconds = float(found[1]) * SECONDS[found[2]] if found else 0.0
    if seconds <= 0:
        raise argparse.ArgumentTypeError(
            f"{text} must be a time above 0, as 90s, 10min or 2h"
        )
    return seconds


def run(arguments: argparse.Namespace) -> int:
    """Do what was asked; return the exit code."""
    mode = next((name for name in RUNS if name and getattr(arguments, name)), "")
    check_options(arguments, mode)
    keep_freed_memory()
    try:
        return RUNS[mode](arguments)
    except ModuleNotFoundError as missing:
        raise ValueError(
            f"needs {missing.name}: pip install 'cg2raw[diagnose]'"
        ) from None
    except MemoryError:
        raise ValueError(
            f"{arguments.captures}: not enough memory; take fewer frames, or a crop"
        ) from None


def check_options(arguments: argparse.Namespace, mode: str) -> None:
    """Raise ValueError for options that do not go together."""
    for name, modes in OPTIONS.items():
        if getattr(arguments, name) not in (None, False) and mode not in modes:
            goes = " or ".join(f"--{m}" if m else "a diagnosis" for m in modes)
            option = SPELT.get(name, f"--{name.replace('_', '-')}")
            raise ValueError(f"{option}: is for {goes}")
    if mode in ("", "check", "verify") and arguments.captures is None:
        raise ValueError(
            "give a captures.yaml; cg2raw diagnose --hide lens_shading=0.3 "
            "-s nikon-d40 -o blind/ makes one to try"
        )
    if mode == "hide" and arguments.captures is not None:
        raise ValueError(f"{arguments.captures}: --hide reads no captures")
    if mode in ("", "hide") and arguments.output is None:
        raise ValueError("give -o with the folder that is to be written")
    if mode == "hide" and arguments.sensor is None:
        raise ValueError("--hide: in captures of which sensor? Add -s")
    if mode == "verify" and arguments.against is None:
        raise ValueError("--verify: which profile? Add --against report/profile.json")
    if arguments.without and arguments.only:
        raise ValueError("--without and --only: give one of them")


def run_diagnosis(arguments: argparse.Namespace) -> int:
    """Diagnose and write the report; return the exit code."""
    from cg2raw.diagnose.captures.reader import read_captures
    from cg2raw.diagnose.report.folder import check_folder, write_report_folder

    choice = {name: names_of(arguments, name) for name in ("without", "only")}
    check_folder(arguments.output, arguments.force)
    captures = read_captures(arguments.captures)
    limit = arguments.time_limit or TIME_LIMIT
    most = arguments.max or 6
    found = diagnosed(arguments, captures, most=most, time_limit=limit, **choice)
    names = write_report_folder(found, arguments.output, arguments.force)
    if not arguments.quiet:
        from cg2raw.cli._verdict import verdict_text

        print(verdict_text(found, captures.notes, arguments.output, names))
    return exit_code(arguments, found)


def names_of(arguments: argparse.Namespace, option: str) -> tuple[str, ...]:
    """Return the effects that --without or --only lists. Raises ValueError."""
    from cg2raw import _core
    from cg2raw.diagnose.effects import catalogue

    known = catalogue.names()
    words = (getattr(arguments, option) or "").split(",")
    names = tuple(word.strip() for word in words if word.strip())
    for name in names:
        if (new := _core.current_effect_name(name)) != name:
            raise ValueError(f'--{option}: "{name}" is called "{new}" now')
        if name not in known:
            close = difflib.get_close_matches(name, known, 1)
            hint = (
                f"did you mean {close[0]}?" if close else f"they are {', '.join(known)}"
            )
            raise ValueError(f'--{option}: no diagnosis names "{name}": {hint}')
    return names


def diagnosed(
    arguments: argparse.Namespace, captures: "CaptureSet", **options: Any
) -> "Diagnosis":
    """Return the Diagnosis of captures, with a progress bar."""
    from cg2raw.cli._progress import stages
    from cg2raw.diagnose.pipeline import diagnose

    if arguments.pixels:
        options["pixels"] = arguments.pixels
    with stages(arguments.quiet) as progress:
        return diagnose(
            captures, alpha=arguments.alpha or 0.01, progress=progress, **options
        )


def exit_code(arguments: argparse.Namespace, found: "Diagnosis") -> int:
    """Return what a diagnosis ends with."""
    from cg2raw.diagnose.diagnosis import VERDICTS

    if found.interrupted:
        print(
            "cg2raw diagnose: interrupted; the report is partial, and says so",
            file=sys.stderr,
        )
        if not arguments.exit_code:
            return INTERRUPTED
    return VERDICTS[found.verdict] if arguments.exit_code else 0


def run_check(arguments: argparse.Namespace) -> int:
    """Print what the frames' pixels say; return 1 if something is wrong."""
    from cg2raw.cli._progress import stages
    from cg2raw.cli._verdict import integrity_text
    from cg2raw.diagnose.captures.check import check
    from cg2raw.diagnose.captures.reader import read_frames

    manifest, sensor, frames, notes = read_frames(arguments.captures)
    with stages(arguments.quiet) as progress:
        found = check(
            frames,
            sensor,
            manifest.nuisances,
            lambda share: progress("reading", share),
        )
    if not arguments.quiet:
        print(integrity_text(sensor, found, notes))
    return 0 if found.is_right else 1


def run_verify(arguments: argparse.Namespace) -> int:
    """Print the held-out gap of the manifest's sensor and of another; return the code.

    Nothing is fitted: both are judged as they are."""
    from cg2raw.cli._verdict import verify_text
    from cg2raw.diagnose.captures.reader import read_captures
    from cg2raw.diagnose.diagnosis import VERDICTS
    from cg2raw.sensor import Sensor

    before = read_captures(arguments.captures)
    after = read_captures(arguments.captures, Sensor(arguments.against))
    first = diagnosed(arguments, before, most=0)
    second = first if first.interrupted else diagnosed(arguments, after, most=0)
    second = with_closed_share(first, second)
    if not arguments.quiet and not second.interrupted:
        names = (before.sensor.id, arguments.against)
        print(verify_text(names, (first, second), after.notes))
    if second.interrupted:
        return INTERRUPTED
    return VERDICTS[second.verdict] if arguments.exit_code else 0


def with_closed_share(first: "Diagnosis", second: "Diagnosis") -> "Diagnosis":
    """Return the second Diagnosis without structures that are traces of what it closed.

    A diagnosis that finds effects says so itself; here nothing was searched."""
    from cg2raw.diagnose.diagnosis import (
        CHI_SQUARE_NAME,
        LARGE_NATS,
        SHARE_LEFT,
    )

    closed = first.gap.before - second.gap.before
    most = min(SHARE_LEFT * closed, LARGE_NATS)
    left = [
        test
        for test in second.unexplained
        if test.nats_per_pixel > most or test.name == CHI_SQUARE_NAME
    ]
    verdict = second.verdict if left else "consistent"
    return dataclasses.replace(second, unexplained=left, verdict=verdict)


def run_hide(arguments: argparse.Namespace) -> int:
    """Make captures with hidden effects; return the exit code."""
    from cg2raw.synthetic.captures import main

    words = ["--hide", arguments.hide, "-s", arguments.sensor, "-o", arguments.output]
    if arguments.seed is not None:
        words += ["--seed", str(arguments.seed)]
    return main(words + ["--quiet"] * arguments.quiet)


RUNS = {"": run_diagnosis, "check": run_check, "verify": run_verify, "hide": run_hide}
