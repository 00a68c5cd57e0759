# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Find where simulation and measurement disagree, name the effect, add it.

Four commands: run finds what a profile lacks, check looks at the captures alone,
compare judges profiles as they are, and synthesize makes captures to try them on.
Without one of these words, run is meant: cg2raw diagnose captures.yaml -o report/

examples:
  cg2raw diagnose check captures.yaml
  cg2raw diagnose run captures.yaml -o report/
  cg2raw diagnose compare captures.yaml report/profile.json
"""

import argparse
import dataclasses
import difflib
import json
import re
import sys
from typing import TYPE_CHECKING, Any

from cg2raw.cli._messages import needs_extra
from cg2raw.cli._numbers import number, whole
from cg2raw.cli._outputs import check_output
from cg2raw.system import keep_freed_memory

if TYPE_CHECKING:  # only the work itself loads its modules
    from cg2raw.diagnose.captures.capture import CaptureSet
    from cg2raw.diagnose.diagnosis import Diagnosis


INTERRUPTED = 130
LEAST_PIXELS = 1000  # fewer show nothing
SECONDS = {"": 1.0, "s": 1.0, "min": 60.0, "h": 3600.0}

RUN = """Find what the profile lacks, and write a report.

captures.yaml lists RAW frames, what was in front of the lens, and the sensor whose
profile is tested. A third of the sets is fitted, a third decides, and the numbers that
are shown are of the last third. REPORT gets report.html, verdict.json for programs, and
profile.json: the sensor with the effects that were found; there is none if they do not
make the test frames more likely.

Verdicts, and their exit codes with --exit-code: consistent 0, explained 10, ambiguous
11, partially_explained 12, unexplained 13, incomplete 14: the time limit or Ctrl-C came
before all was decided. Ctrl-C ends the work, not the report, which then says so; it
exits with 130, with --exit-code by the verdict.

examples:
  cg2raw diagnose run captures.yaml -o report/
  cg2raw diagnose run captures.yaml -o report/ --exclude prnu,dsnu --time-limit 30min
  cg2raw diagnose run captures.yaml -o report/ --statistics captures.npz
"""
CHECK = """Check the integrity of the captures.

Levels, missing codes, clipping, the registration of renders, and what repeats show of
lamps and cosmic rays. Exit code 1: something is wrong.

examples:
  cg2raw diagnose check captures.yaml
  cg2raw diagnose check captures.yaml --json
"""
COMPARE = """Compare profiles on the test frames; nothing is fitted.

One row for the sensor of the captures and one for each PROFILE: gap, chi-square and
verdict.

examples:
  cg2raw diagnose compare captures.yaml report/profile.json
  cg2raw diagnose compare captures.yaml one.json other.json --json
"""
SYNTHESIZE = """Make captures of a camera with injected effects.

36 DNGs with their renders, captures.yaml, and the ground truth in truth.json.
--list-effects lists the effects and the unit of each strength.

examples:
  cg2raw diagnose synthesize -s nikon-d40 --effects lens_shading=0.3,row_noise -o blind/
  cg2raw diagnose synthesize -s nikon-d40 --effects random --seed 3 -o blind/
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the commands of cg2raw diagnose and their options."""
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for name, text, add, work in (
        ("run", RUN, add_run, run_diagnosis),
        ("check", CHECK, add_captures, run_check),
        ("compare", COMPARE, add_compare, run_compare),
        ("synthesize", SYNTHESIZE, add_synthesize, run_synthesize),
    ):
        command = commands.add_parser(
            name,
            help=text.partition("\n")[0].rstrip("."),
            description=text,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        add(command)
        command.set_defaults(work=work, name=f"diagnose {name}")
        option = command.add_argument
        option("--json", action="store_true", help="the result as JSON on stdout")
        option("-q", "--quiet", action="store_true", help="errors only")
        option(
            "-v",
            "--verbose",
            action="count",
            default=0,
            help="steps and reasons on stderr; twice: with times",
        )


def add_captures(parser: argparse.ArgumentParser) -> None:
    """Declare what is read."""
    parser.add_argument("captures", metavar="CAPTURES.yaml", help="what was captured")


def add_compare(parser: argparse.ArgumentParser) -> None:
    """Declare the options of compare."""
    add_captures(parser)
    parser.add_argument(
        "profiles", nargs="+", metavar="PROFILE", help="sensor id or profile (.json)"
    )


def add_synthesize(parser: argparse.ArgumentParser) -> None:
    """Declare the options of synthesize."""
    add = parser.add_argument
    add("-o", "--output", required=True, metavar="FOLDER", help="new or empty")
    add("-s", "--sensor", required=True, help="sensor id or profile (.json)")
    add(
        "--effects",
        required=True,
        metavar="LIST",
        help="NAME[=STRENGTH],...; random: any one",
    )
    add("--list-effects", action=ListEffects, help="strengths and their units")
    add("--seed", type=whole, default=0, metavar="N", help="default: 0")
    add("--size", default="144x112", metavar="WxH", help="pixels (default 144x112)")
    add("--illuminant", default="D65", metavar="LIGHT", help="default: D65")
    add("--iso", type=number(1e-3, 1e7), help="default: the first with noise")
    add("--full-well", type=number(1, 1e9), metavar="E", help="electrons (10000)")
    add("--read-noise", type=number(1e-3, 1e6), metavar="E", help="electrons (5)")
    add("--studio", action="store_true", help="light, exposure and renders are off")


class ListEffects(argparse.Action):
    """Print the effects that can be injected, and end."""

    def __init__(self, **named: Any) -> None:
        super().__init__(nargs=0, **named)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from cg2raw.synthetic.captures import strength_lines

        print(*strength_lines(), sep="\n")
        parser.exit()


def add_run(parser: argparse.ArgumentParser) -> None:
    """Declare the options of run."""
    add_captures(parser)
    add = parser.add_argument
    add(
        "-o",
        "--output",
        required=True,
        metavar="REPORT",
        help="folder; replaces a report",
    )
    add("--overwrite", action="store_true", help="write among other files in REPORT")
    add(
        "--alpha",
        type=share,
        default=0.01,
        metavar="P",
        help="risk of a false name (default 0.01)",
    )
    add(
        "--max-effects",
        type=count,
        default=6,
        metavar="N",
        help="added to explain images, beside those that darks and flats decide "
        "(default 6)",
    )
    either = parser.add_mutually_exclusive_group().add_argument
    either("--exclude", metavar="NAMES", help="effects that are not looked for")
    either("--include", metavar="NAMES", help="effects that alone are looked for")
    add(
        "--max-pixels",
        type=pixels,
        metavar="N",
        help="of each image that are fitted: tiles from its middle to its corners "
        "(default 65536, fewer of more than 64 frames)",
    )
    add(
        "--time-limit",
        type=duration,
        default=600.0,
        metavar="TIME",
        help="ends the work with what is decided: 90s, 10min, 2h (default 10min)",
    )
    add(
        "--statistics",
        metavar="FILE.npz",
        help="of darks and flats: written if it is not there, else read in place of "
        "these frames, which must be the same; 4 to 6 bytes a pixel, exposure time or "
        "level, and split",
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


@needs_extra("diagnose")
def run(arguments: argparse.Namespace) -> int:
    """Do what was asked; return the exit code."""
    keep_freed_memory()
    try:
        code: int = arguments.work(arguments)
        return code
    except MemoryError:
        raise ValueError(
            f"{getattr(arguments, 'captures', arguments.name)}: not enough memory; "
            "take fewer frames, or a crop"
        ) from None


def run_diagnosis(arguments: argparse.Namespace) -> int:
    """Diagnose and write the report; return the exit code."""
    from cg2raw.cli._verdict import reasons, verdict_text
    from cg2raw.diagnose.captures.reader import read_captures
    from cg2raw.diagnose.report.folder import check_folder, write_report_folder
    from cg2raw.diagnose.report.verdict_json import verdict_json

    choice = {
        "without": names_of("--exclude", arguments.exclude),
        "only": names_of("--include", arguments.include),
    }
    if arguments.max_pixels:
        choice["pixels"] = arguments.max_pixels
    if (path := arguments.statistics) and not check_output(
        "--statistics", path, ".npz"
    ):
        raise ValueError(f"--statistics {path}: must be a file that ends in .npz")
    check_folder(arguments.output, arguments.overwrite)
    captures = read_captures(arguments.captures)
    found = diagnosed(
        arguments,
        captures,
        alpha=arguments.alpha,
        most=arguments.max_effects,
        time_limit=arguments.time_limit,
        statistics=arguments.statistics,
        **choice,
    )
    names = write_report_folder(found, arguments.output, arguments.overwrite)
    if arguments.verbose:
        print("\n".join(reasons(found)), file=sys.stderr)
    if arguments.json:
        print(verdict_json(found, names), end="")
    elif not arguments.quiet:
        print(verdict_text(found, captures.notes, arguments.output, names))
    return exit_code(arguments, found)


def names_of(option: str, text: str | None) -> Any:
    """Return the effects that an option lists, (n,) str. Raises ValueError."""
    from cg2raw import _core
    from cg2raw.diagnose.effects import catalogue

    known = catalogue.names()
    names = tuple(word.strip() for word in (text or "").split(",") if word.strip())
    for name in names:
        if (new := _core.current_effect_name(name)) != name:
            raise ValueError(f'{option}: "{name}" is called "{new}" now')
        if name not in known:
            close = difflib.get_close_matches(name, known, 1)
            hint = (
                f"did you mean {close[0]}?" if close else f"they are {', '.join(known)}"
            )
            raise ValueError(f'{option}: no diagnosis names "{name}": {hint}')
    return names


def diagnosed(
    arguments: argparse.Namespace, captures: "CaptureSet", **options: Any
) -> "Diagnosis":
    """Return the Diagnosis of captures, with a progress bar."""
    from cg2raw.cli._progress import stages
    from cg2raw.diagnose.pipeline import diagnose

    with stages(arguments.quiet, arguments.verbose) as progress:
        return diagnose(captures, progress=progress, **options)


def exit_code(arguments: argparse.Namespace, found: "Diagnosis") -> int:
    """Return what a diagnosis ends with."""
    from cg2raw.diagnose.diagnosis import VERDICTS

    if found.interrupted:
        print(
            f"cg2raw {arguments.name}: interrupted; the report is partial, and says so",
            file=sys.stderr,
        )
        if not arguments.exit_code:
            return INTERRUPTED
    return VERDICTS[found.verdict] if arguments.exit_code else 0


def run_check(arguments: argparse.Namespace) -> int:
    """Print what the frames' pixels say; return 1 if something is wrong."""
    from cg2raw.cli._progress import stages
    from cg2raw.cli._verdict import integrity_json, integrity_text
    from cg2raw.diagnose.captures.check import check
    from cg2raw.diagnose.captures.reader import read_frames

    manifest, sensor, frames, notes = read_frames(arguments.captures)
    with stages(arguments.quiet, arguments.verbose) as progress:
        found = check(
            frames,
            sensor,
            manifest.nuisances,
            lambda share: progress("reading", share),
        )
    if arguments.json:
        print(json.dumps(integrity_json(sensor, found, notes), indent=2))
    elif not arguments.quiet:
        print(integrity_text(sensor, found, notes))
    return 0 if found.is_right else 1


def run_compare(arguments: argparse.Namespace) -> int:
    """Print the gaps of the sensor of the captures and of profiles; return the code.

    Nothing is fitted: all are judged as they are."""
    from cg2raw.cli._verdict import comparison_json, comparison_text
    from cg2raw.diagnose.captures.reader import read_captures
    from cg2raw.sensor import Sensor

    sensors = [None, *map(Sensor, arguments.profiles)]
    sets = [read_captures(arguments.captures, sensor) for sensor in sensors]
    found: list[Diagnosis] = []
    for captures in sets:
        found.append(diagnosed(arguments, captures, most=0))
        if found[-1].interrupted:
            raise KeyboardInterrupt
    found[1:] = [with_closed_share(found[0], one) for one in found[1:]]
    names = [sets[0].sensor.id, *arguments.profiles]
    if arguments.json:
        print(json.dumps(comparison_json(names, found, sets[0].notes), indent=2))
    elif not arguments.quiet:
        print(comparison_text(names, found, sets[0].notes))
    return 0


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


def run_synthesize(arguments: argparse.Namespace) -> int:
    """Make captures with injected effects; return 0."""
    from cg2raw.cli._progress import stages
    from cg2raw.short_messages import plural
    from cg2raw.synthetic import disk
    from cg2raw.synthetic.captures import Synthesis, notes_of

    given = {
        one.name: getattr(arguments, one.name) for one in dataclasses.fields(Synthesis)
    }
    with stages(arguments.quiet, arguments.verbose) as progress:
        progress("drawing and writing captures", 0.0)
        folder = Synthesis(**given).folder()
        disk.write_captures(arguments.output, folder)
    result = {
        "folder": arguments.output,
        "frames": len(folder.shots),
        "truth_sha256": folder.seal,
        "notes": notes_of(folder),
    }
    if arguments.json:
        print(json.dumps(result, indent=2))
    elif not arguments.quiet:
        print(*result["notes"], sep="\n", end="\n" * bool(result["notes"]))
        print(f"{arguments.output}: {plural(len(folder.shots), 'frame')}")
    return 0
