# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Training data: each image by many sensors, lights, digital gains and ISOs.

IN is a folder, searched through, or files: EXR, HDR, PNG, TIFF. The curve that a file
states is undone; whole numbers that state none need --linearize, or --iscolorspace.
OUT/manifest.parquet and .jsonl list all that is needed to make each file again.

Stopped, even killed: run the same command again to resume; finished files of the right
hashes are kept. A file's bytes depend on the options, its image and its name alone.
Unusable images are listed at the end; the exit code is then 1.

Of an image with layers or parts the picture is taken: R, G, B, or the layer rgba,
beauty, C or Combined, or --layer; what its display window lacks is black.

examples:
    cg2raw dataset renders/ out/ --sensors nikon-d40,samsung-s20fe --illuminants 4
    cg2raw dataset renders/ out/ --sensors samsung-s20fe --illuminants A,D65 \\
                   --digital-gain 1.0,0.8 --iso clean,100,3200
    cg2raw dataset renders/ out/ --sensors nikon-d40 --illuminants 1 --format npy \\
                   --patches 8 --patch-size 256 --workers 4
    cg2raw dataset renders/ out/ --sensors nikon-d850 --illuminants 2 --method upi
"""

import argparse
import importlib.util
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

from cg2raw.cli._export_options import (
    add_bracket,
    add_colorspace,
    add_options,
    checked_options,
)
from cg2raw.cli._methods import add_method
from cg2raw.cli._numbers import number_list
from cg2raw.cli._pairs import asked_illuminants, asked_sensors, refuse_twice
from cg2raw.cli._progress import counted
from cg2raw.short_messages import plural
from cg2raw.spectra import is_estimate
from cg2raw.system import usable_cores

if TYPE_CHECKING:  # only the work itself loads its modules
    from cg2raw.dataset.journal import Row
    from cg2raw.dataset.plan import Plan
    from cg2raw.dataset.run import Summary

# Options of the core that are fields of a plan.
SIMULATION = (
    *("exposure", "exposure_time", "f_number", "scene_luminance", "nd_filter"),
    *("time_limits", "f_number_limits", "white_luminance", "noise", "convention"),
)
MOST_OF_IMAGE = 100000  # lights, and crops, of an image


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw dataset."""
    add = parser.add_argument
    add("inputs", nargs="+", metavar="IN", help="a folder, or images")
    add("out", metavar="OUT", help="folder of the data set; is made")
    add_content(parser.add_argument_group("what is made"))
    add_files(parser.add_argument_group("files"))
    group = parser.add_argument_group("work")
    group.add_argument(
        "--workers",
        type=positive,
        metavar="N",
        help="processes (default: one per core)",
    )
    group.add_argument(
        "--scheduler", metavar="tcp://HOST:8786", help="a Dask cluster in their place"
    )
    group.add_argument(
        "--verify",
        choices=("hash", "size"),
        default="hash",
        help="how finished files are checked when a data set is resumed (default hash)",
    )
    group.add_argument(
        "--dry-run",
        action="store_true",
        help="print how many rows, files and bytes it would be; write nothing",
    )
    group.add_argument("--quiet", action="store_true", help="errors alone")


def add_content(group: argparse._ArgumentGroup) -> None:
    """Declare the options on simulation."""
    add = group.add_argument
    add("--sensors", default="all", help='ids or .json files, or "all" (default)')
    add(
        "--illuminants",
        required=True,
        metavar="N|WORDS",
        help="how many are drawn for each image, or a list as A,D65,sample:0-3; "
        "estimate of spectral images",
    )
    add(
        "--light-draws",
        choices=["sample", "measured"],
        default="sample",
        help="of the Gaussian of the sensor's neutrals (default), or near themselves",
    )
    add(
        "--digital-gain",
        default="1",
        metavar="LIST",
        help='as 1,0.8, or "sample" of the sensor\'s profile (default 1)',
    )
    add("--iso", default="clean", help="as clean,100,3200 (default clean)")
    add_options(group, *SIMULATION)
    add_bracket(group)
    add_method(group)
    add("--seed", type=int, default=0, help="of all that is drawn (default 0)")
    add(
        "--frame-from",
        choices=("name", "index", "none"),
        default="name",
        help="noise differs by the image's name in IN (default), its place, or not",
    )
    add_options(group, "layer", "linearize")
    add_colorspace(group)


def add_files(group: argparse._ArgumentGroup) -> None:
    """Declare the options on what is written."""
    add = group.add_argument
    add("--format", default="dng", choices=["dng", "npy", "exr"])
    add(
        "--type",
        choices=["float32", "uint16"],
        help="of npy and exr: four half-size planes R, G1, G2, B, 0..1 above black "
        "(default float32)",
    )
    add(
        "--compression",
        choices=["ljpeg", "ljpeg-2d", "none"],
        help="of DNGs (default ljpeg; ljpeg-2d is smaller, but not for darktable)",
    )
    add("--crop", metavar="WxH", help="random crops of this size")
    add("--patch-size", type=positive, metavar="S", help="the same as --crop SxS")
    add("--patches", type=positive, metavar="N", help="crops per image (default 1)")


def positive(text: str) -> int:
    """Return a whole number above 0."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be a whole number of 1 or more")
    return int(text)


def check_count(option: str, count: int) -> int:
    """Return how many lights or crops an image gets. Raises ValueError."""
    if not 1 <= count <= MOST_OF_IMAGE:
        raise ValueError(f"{option} {count}: must be 1 to {MOST_OF_IMAGE}")
    return count


def run(arguments: argparse.Namespace) -> int:
    """Make the data set; return 1 if an image could not be used."""
    for library in ("OpenImageIO", "pyarrow"):
        if importlib.util.find_spec(library) is None:
            raise ValueError(f"needs {library}: pip install 'cg2raw[dataset]'")
    plan = plan_of(arguments)
    workers = arguments.workers or usable_cores()
    if arguments.workers and arguments.scheduler:
        raise ValueError("--workers and --scheduler: the cluster has its own workers")
    if arguments.dry_run:
        return dry_run(arguments, plan)
    from cg2raw.dataset.run import STOPPED, make_dataset

    try:
        summary = make_dataset(
            arguments.inputs,
            arguments.out,
            plan,
            workers=workers,
            scheduler=arguments.scheduler,
            watch=None if arguments.quiet else progress,
            verify=arguments.verify,
            tell=teller(arguments),
        )
    except KeyboardInterrupt:
        print(f"cg2raw dataset: {STOPPED}", file=sys.stderr)
        return 130
    if not arguments.quiet:
        report(arguments.out, summary)
    return list_bad(arguments, summary)


def teller(arguments: argparse.Namespace) -> Callable[[str], None]:
    """Return what prints a sentence that is no result and no error, if not quiet."""

    def tell(sentence: str) -> None:
        if not arguments.quiet:
            print(f"cg2raw dataset: {sentence}", file=sys.stderr)

    return tell


def dry_run(arguments: argparse.Namespace, plan: "Plan") -> int:
    """Print what would be made; return 0."""
    from cg2raw.dataset.estimate import estimate

    found = estimate(arguments.inputs, arguments.out, plan)
    for image, reason in found.bad.items():
        print(f"cg2raw dataset: skipped: {image}: {reason}", file=sys.stderr)
    size = "unknown: no image could be used"
    if found.bytes is not None:
        size = f"about {bytes_words(found.bytes)}, as crops of {found.measured} are"
    each = plan.files_of_an_image
    images = plural(found.images, "image")
    print(f"rows      {found.rows}: {images}, {plural(each, 'file')} of each")
    print(f"files     {found.files}: with dataset.json and the two manifests")
    print(f"size      {size}")
    print(f"--dry-run: nothing was written to {arguments.out}")
    return 0


def bytes_words(count: float) -> str:
    """Return a number of bytes as people read it."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} TB"


def plan_of(arguments: argparse.Namespace) -> "Plan":
    """Return the Plan that the options ask for. Raises ValueError."""
    from cg2raw import Sensor
    from cg2raw.dataset import options
    from cg2raw.dataset.kept_profiles import load_or_kept

    tell = teller(arguments)

    def leave_out(sentence: str) -> None:
        if arguments.sensors != "all":
            raise ValueError(sentence)
        tell(f"skipped: {sentence}")

    profiles = asked_sensors(
        arguments.sensors, lambda word: load_or_kept(word, arguments.out, tell)
    )
    isos = number_list("--iso", arguments.iso, "clean")
    return options.make_plan(
        [Sensor.from_profile(profile) for profile in profiles],
        leave_out,
        illuminants=illuminants(arguments.illuminants),
        light_draws=arguments.light_draws,
        digital_gains=tuple(
            number_list("--digital-gain", arguments.digital_gain, "sample")
        ),
        isos=tuple(None if iso == "clean" else iso for iso in isos),
        **simulation_fields(arguments),
        method=arguments.method,
        crop=crop_of(arguments),
        patches=check_count("--patches", arguments.patches or 1),
        seed=arguments.seed,
        layer=arguments.layer,
        linearize=arguments.linearize and arguments.linearize.lower(),
        space=arguments.iscolorspace,
        frame_from=arguments.frame_from,
        **files_of(arguments),
    )


def simulation_fields(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the plan's fields that are options of the core. Raises ValueError."""
    from cg2raw import _core

    fields: dict[str, Any] = {name: getattr(arguments, name) for name in SIMULATION}
    given = checked_options(arguments, (*SIMULATION, "layer", "linearize"))
    numbers = ("f_number", "scene_luminance", "nd_filter", "white_luminance")
    fields |= {name: float(given[name]) for name in numbers if name in given}
    words = {"convention": "dng", "noise": None}
    fields |= words | {name: given[name].lower() for name in words if name in given}
    if "exposure_time" in given:
        fields["exposure_time"] = _core.seconds_from_text(given["exposure_time"])
    if arguments.bracket is not None:
        fields["bracket"] = tuple(number_list("--bracket", arguments.bracket))
    return fields


def illuminants(words: str) -> int | tuple[str, ...]:
    """Return a number of drawn illuminants, or the words of a list."""
    if words.isdecimal():
        return check_count("--illuminants", int(words))
    found = [
        light
        for word in words.split(",")
        for light in ([word.strip()] if is_estimate(word) else asked_illuminants(word))
    ]
    refuse_twice("--illuminants", found)
    return tuple(found)


def files_of(arguments: argparse.Namespace) -> dict[str, str]:
    """Return the plan's fields on files. Raises ValueError for what has no effect."""
    if arguments.format == "dng" and arguments.type:
        raise ValueError(f"--type {arguments.type}: a DNG is uint16; see --format")
    if arguments.format != "dng" and arguments.compression:
        raise ValueError(f"--compression: of DNGs, not of {arguments.format}")
    return {
        "format": arguments.format,
        "element_type": arguments.type or "float32",
        "compression": arguments.compression or "ljpeg",
    }


def crop_of(arguments: argparse.Namespace) -> tuple[int, int] | None:
    """Return (width, height) of the crops, None for whole images. Raises ValueError."""
    if arguments.crop and arguments.patch_size:
        raise ValueError("--crop and --patch-size: give one of them")
    if arguments.patch_size:
        if arguments.patch_size == 1:
            raise ValueError("--patch-size 1: must be at least 2 pixels")
        size = f"{arguments.patch_size}x{arguments.patch_size}"
    elif arguments.crop:
        size = arguments.crop.lower()
    elif arguments.patches:
        raise ValueError("--patches: of which size? Add --patch-size or --crop")
    else:
        return None
    sides = size.split("x")
    if len(sides) != 2 or not all(side.isdecimal() and int(side) > 1 for side in sides):
        raise ValueError(f"--crop {size}: must be WxH in pixels, at least 2x2")
    return int(sides[0]), int(sides[1])


def progress(results: Iterable["Row"], images: int, each: int) -> Iterator["Row"]:
    """Yield @results of images with @each files, with a bar of files on a terminal."""
    working: dict[str, int] = {}  # how many are finished of images that are not done
    done = 0
    with counted("making", "files", images * each) as show:
        for row in results:
            if "files" in row:
                working[row["image"]] = row["files"]
            else:  # one that cannot be used needs no more work either
                working.pop(row["image"], None)
                done += each
            show(done + sum(working.values()))
            yield row


def report(out: str, summary: "Summary") -> None:
    """Print what was done."""
    kept = f", {summary.kept} of them kept" if summary.kept else ""
    files = plural(summary.made + summary.kept, "file")
    images = plural(summary.images - summary.bad, "image")
    manifest = os.path.join(out, "manifest.parquet")
    print(f"wrote     {manifest}: {files} of {images}{kept}")


def list_bad(arguments: argparse.Namespace, summary: "Summary") -> int:
    """List the images that could not be used; return the exit code."""
    if not summary.bad:
        return 0
    from cg2raw.dataset import manifest
    from cg2raw.dataset.images import Images

    images = Images(arguments.inputs, arguments.out)
    for image, reason in manifest.bad_images(os.path.realpath(arguments.out), images):
        print(f"cg2raw dataset: {image}: {reason}", file=sys.stderr)
    print(
        f"cg2raw dataset: {summary.bad} of {summary.images} images could not be used",
        file=sys.stderr,
    )
    return 1
