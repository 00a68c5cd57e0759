# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure a sensor by darks and flats, and write its profile.

Photon transfer after EMVA Standard 1288: black level and its structure, read, row and
column noise, dark current and hot pixels, gain, full well, linearity, PRNU, shading,
each with its standard error. -o writes the sensor's profile with these numbers: black
level, noise at the frames' ISO, and the effects that stand out; all else stays.

Frames are DNGs, other RAW files, FITS, grey PNG, TIFF and PGM, .npy, and .npz with
several; darks and flats are told apart by exposure and level. Two that repeat each
other are the least; best are ten biases (the shortest exposure, no light), ten darks as
long as the camera is used for, and pairs of evenly lit flats from dark to saturated,
exposed under one steady lamp.

examples:
  cg2raw calibrate darks/ flats/ --sensor my-camera.json -o my-camera.json
  cg2raw calibrate frames.npz --frames frames.csv -s my-camera.json --report pages/
  cg2raw calibrate --darks d*.dng --flats f*.dng -s d0.dng --iso 100 -o my-camera.json
"""

import argparse
import json
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from cg2raw.cli._messages import needs_extra
from cg2raw.cli._numbers import number
from cg2raw.cli._outputs import check_output, check_report, to_file
from cg2raw.cli._progress import stages, tracked

if TYPE_CHECKING:  # only the work itself loads its modules
    from cg2raw.calibration import Calibration, UniformFrame
    from cg2raw.io.raw_header import RawHeader
    from cg2raw.sensor import Sensor


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw calibrate."""
    add = parser.add_argument
    add("frames", nargs="*", metavar="FILE", help="darks and flats; folders of them")
    add("--darks", nargs="+", default=[], metavar="FILE", help="frames without light")
    add("--flats", nargs="+", default=[], metavar="FILE", help="evenly lit frames")
    add(
        "-s", "--sensor", required=True, help="id, profile (.json) or DNG of the camera"
    )
    add("-o", "--output", metavar="OUT.json", help="the profile; may be the sensor's")
    add("--report", metavar="FOLDER", help="write calibration.html with plots there")
    said = parser.add_argument_group("what files do not say")
    add = said.add_argument
    add(
        "--frames",
        dest="table",
        metavar="FRAMES.csv",
        help="columns frame, exposure_s, and perhaps temperature_c, kind (dark, flat)",
    )
    add("--exposure", type=number(0, 1e6), metavar="S", help="exposure time, s")
    add("--iso", type=number(1e-3, 1e7), help="ISO of the frames")
    add(
        "--temperature",
        type=number(-273.15, 200),
        metavar="C",
        help="of the sensor, degrees Celsius",
    )
    add = parser.add_argument
    add(
        "--image",
        metavar="NAME",
        help="of files with several: name or number of the image; all: put together",
    )
    add("--json", action="store_true", help="the numbers as JSON, for programs")
    add("--quiet", action="store_true", help="no table, no progress; errors alone")


@needs_extra("diagnose")
def run(arguments: argparse.Namespace) -> int:
    """Read, measure, write what was asked for."""
    from cg2raw.calibration import calibrate
    from cg2raw.cli._uniform_frames import sensor_of

    check(arguments)
    sensor = sensor_of(arguments.sensor)
    frames, headers = frames_of(arguments, sensor)
    notes = notes_on(arguments, headers, sensor)
    with stages(arguments.quiet) as progress:
        found = calibrate(sensor, frames, progress=progress)
    notes += gain_notes(headers, found)
    found = replace(found, notes=(*notes, *found.notes))
    write(arguments, found)
    if not arguments.quiet:
        print(words_of(arguments, found), file=stream(arguments))
    return 0


def check(arguments: argparse.Namespace) -> None:
    """Raise ValueError for options that do not go together, before long work."""
    if not (arguments.frames or arguments.darks or arguments.flats):
        raise ValueError("give darks and flats, as files or folders")
    check_output("-o", arguments.output, ".json")
    check_report(arguments.report)


def frames_of(
    arguments: argparse.Namespace, sensor: "Sensor"
) -> "tuple[list[UniformFrame], list[RawHeader]]":
    """Return all frames that the command line names, and what their files say."""
    from cg2raw.cli import _uniform_frames as files
    from cg2raw.cli._frame_table import read_frame_table
    from cg2raw.io.raw_file import frames_in
    from cg2raw.statistics.kept import Kept

    table = read_frame_table(arguments.table) if arguments.table else {}
    said = files.Said(arguments.exposure, arguments.iso, arguments.temperature)
    kept = Kept()
    found: list[UniformFrame] = []
    headers: list[RawHeader] = []
    for kind, paths in (
        (None, arguments.frames),
        ("dark", arguments.darks),
        ("flat", arguments.flats),
    ):
        given = files.Said(**{**vars(said), "kind": kind})
        named = files.files_in(paths)
        for path in tracked(named, "reading", arguments.quiet):
            for file in frames_in(path, arguments.image):
                headers.append(file.header)
                found.append(files.uniform_frame(file, sensor, table, given, kept))
    names = {name for header in headers for name in files.names_of(header)}
    if table and not names & set(table):
        raise ValueError(
            f"{arguments.table}: names none of the frames; its first is "
            f"{next(iter(table))}, the first file's {found[0].name}"
        )
    return found, headers


def notes_on(
    arguments: argparse.Namespace, headers: "Sequence[RawHeader]", sensor: "Sensor"
) -> list[str]:
    """Return sentences on what files say. Raises ValueError for frames that are not of
    this sensor, one setting and the ISO that was given."""
    from cg2raw.io.raw_checks import check_alike, check_sensor, together

    said = [(header.name, check_sensor(header, sensor)) for header in headers]
    check_alike(headers)
    for header in headers:
        if header.iso and arguments.iso and header.iso != arguments.iso:
            raise ValueError(
                f"{header.where}: its ISO is {header.iso:g}, --iso {arguments.iso:g}: "
                "leave --iso out, or give frames of that ISO"
            )
    return together(said)


def gain_notes(headers: "Sequence[RawHeader]", found: "Calibration") -> list[str]:
    """Return a sentence on a gain in headers that is not what was measured."""
    from cg2raw.io.raw_checks import SAME_GAIN

    stated = next((h for h in headers if h.electrons_per_dn), None)
    gain = found.figure("gain")
    if stated is None or not stated.electrons_per_dn or gain is None:
        return []
    if abs(stated.electrons_per_dn / gain.value - 1) <= SAME_GAIN:
        return []
    return [
        f"gain: headers say {stated.electrons_per_dn:.3g} electrons per DN "
        f"({stated.name} the first), the frames {gain.value:.3g}: what was measured is "
        "used"
    ]


def write(arguments: argparse.Namespace, found: "Calibration") -> None:
    """Write profile and report, each whole or not at all."""
    from cg2raw.io.atomic_file import write_atomically

    text = found.updated_profile()
    if arguments.report:
        from cg2raw.calibration.report import write_report

        write_report(found, arguments.report)
    if to_file(arguments.output):
        write_atomically(arguments.output, text.encode())
    elif arguments.output == "-":
        sys.stdout.write(text)


def words_of(arguments: argparse.Namespace, found: "Calibration") -> str:
    """Return what is printed: the table, or its numbers as JSON."""
    from cg2raw.calibration.table import as_text

    notes = found.profile_notes()
    if arguments.json:
        return json.dumps({**numbers(found), "notes": [*found.notes, *notes]}, indent=2)
    lines = [as_text(found), *(f"{'note':31}{note}" for note in notes)]
    if to_file(arguments.output):
        lines.append(f"{'wrote':31}{arguments.output}: {effects_words(found)}")
    if arguments.report:
        page = os.path.join(arguments.report, "calibration.html")
        lines.append(f"{'wrote':31}{page}")
    return "\n".join(lines)


def effects_words(found: "Calibration") -> str:
    """Return what the profile has now."""
    profile = json.loads(found.updated_profile())
    names = [effect["name"] for effect in profile.get("effects", [])]
    isos = [f"{row['iso']:g}" for row in profile.get("noise", [])]
    noise = f"noise at ISO {', '.join(isos)}" if isos else "no noise"
    return f"{noise}; effects {', '.join(names) or 'none'}"


def numbers(found: "Calibration") -> dict[str, Any]:
    """Return the table in JSON's types."""
    from cg2raw.calibration.table import rows_of

    listed = [
        {
            "section": row.section,
            "name": row.name,
            "value": vars(row.value) if row.value else None,
            "electrons": vars(row.electrons) if row.electrons else None,
            "more": row.more,
        }
        for row in rows_of(found)
    ]
    return {
        "sensor": found.sensor.id,
        "iso": found.iso,
        "darks": found.frames[0],
        "flats": found.frames[1],
        "numbers": listed,
    }


def stream(arguments: argparse.Namespace) -> Any:
    """Return where the table goes: not among a profile on stdout."""
    return sys.stderr if arguments.output == "-" else sys.stdout
