# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make a sensor profile of a camera's DNG or RAW files.

Reads their metadata: CFA, levels, colour matrices, the neutral and the noise of each
file, lens shading. Writes the profile (JSON) and reports what was found, what is
missing and what that costs. Without -o the profile goes to stdout, the report to
stderr. RAW files that are no DNGs are read through LibRaw, which knows less of them.
DNGs that are demosaicked (LinearRaw: ProRAW of phones, linear conversions) do not
reveal the sensor's CFA: --cfa says it. Their noise is less than a mosaic's.

Measured spectral sensitivities (--ssf) replace matrices and neutrals of the files, or
make a profile without a file, if --cfa, --size, --bits, --black-level and --white-level
say the rest.

examples:
  cg2raw profile IMG_*.dng -o my-camera.json --plot my-camera.png
  cg2raw profile PRORAW_*.dng --cfa RGGB -o my-phone.json
  cg2raw profile IMG_0001.NEF --iso-noise 400:2e-4,1e-6 -o my-camera.json
  cg2raw profile --ssf camera.json --cfa rggb --size 4000x3000 --bits 14 \\
      --black-level 512 --white-level 16383 --id my-camera -o my-camera.json
"""

import argparse
import json
import os
import sys
from typing import TYPE_CHECKING, Any

from cg2raw._core import SensorProfile
from cg2raw.cli._outputs import check_output, to_file
from cg2raw.cli._progress import tracked

if TYPE_CHECKING:  # only the work itself loads its modules
    from cg2raw.profile.from_files import Made


NOISE_HELP = "noise at one ISO by hand: ISO:S,O or ISO:S,O,S,O,S,O (of R, G, B)"
CFA_HELP = "without a FILE, or of demosaicked ones (LinearRaw, ProRAW): RGGB ..."
BY_HAND = ("cfa", "size", "bits", "black-level", "white-level")
MANY = 20  # files above which a terminal shows progress


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw profile."""
    add = parser.add_argument
    add("files", nargs="*", metavar="FILE", help="DNG or RAW files of one camera")
    add("-o", "--output", metavar="OUT.json", help="the profile; replaces a file")
    add("--id", default="", help="the sensor's id (default: from the camera's name)")
    add("--make", default="", help="replaces the camera's make")
    add("--model", default="", help="replaces the camera's model")
    add("--iso-noise", action="append", default=[], metavar="NOISE", help=NOISE_HELP)
    add(
        "--neutrals",
        metavar="FILE.csv",
        help="measured grey cards, columns r,g,b or r/g,b/g, in place of the files'",
    )
    add_sensitivities(parser.add_argument_group("spectral sensitivities"))
    add("--plot", metavar="OUT.png", help="draw illuminants and sensitivities")
    add("--skip-bad", action="store_true", help="skip unreadable files")
    add("--json", action="store_true", help="the report as JSON, for programs")
    add("--quiet", action="store_true", help="no report, no progress")


def add_sensitivities(group: argparse._ArgumentGroup) -> None:
    """Declare the options on measured spectral sensitivities."""
    add = group.add_argument
    add("--ssf", metavar="FILE", help="spectral sensitivities (.json or .csv)")
    add(
        "--ssf-unit",
        choices=("energy", "photon"),
        help="what they are a response to; photon: quantum efficiency (default energy)",
    )
    add(
        "--illuminant-spd",
        action="append",
        default=[],
        metavar="LIGHT",
        help="light whose neutral counts and that gets a matrix: a name, 3200K, "
        "D5500K, or a file of power",
    )
    for option, *metavar in (
        ("--cfa",),
        ("--size", "WxH"),
        ("--bits", "N"),
        ("--black-level", "DN"),
        ("--white-level", "DN"),
    ):
        add(
            option,
            metavar=metavar[0] if metavar else None,
            help=CFA_HELP if option == "--cfa" else "without a FILE",
        )


def run(arguments: argparse.Namespace) -> int:
    """Make the profile; return 0."""
    from cg2raw.io import json_text
    from cg2raw.profile import from_files, report

    check_inputs(arguments)
    check_outputs(arguments)
    made = make(arguments)
    name = arguments.output or "profile"
    made.fields = changed(made.fields, arguments)
    profile, text = json_text.checked(from_files.with_notes(made), name)
    found = report.report(made, profile)
    write_outputs(arguments, profile, text, found)
    if not arguments.quiet:
        out = sys.stdout if to_file(arguments.output) else sys.stderr
        words = json.dumps(found, indent=2) if arguments.json else report.as_text(found)
        print(words, file=out)
        if to_file(arguments.output) and not arguments.json:
            print(f"wrote     {arguments.output}")
    return 0


def check_outputs(arguments: argparse.Namespace) -> None:
    """Raise ValueError for outputs that would overwrite a photo or cannot be."""
    inputs = [*arguments.files, *filter(None, [arguments.neutrals, arguments.ssf])]
    outputs = [("-o", arguments.output, ".json"), ("--plot", arguments.plot, ".png")]
    for option, path, ending in outputs:
        if check_output(option, path, ending):
            if os.path.realpath(path) in map(os.path.realpath, inputs):
                raise ValueError(f"{option} {path}: is one of the files to be read")


def check_inputs(arguments: argparse.Namespace) -> None:
    """Raise ValueError for options that do not go together."""
    given = [o for o in BY_HAND if getattr(arguments, o.replace("-", "_")) is not None]
    if not arguments.files and not arguments.ssf:
        raise ValueError("give DNG or RAW files of a camera, or --ssf")
    missing = [f"--{option}" for option in BY_HAND if option not in given]
    if arguments.ssf and missing and not arguments.files:
        raise ValueError(
            f"{arguments.ssf}: sensitivities do not tell {', '.join(missing)}; give "
            "these, or a DNG of the camera"
        )
    if arguments.files:  # of demosaicked ones, the CFA is asked for
        given = [option for option in given if option != "cfa"]
        if given:
            raise ValueError(
                f"--{given[0]}: the files say it; it goes with --ssf alone"
            )
    if given and not arguments.ssf:
        raise ValueError(f"--{given[0]}: needs --ssf")
    if arguments.illuminant_spd and not arguments.ssf:
        raise ValueError("--illuminant-spd: needs --ssf")
    if arguments.ssf_unit and not arguments.ssf:
        raise ValueError("--ssf-unit: needs --ssf")


def make(arguments: argparse.Namespace) -> "Made":
    """Return the Made profile of files, sensitivities or both."""
    if not arguments.ssf:
        return make_of_files(arguments)
    from cg2raw.profile import from_sensitivities as ssf

    path, lights = arguments.ssf, arguments.illuminant_spd
    unit = arguments.ssf_unit or "energy"
    if arguments.files:
        return ssf.with_sensitivities(make_of_files(arguments), path, lights, unit)
    width, height = size_of(arguments.size)
    return ssf.made_of_sensitivities(
        path,
        lights,
        unit,
        id=arguments.id,
        make=arguments.make,
        model=arguments.model,
        cfa=arguments.cfa,
        width=width,
        height=height,
        bits=whole("bits", arguments.bits),
        black_level=whole("black-level", arguments.black_level),
        white_level=whole("white-level", arguments.white_level),
    )


def whole(option: str, text: str | None) -> int | None:
    """Return the whole number that an option's value is, None if not given."""
    if text is not None and not text.isdecimal():
        raise ValueError(f"--{option} {text}: must be a whole number")
    return None if text is None else int(text)


def size_of(text: str | None) -> tuple[int, int] | tuple[None, None]:
    """Return (width, height) of "4000x3000", (None, None) if not given."""
    if text is None:
        return None, None
    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part.isdecimal() for part in parts):
        raise ValueError(f"--size {text}: must be WxH in pixels, as in 4000x3000")
    return int(parts[0]), int(parts[1])


def make_of_files(arguments: argparse.Namespace) -> "Made":
    """Return the Made profile of the files; names each bad one on stderr."""
    from cg2raw.profile import from_files

    try:
        return from_files.profile_from_files(
            arguments.files,
            id=arguments.id,
            make=arguments.make,
            model=arguments.model,
            cfa=arguments.cfa or "",
            skip_bad=arguments.skip_bad,
            progress=lambda paths: tracked(paths, "reading", arguments.quiet, MANY + 1),
        )
    except from_files.BadFiles as bad:
        if len(arguments.files) == 1:
            raise ValueError(bad.reasons[0]) from None
        for reason in bad.reasons:
            print(f"cg2raw profile: {reason}", file=sys.stderr)
        raise


def changed(fields: dict[str, Any], arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the profile's @fields with those changes that the options ask for."""
    from cg2raw.profile.neutrals import read_neutrals
    from cg2raw.profile.noise_option import with_noise

    fields = with_noise(fields, arguments.iso_noise)
    if arguments.neutrals:
        neutrals = read_neutrals(arguments.neutrals)
        file = os.path.basename(arguments.neutrals)
        source = f"{file}: {len(neutrals)} measured neutrals"
        sources = {**fields["sources"], "illuminants": source}
        fields = {**fields, "sources": sources, "illuminants": {"neutrals": neutrals}}
    return fields


def write_outputs(
    arguments: argparse.Namespace,
    profile: SensorProfile,
    text: str,
    found: dict[str, Any],
) -> None:
    """Write picture and profile, each whole or not at all."""
    from cg2raw.io.atomic_file import write_atomically

    if arguments.plot:
        from cg2raw.profile.plot import plot_png

        picture = plot_png(profile, found["illuminants"]["cct"])
        write_atomically(arguments.plot, picture)
    if to_file(arguments.output):
        write_atomically(arguments.output, text.encode())
    else:
        sys.stdout.write(text)
        sys.stdout.flush()
