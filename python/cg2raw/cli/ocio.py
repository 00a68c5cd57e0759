# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make an OpenColorIO config whose colour spaces are sensors under illuminants.

Converting a linear render to "RAW - <sensor> - <illuminant>" gives camera RGB, which
the DNG plugin writes as it is. Without -o the config goes to stdout. The config loads
in OpenColorIO 2.1 and newer.

--merge puts the spaces into a studio's config, or into a built-in one of OpenColorIO
(ocio://studio-config-v1.0.0_aces-v1.3_ocio-v2.1 and others), and needs PyOpenColorIO
2.5. The result keeps that config's version, which decides where it loads: OpenColorIO
2.1 (OpenImageIO 2.4 of Debian 12) needs ..._ocio-v2.1; ..._ocio-v2.4 and -v2.5 load in
OpenImageIO 3.2. ocio://default, cg-config-latest and studio-config-latest mean v2.2.0
of these configs (profile 2.4).

--context makes a config of one space, "RAW - context", for any number of pairs: the
environment variables CG2RAW_SENSOR and CG2RAW_ILLUMINANT choose one. Its files lie in
OUT_raw beside OUT.ocio. On Windows leave out illuminants with a colon.

--convention spectral needs a table for each pair, which a config cannot hold: its files
lie in OUT_raw beside OUT.ocio, too, 0.4 MB each. It has no unbounded spaces.

--ctf, --clf and --cube write one sensor under one illuminant as a file of its own.

examples:
  cg2raw ocio --sensors all --illuminants A,D65 -o sensors.ocio
  cg2raw ocio --sensors nikon-d40 --illuminants sample:0-9 --merge studio.ocio \\
      -o studio/with-raw.ocio
  cg2raw ocio --sensors all --illuminants A,D65,sample:0-99 --context -o any.ocio
  cg2raw ocio --sensors samsung-s20fe --illuminants 2856K --ctf s20fe-2856K.ctf
"""

import argparse
import os
import sys
from typing import TYPE_CHECKING, Any, TextIO

from cg2raw._core import SensorProfile
from cg2raw.cfa import is_mono
from cg2raw.cli._outputs import check_output, to_file
from cg2raw.cli._pairs import asked_illuminants, asked_sensors, check_pairs
from cg2raw.short_messages import plural

if TYPE_CHECKING:  # only the work itself loads OpenColorIO
    from cg2raw_ocio.pair_files import PairFiles
    from cg2raw_ocio.spaces import Exposure

Profiles = list[SensorProfile]


MISSING = (
    "PyOpenColorIO is not installed; pip install opencolorio, or, for the Python of "
    "Debian and Ubuntu, apt install python3-pyopencolorio"
)
MANY = 200  # spaces from which on a config loads slowly
EXPORTS = (("ctf", ".ctf"), ("clf", ".clf"), ("cube", ".cube"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw ocio."""
    add = parser.add_argument
    add("--sensors", required=True, metavar="IDS", help="all, or ids and .json: a,b")
    add(
        "--illuminants",
        required=True,
        metavar="LIST",
        help="such as A,D65,3200K,sample:0-9",
    )
    add("-o", "--output", metavar="OUT.ocio", help="the config; replaces a file")
    add(
        "--convention",
        choices=("dng", "paper", "spectral"),
        default="dng",
        help="default: dng",
    )
    add(
        "--digital-gain",
        type=float,
        default=1.0,
        metavar="X",
        help="digital gain, 0 to 1000",
    )
    add("--no-highlights", action="store_true", help="highlights are not kept white")
    add("--profile-version", choices=("2.0", "2.1"), help="default: 2.1")
    add("--merge", metavar="CONFIG", help="a .ocio or ocio://NAME to put spaces into")
    add("--context", action="store_true", help="one space, chosen by the environment")
    add("--quiet", action="store_true", help="no report")
    group = parser.add_argument_group("one sensor, one illuminant")
    group.add_argument("--ctf", metavar="OUT.ctf", help="the exact chain")
    group.add_argument("--clf", metavar="OUT.clf", help="without protected highlights")
    group.add_argument("--cube", metavar="OUT.cube", help="3D LUT, for previews")
    group.add_argument(
        "--cube-size", type=int, metavar="N", help="2 to 129, default 65"
    )
    group.add_argument(
        "--cube-input",
        choices=("linear", "srgb"),
        help="encoding of what goes in, 0..1; default: linear",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write what is asked for; return 0."""
    check(arguments)
    try:
        import PyOpenColorIO as found
    except ImportError:
        raise ValueError(MISSING) from None
    try:
        make(arguments)
    except (found.Exception, found.ExceptionMissingFile) as error:
        raise ValueError(f"OpenColorIO {found.__version__}: {error}") from None
    return 0


def check(arguments: argparse.Namespace) -> None:
    """Raise ValueError for options that do not go together, or bad outputs."""
    if arguments.merge is not None and arguments.context:
        raise ValueError("--context: does not go with --merge")
    if arguments.merge is not None and arguments.profile_version:
        raise ValueError("--profile-version: does not go with --merge, which keeps its")
    check_files_beside(arguments)
    for option in ("cube_size", "cube_input"):
        if getattr(arguments, option) is not None and arguments.cube is None:
            raise ValueError(f"--{option.replace('_', '-')}: needs --cube")
    check_output("-o", arguments.output, ".ocio")
    for option, ending in EXPORTS:
        path = getattr(arguments, option)
        if path == "-":
            raise ValueError(f"--{option} -: must name a file")
        check_output(f"--{option}", path, ending)
    if to_file(arguments.output) and arguments.merge is not None:
        if os.path.realpath(arguments.output) == os.path.realpath(arguments.merge):
            raise ValueError(f"-o {arguments.output}: is the file to be read")


def check_files_beside(arguments: argparse.Namespace) -> None:
    """Raise ValueError if a config has files beside it, and goes to no file."""
    if to_file(arguments.output):
        return
    if arguments.context:
        raise ValueError("--context: needs -o OUT.ocio, beside which its files lie")
    exports = any(getattr(arguments, option) for option, _ in EXPORTS)
    if arguments.convention == "spectral" and (arguments.output or not exports):
        raise ValueError(
            "--convention spectral: needs -o OUT.ocio, beside which its tables lie, or "
            "--ctf OUT.ctf for one pair"
        )


def make(arguments: argparse.Namespace) -> None:
    """Write the config, the files, or both."""
    from cg2raw_ocio.spaces import Exposure

    profiles = with_colors(arguments, asked_sensors(arguments.sensors))
    if arguments.convention == "spectral" and arguments.sensors == "all":
        profiles = with_sensitivities(arguments, profiles)
    illuminants = asked_illuminants(arguments.illuminants)
    check_pairs(profiles, illuminants)
    exposure = Exposure(
        arguments.convention, arguments.digital_gain, not arguments.no_highlights
    )
    exports = [option for option, _ in EXPORTS if getattr(arguments, option)]
    if exports:
        if len(profiles) * len(illuminants) != 1:
            raise ValueError(
                f"--{exports[0]}: holds one sensor under one illuminant, not "
                f"{len(profiles)} x {len(illuminants)}"
            )
        make_exports(arguments, profiles[0], illuminants[0], exposure)
    if arguments.context:
        make_context(arguments, profiles, illuminants, exposure)
    elif arguments.output or not exports:
        make_config(arguments, profiles, illuminants, exposure)


def with_colors(
    arguments: argparse.Namespace, profiles: list[SensorProfile]
) -> list[SensorProfile]:
    """Return the sensors that have RAW colour spaces: of "all", those with filters."""
    colored = [profile for profile in profiles if not is_mono(profile.cfa)]
    without = [profile.id for profile in profiles if is_mono(profile.cfa)]
    if without and (arguments.sensors != "all" or not colored):
        raise ValueError(
            f"--sensors {without[0]}: is monochrome and has no RAW colour space: leave "
            "it out, and write its DNG from the scene (dng:sensor)"
        )
    for id in without:
        note(arguments, f"{id} is monochrome and has no RAW colour space: skipped")
    return colored


def with_sensitivities(
    arguments: argparse.Namespace, profiles: list[SensorProfile]
) -> list[SensorProfile]:
    """Return the sensors of "all" that see spectra; say how many do not."""
    seeing = [p for p in profiles if p.spectral_sensitivities is not None]
    if len(seeing) < len(profiles):
        note(
            arguments,
            f"{len(profiles) - len(seeing)} sensors have no spectral_sensitivities: "
            "skipped",
        )
    return seeing


def report(
    arguments: argparse.Namespace, text: str, stream: TextIO | None = None
) -> None:
    """Print a line of the report, to stderr if stdout is the config's."""
    if not arguments.quiet:
        clear = to_file(arguments.output) or (
            arguments.output is None and any(getattr(arguments, o) for o, _ in EXPORTS)
        )
        print(text, file=stream or (sys.stdout if clear else sys.stderr))


def make_config(
    arguments: argparse.Namespace,
    profiles: Profiles,
    illuminants: list[str],
    exposure: "Exposure",
) -> None:
    """Write a config of all pairs, merged with another if so asked."""
    from cg2raw_ocio import config as plain
    from cg2raw_ocio.pair_files import PairFiles, table_files

    folder = os.path.basename(folder_of(arguments)) if exposure.has_table else None
    if arguments.merge is not None:
        config = merged(arguments, profiles, illuminants, exposure, folder)
    else:
        version = arguments.profile_version or "2.1"
        config = plain.make_config(profiles, illuminants, exposure, version, folder)
    count = len(profiles) * len(illuminants)
    if count > MANY:
        note(arguments, f"{count} RAW spaces load slowly; see --context")
    text = plain.config_text(config)
    if not to_file(arguments.output):
        sys.stdout.write(text)
        sys.stdout.flush()
        return
    if exposure.has_table:
        files = PairFiles(table_files, profiles, illuminants, exposure)
        write_beside(arguments, files, plural(count, "file"))
    write(arguments.output, text)
    version = f"{config.getMajorVersion()}.{config.getMinorVersion()}"
    report(
        arguments,
        f"wrote     {arguments.output}: {plural(count, 'RAW space')}, "
        f"config version {version}",
    )


def merged(
    arguments: argparse.Namespace,
    profiles: Profiles,
    illuminants: list[str],
    exposure: "Exposure",
    folder: str | None,
) -> Any:
    """Return the config of --merge with RAW spaces; say what its files need."""
    from cg2raw_ocio import merge

    merge.check_can_merge()
    studio = merge.studio_config(arguments.merge)
    config = merge.merged_config(studio, profiles, illuminants, exposure, folder)
    folders = merge.relative_folders(studio)
    here = os.path.dirname(os.path.realpath(arguments.merge))
    there = os.path.dirname(os.path.realpath(arguments.output or ""))
    if folders and not (to_file(arguments.output) and here == there):
        note(
            arguments,
            f"{arguments.merge} looks for files in {', '.join(folders)} beside itself; "
            "put the new config into its folder",
        )
    return config


def make_context(
    arguments: argparse.Namespace,
    profiles: Profiles,
    illuminants: list[str],
    exposure: "Exposure",
) -> None:
    """Write a config of one space and the folder of its files."""
    from cg2raw_ocio import context
    from cg2raw_ocio.pair_files import PairFiles

    config = context.context_config(
        profiles[0],
        illuminants[0],
        os.path.basename(folder_of(arguments)),
        arguments.profile_version or "2.1",
        exposure.has_table,
    )
    text = config.serialize()
    pairs = len(profiles) * len(illuminants)
    count = pairs * (2 if exposure.has_table else 3)
    files = PairFiles(context.chain_files, profiles, illuminants, exposure)
    write_beside(arguments, files, f"{count} files, {plural(pairs, 'pair')}")
    write(arguments.output, text)
    report(arguments, f"wrote     {arguments.output}: RAW - context")


def folder_of(arguments: argparse.Namespace) -> str:
    """Return the path of the folder of a config's files."""
    return f"{os.path.splitext(arguments.output)[0]}_raw"


def write_beside(arguments: argparse.Namespace, files: "PairFiles", words: str) -> None:
    """Write the folder of a config's files."""
    from cg2raw.io.atomic_file import write_folder

    folder = folder_of(arguments)
    write_folder(folder, files, lambda name: name.endswith(".ctf"))
    report(arguments, f"wrote     {folder}{os.sep}: {words}")


def make_exports(
    arguments: argparse.Namespace,
    profile: SensorProfile,
    illuminant: str,
    exposure: "Exposure",
) -> None:
    """Write --ctf, --clf and --cube, and say how exact they are."""
    from cg2raw_ocio import export

    pair = (profile, illuminant, exposure)
    made: list[tuple[str, tuple[str, list[str]], TextIO | None]] = []
    if arguments.ctf:
        made.append((arguments.ctf, export.ctf(*pair), None))
    if arguments.clf:
        made.append((arguments.clf, export.clf(*pair), sys.stderr))
    if arguments.cube:
        size = 65 if arguments.cube_size is None else arguments.cube_size
        found = export.preview(*pair, size, arguments.cube_input or "linear")
        made.append((arguments.cube, found, None))
    for path, (text, findings), stream in made:
        write(path, text)
        report(arguments, f"wrote     {path}")
        for finding in findings:
            report(arguments, finding, stream)


def write(path: str, text: str) -> None:
    """Write a text whole or not at all."""
    from cg2raw.io.atomic_file import write_atomically

    write_atomically(path, text.encode())


def note(arguments: argparse.Namespace, text: str) -> None:
    """Print a line about what may surprise, to stderr."""
    if not arguments.quiet:
        print(f"cg2raw ocio: {text}", file=sys.stderr)
