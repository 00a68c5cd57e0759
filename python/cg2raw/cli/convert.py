# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convert renders to the DNGs that a camera would have recorded.

Reads what OpenImageIO reads (EXR, TIFF, PNG, HDR ...), scene-linear Rec.709. Pictures
that are sRGB, and whole numbers of 8 or 16 bits that state no colour space, are
refused, unless --linearize srgb undoes that curve; --iscolorspace lin_rec709 if they
are linear. What is transparent is black. Writes the same bytes as oiiotool with the
same dng: attributes, and needs no plugin. Several
inputs, or an -o that is a folder, give a DNG of the same name each; one that fails is
named, the others are done, and the exit code is 1.

Inputs are files, patterns (shot.####.exr, shot.%04d.exr) or folders. With --framerate,
or FramesPerSecond in the files, the DNGs are a shot (CinemaDNG): RAW in IFD0, no
preview, lens shading left in; frames that are missing or there twice are listed, the
others done, and the exit code is 1.

Noise differs from frame to frame of a shot: the number in a file's name is its frame
number (shot.0007.exr, render0007.exr), else the SMPTE time code in it. --frame-from
index counts the inputs instead, and --frame N says it.

Of a file with layers or parts the picture is taken: R, G, B, or the layer called rgba,
beauty, C or Combined; --layer names another. The DNG is of the display window: overscan
is cut off, and what is missing is black.

--method upi draws a random camera and white balance by the seed (Brooks et al., CVPR
2019) in place of --illuminant: a mixture of the D65 matrices of --upi-sensors, with
the CFA and the levels of --sensor. Its DNG states the drawn matrix and neutral.

examples:
  cg2raw convert shot.exr -o shot.dng --sensor samsung-s20fe --illuminant 2856K
  cg2raw convert shot.exr -o shot.dng --sensor samsung-s20fe --illuminant sample:7 \\
      --iso 3200 --seed 7
  cg2raw convert shot.%04d.exr -o raw/ --sensor blackmagic-pocket --illuminant D65 \\
      --framerate 24 --timecode 01:00:00:00 --reel A001
  cg2raw convert shot.exr -o shot.dng --sensor nikon-d40 --method upi --noise upi
"""

import argparse
import os
import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from cg2raw import _core
from cg2raw.cli._export_options import (
    ROWS,
    add_bracket,
    add_colorspace,
    add_options,
    given_options,
)
from cg2raw.cli._methods import add_method
from cg2raw.cli._numbers import whole
from cg2raw.cli._outputs import each_file
from cg2raw.cli._shots import bracket_outputs, outputs_of_shot, resolve_inputs
from cg2raw.system import usable_cores

if TYPE_CHECKING:  # only a conversion loads its modules
    from cg2raw.conversion import Request
    from cg2raw.upi import Upi

MOST_WORKERS = 16  # if nothing is asked for
OPTIONS = [name for name in ROWS if name not in ("first_frame", "bracket")]
PREFIX = "dng:"  # of an attribute of oiiotool
WORTH_SAYING = 0.001  # of the energy of spectra, outside the sensitivities


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw convert."""
    add = parser.add_argument
    add("inputs", nargs="+", metavar="IN", help="scene-linear images, or patterns")
    add("-o", "--output", required=True, metavar="OUT", help="a .dng, or a folder")
    add(
        "--attrib",
        nargs=2,
        action="append",
        default=[],
        metavar=("dng:NAME", "VALUE"),
        help="an option by its name for oiiotool: docs/oiiotool.md lists them",
    )
    add("--workers", type=workers, metavar="N", help="files at a time; default: cores")
    add("--json", action="store_true", help="the report as JSON, for programs")
    add("--quiet", action="store_true", help="no report, no progress; errors only")
    groups = {
        name: parser.add_argument_group(name)
        for name in ("exposure", "input", "shot", "method upi", "file")
    }
    for name in OPTIONS:
        add_options(groups[ROWS[name][0]], name)
    add_bracket(groups["exposure"])
    groups["exposure"].add_argument(
        "--frame-from",
        choices=("name", "index", "none"),
        help="frame numbers: in names (default), inputs counted from --frame, or none",
    )
    add_colorspace(groups["input"])
    groups["shot"].add_argument(
        "--frames", metavar="LIST", help="1001-1240, 1-100x2, -3,1,5-9; default: all"
    )
    add_method(groups["exposure"])
    add_upi(groups["method upi"])


def add_upi(group: argparse._ArgumentGroup) -> None:
    """Declare the options of --method upi; --noise and --digital-gain go with it."""
    add = group.add_argument
    add("--upi-sensors", metavar="IDS", help="matrices; default: the paper's ten")
    add(
        "--upi-gains",
        choices=("published", "graphics2raw", "camera"),
        help="red 1.9-2.4, blue 1.5-1.9; 1.0-3.3, 1.3-4.4; or the range of --sensor",
    )


def workers(text: str) -> int:
    """Return a whole number above 0."""
    if whole(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be at least 1")
    return int(text)


def run(arguments: argparse.Namespace) -> int:
    """Convert all inputs; return 0, or 1 if one failed."""
    from cg2raw import conversion

    request = request_of(arguments)
    inputs = resolve_inputs(arguments, request)
    files = inputs.files
    outputs = outputs_of_shot(files, arguments.output)
    frames = frames_of(arguments, outputs)
    steps = bracket_outputs(outputs, arguments.bracket)
    alike: dict[int, dict[str, None]] = {}
    count = workers_for(len(steps), arguments.workers)

    def work(path: str, output: str) -> dict[str, Any]:
        name, stops = steps[output]
        own = {} if frames[name] is None else {"frame": str(frames[name])}
        own |= {} if stops is None else {"bracket": stops}
        request_of_file = replace(
            request,
            options={**request.options, **own},
            place=inputs.places.get(path),
            output_name=name,
            threads=0 if count == 1 else 1,
        )
        report = conversion.convert(path, output, request_of_file)
        alike.setdefault(report["frame"], {})[name] = None
        return report

    paths = dict(zip(outputs, files, strict=True))
    pairs = [(paths[name], output) for output, (name, _) in steps.items()]
    code = each_file(
        "convert", pairs, work, arguments, "converting", line_of, inputs.faults, count
    )
    if arguments.iso is not None and not arguments.quiet:
        tell_alike({frame: list(names) for frame, names in alike.items()})
    return code


def workers_for(files: int, asked: int | None) -> int:
    """Return how many files are converted at a time: one per core, if that is not
    said, and up to 16, for the memory that each takes."""
    return max(1, min(files, asked or min(usable_cores(), MOST_WORKERS)))


def frames_of(
    arguments: argparse.Namespace, outputs: list[str]
) -> dict[str, int | None]:
    """Return {output: frame number, None for that in its name}. Raises ValueError."""
    if arguments.frame_from == "name" and arguments.frame is not None:
        raise ValueError("--frame and --frame-from name: give one of them")
    frame = None if arguments.frame is None else int(arguments.frame)
    if arguments.frame_from == "index":
        return {output: (frame or 0) + i for i, output in enumerate(outputs)}
    if frame is None and arguments.frame_from == "none":
        frame = 0
    return dict.fromkeys(outputs, frame)


def tell_alike(frames: dict[int, list[str]]) -> None:
    """Say on stderr which outputs have the same noise; frames : {number: outputs}."""
    for frame, outputs in frames.items():
        if len(outputs) > 1:
            names = ", ".join(outputs[:2]) + (" ..." if len(outputs) > 2 else "")
            print(
                f"cg2raw convert: {len(outputs)} files are frame {frame} and have the "
                f"same noise ({names}): --frame-from index counts them",
                file=sys.stderr,
            )


def request_of(arguments: argparse.Namespace) -> "Request":
    """Return the Request of a command line. Raises ValueError."""
    from cg2raw.conversion import DIALECT, Request
    from cg2raw.sensor import Sensor

    is_upi = check_method(arguments)
    options = core_options(arguments)
    _core.ExportOptions(options, DIALECT)  # raises for bad values, once for all files
    if is_upi:  # which draws with these itself
        options.pop("sensor", None)
        options.pop("digital_gain", None)
    elif "sensor" in options:
        Sensor(options["sensor"])  # likewise
    upi = upi_of(arguments) if is_upi else None
    return Request(options=options, space=arguments.iscolorspace, upi=upi)


def core_options(arguments: argparse.Namespace) -> dict[str, str]:
    """Return the core's options of a command line, as texts. Raises ValueError."""
    options = given_options(arguments, OPTIONS)
    if arguments.noise == "upi":
        del options["noise"]
    for name, value in arguments.attrib:
        if not name.lower().startswith(PREFIX):
            raise ValueError(f"--attrib {name}: its name must begin with {PREFIX}")
        options[name[len(PREFIX) :].lower()] = value
    return options


def check_method(arguments: argparse.Namespace) -> bool:
    """Return whether the method is upi. Raises ValueError for the other's options."""
    if arguments.method == "upi":
        for name in ("illuminant", "reference", "convention"):
            if getattr(arguments, name) is not None:
                raise ValueError(
                    f"--{name}: does not go with --method upi; leave it out"
                )
        if arguments.digital_gain == "sample":
            raise ValueError(
                "--digital-gain sample: --method upi draws it unless it is a number"
            )
        if not arguments.sensor:
            raise ValueError("--method upi: needs --sensor, for CFA and levels")
        return True
    for name in ("upi_sensors", "upi_gains"):
        if getattr(arguments, name) is not None:
            raise ValueError(f"--{name.replace('_', '-')}: needs --method upi")
    if arguments.noise == "upi":
        raise ValueError("--noise upi: needs --method upi")
    return False


def upi_of(arguments: argparse.Namespace) -> "Upi":
    """Return the Upi of a command line."""
    from cg2raw.cli._pairs import asked_sensors
    from cg2raw.sensor import Sensor
    from cg2raw.upi import PAPER_SENSORS, SensorLike, Upi

    matrices: list[SensorLike] = list(PAPER_SENSORS)
    if arguments.upi_sensors:
        asked = asked_sensors(arguments.upi_sensors, option="--upi-sensors")
        matrices = [Sensor.from_profile(profile) for profile in asked]
    return Upi(
        arguments.sensor,
        matrices=matrices,
        gains=arguments.upi_gains or "published",
        digital_gain=float(arguments.digital_gain or 0) or "upi",
        noise="upi" if arguments.noise == "upi" else "sensor",
    )


def exposure_words(exposure: dict[str, Any]) -> list[str]:
    """Return what is printed of an exposure that is not the scene as it is."""
    if exposure["meter"] == 0:
        return ["black: nothing to be metered, exposure 0"]
    stops = exposure["stops"] + (exposure["bracket"] or 0.0)
    words = [f"exposure {stops:+.2f}"] if stops else []
    if exposure["scene_luminance"] is not None or exposure["bracket"] is not None:
        words.insert(0, f"{shown_seconds(exposure['exposure_time'])} s")
    if exposure["scene_luminance"] is not None:
        words.insert(1, f"f/{exposure['f_number']:.3g}")
    return words


def shown_seconds(seconds: float) -> str:
    """Return an exposure time as photographers write it."""
    return f"1/{1 / seconds:.0f}" if seconds <= 0.25 else f"{seconds:.3g}"


def line_of(report: dict[str, Any]) -> str:
    """Return what is printed of one file."""
    light = report["illuminant"]
    words = [f"{report['width']}x{report['height']}", report["sensor"]]
    if light["word"]:
        words.append(f"{light['word']} ({light['cct']:.0f} K)")
    if light["spectrum"] and light["spectrum"].lower() != light["word"].lower():
        words.append(f"the spectrum of {light['spectrum']}")
    words += exposure_words(report["exposure"])
    if report["iso"] is not None:
        words.append(f"ISO {report['iso']:g}, frame {report['frame']}")
    if report["layer"]:
        words.append(f"layer {report['layer']}")
    if report["linearized"]:
        words.append("sRGB's curve undone")
    if report["nan"]:
        words.append(f"{report['nan']} NaN values became 0")
    if report["inf"]:
        words.append(f"{report['inf']} infinite ones black or white")
    if report["unseen_energy"] and report["unseen_energy"] >= WORTH_SAYING:
        words.append(f"{report['unseen_energy']:.1%} of the energy is unseen")
    return f"wrote     {os.fspath(report['output'])}: {', '.join(words)}"
