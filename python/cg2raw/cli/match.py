# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Compare RAW captures with renders, and find the exposure between them.

Renders go through the model of the sensor, under the lights of the captures and with
noise of their ISO; then both are compared, in stops below white: luminance, clipped and
black samples, colour after white balance, contrast, sharpness, noise. -o writes the
levels of both and the distribution of exposure between them, for --exposure match:FILE.

Without --illuminant the captures' neutrals are the renders' lights, in turn; without
--iso their noise is that of the captures' ISO, where it is measured.

Captures are files of one camera that keep the mosaic (DNG and other RAW), ten or more;
renders scene-linear images (EXR ...). Both are files or folders, which are searched
through. Captures and renders need not show the same scenes; where they do, that is
found, and the exposure is that of each pair. docs/match.md has what is inferred how.

examples:
  cg2raw match captures/ renders/ --sensor sony-a7s-ii -o match.json
  cg2raw match captures/ renders/ --sensor my-camera.json --report page/
  cg2raw match night/ renders/ --sensor samsung-s20fe --illuminant 3200K --iso 1600
"""

import argparse
import json
import os
import statistics
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, TypeVar

from cg2raw.cli._export_options import (
    add_colorspace,
    add_options,
    checked_options,
)
from cg2raw.cli._messages import needs_extra
from cg2raw.cli._outputs import check_output, check_report, to_file
from cg2raw.cli._progress import stages
from cg2raw.interrupts import held, is_asked_to_end
from cg2raw.system import usable_cores

if TYPE_CHECKING:  # only the work itself loads its modules
    from cg2raw.match import Capture, Comparison, Model
    from cg2raw.sensor import Sensor

T = TypeVar("T")
MOST_WORKERS = 8  # each holds a frame
OPTIONS = ("illuminant", "iso", "convention", "layer", "linearize")  # of the core


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw match."""
    add = parser.add_argument
    add("captures", metavar="CAPTURES", help="RAW of one camera: a folder, a file")
    add("renders", metavar="RENDERS", help="scene-linear images: a folder, or a file")
    add("-s", "--sensor", required=True, help="id, profile (.json), or DNG of a camera")
    add("-o", "--output", metavar="OUT.json", help="the exposure of the renders")
    add("--report", metavar="FOLDER", help="write match.html with plots there")
    add("--white-balance", action="store_true", help="also its distribution, in -o")
    add("--workers", type=int, metavar="N", help="files at a time; default: cores")
    add("--json", action="store_true", help="the table as JSON, for programs")
    add("--quiet", action="store_true", help="no table, no progress; errors only")
    group = parser.add_argument_group("renders")
    add_options(group, *OPTIONS)
    add_colorspace(group)


@needs_extra("diagnose")
def run(arguments: argparse.Namespace) -> int:
    """Read, compare, write what was asked for."""
    from cg2raw.cli._uniform_frames import sensor_of
    from cg2raw.match import captures_in, check_counts, compare, renders_in

    check(arguments)
    sensor = sensor_of(arguments.sensor)
    check_model(arguments, sensor)
    files = captures_in([arguments.captures]), renders_in([arguments.renders])
    check_counts(*map(len, files))
    captures, model, renders = frames_of(arguments, sensor, *files)
    found = compare(
        sensor.id,
        [capture.frame for capture in captures],
        renders,
        arguments.white_balance,
        notes_on(captures, model),
    )
    write(arguments, found, model)
    if not arguments.quiet:
        print(words_of(arguments, found, model), file=stream(arguments))
    return 0


def check(arguments: argparse.Namespace) -> None:
    """Raise ValueError for options that cannot be, before long work."""
    checked_options(arguments, OPTIONS)
    check_output("-o", arguments.output, ".json")
    if arguments.workers is not None and arguments.workers < 1:
        raise ValueError(f"--workers {arguments.workers}: must be at least 1")
    check_report(arguments.report)


def check_model(arguments: argparse.Namespace, sensor: "Sensor") -> None:
    """Raise ValueError for a light or an ISO that the sensor does not have."""
    if arguments.illuminant is not None:
        sensor.illuminant(arguments.illuminant)
    if arguments.iso is not None:
        sensor.noise_at(float(arguments.iso))


def frames_of(
    arguments: argparse.Namespace,
    sensor: "Sensor",
    captures: Sequence[str],
    renders: Sequence[str],
) -> "tuple[list[Capture], Model, list[Any]]":
    """Return what captures look like, the model that suits them, and what renders look
    like through it."""
    from cg2raw.match import read_capture, read_render

    total = len(captures) + len(renders)
    count = arguments.workers or min(usable_cores(), MOST_WORKERS)
    with held(), ThreadPoolExecutor(count) as pool, stages(arguments.quiet) as progress:

        def each(work: Callable[..., T], done: int, *columns: Sequence[Any]) -> list[T]:
            found = []
            for result in results(pool, work, *columns):
                found.append(result)
                count = done + len(found)
                progress(f"{count} of {total} frames", count / total)
            return found

        seen = each(lambda path: read_capture(path, sensor), 0, captures)
        model = model_of(arguments, sensor, seen)
        places = range(len(renders))
        looks = each(
            lambda path, place: read_render(path, place, model),
            len(captures),
            renders,
            places,
        )
    return seen, model, looks


def results(
    pool: ThreadPoolExecutor, work: Callable[..., T], *columns: Sequence[Any]
) -> Iterator[T]:
    """Yield work(*row) of each row; after an error, no more rows are begun."""
    waiting = [pool.submit(work, *row) for row in zip(*columns, strict=True)]
    try:
        for future in waiting:
            if is_asked_to_end():
                break
            yield future.result()
    finally:
        for future in waiting:
            future.cancel()


def model_of(
    arguments: argparse.Namespace, sensor: "Sensor", captures: "Sequence[Capture]"
) -> "Model":
    """Return what renders go through."""
    from cg2raw.match import Model

    lights = [arguments.illuminant]
    if arguments.illuminant is None:
        lights = [capture.light for capture in captures]
    times = [c.exposure_time for c in captures if c.exposure_time]
    return Model(
        sensor,
        lights,
        iso_of(arguments, sensor, captures),
        statistics.median(times) if times else None,
        (arguments.convention or "dng").lower(),
        arguments.layer,
        (arguments.linearize or "stated").lower(),
        arguments.iscolorspace,
    )


def iso_of(
    arguments: argparse.Namespace, sensor: "Sensor", captures: "Sequence[Capture]"
) -> float | None:
    """Return the ISO of the renders' noise: that of the captures, if it is calibrated;
    None for no noise."""
    if arguments.iso is not None:
        return float(arguments.iso)
    stated = [capture.iso for capture in captures if capture.iso]
    if not stated or not sensor.noise:
        return None
    iso = statistics.median(stated)
    try:
        sensor.noise_at(iso)
    except ValueError:
        return None
    return iso


def notes_on(captures: "Sequence[Capture]", model: "Model") -> list[str]:
    """Return sentences on what was assumed."""
    from cg2raw.cfa import is_mono
    from cg2raw.io.raw_checks import together

    notes = together((capture.frame.name, capture.notes) for capture in captures)
    unknown = sum(not capture.stated for capture in captures)
    if unknown and not is_mono(model.sensor.cfa):
        notes.append(
            f"{unknown} of {len(captures)} captures state no white balance: the mean "
            "of each is taken to be grey"
        )
    if model.iso is None:
        notes.append("renders are without noise: --iso gives it, where it is measured")
    return notes


def write(arguments: argparse.Namespace, found: "Comparison", model: "Model") -> None:
    """Write match.json and the page, each whole or not at all."""
    from cg2raw.io.atomic_file import write_atomically
    from cg2raw.io.json_text import formatted

    if arguments.report:
        from cg2raw.match.page import write_page

        write_page(found, arguments.report, model.iso is not None)
    text = formatted(found.fields())
    if to_file(arguments.output):
        write_atomically(arguments.output, text.encode())
    elif arguments.output == "-":
        sys.stdout.write(text)


def words_of(arguments: argparse.Namespace, found: "Comparison", model: "Model") -> str:
    """Return what is printed: the table, or its numbers as JSON."""
    from cg2raw.match.comparison import exposure_words, rows_of

    rows = rows_of(found, noise=model.iso is not None)
    if arguments.json:
        table = [
            {k: None if v != v else v for k, v in vars(row).items()} for row in rows
        ]
        fields = {**found.fields(), "table": table, "notes": list(found.notes)}
        return json.dumps(fields, indent=2)
    scenes = f"{found.scenes} captures show the scene of a render"
    lines = [
        f"{len(found.captures)} captures, {len(found.renders)} renders, "
        + (scenes if found.scenes else "of different scenes"),
        f"{exposure_words(found.exposure)}.",
        *(f"{row.sentence}." for row in rows),
        *(f"note: {note}" for note in found.notes),
    ]
    if to_file(arguments.output):
        lines.append(f"wrote {arguments.output}")
    if arguments.report:
        lines.append(f"wrote {os.path.join(arguments.report, 'match.html')}")
    return "\n".join(lines)


def stream(arguments: argparse.Namespace) -> Any:
    """Return where the table goes: not among match.json on stdout."""
    return sys.stderr if arguments.output == "-" else sys.stdout
