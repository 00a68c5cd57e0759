# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Render DNGs to PNGs: a quick look by LibRaw, with the file's own white balance.

Without -o the picture of shot.dng is shot.png in the current folder, and the command
prints where. It shows what is in the file: brightness is not adjusted, unless
--auto-bright says so.

examples:
  cg2raw render shot.dng
  cg2raw render shot.dng -o looks/shot.png --bits 16
  cg2raw render raw/*.dng -o looks/ --half
  cg2raw render dark.dng --brightness 4
"""

import argparse
from typing import Any

from cg2raw.cli._numbers import number
from cg2raw.cli._outputs import each_file, outputs_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw render."""
    add = parser.add_argument
    add("inputs", nargs="+", metavar="IN.dng", help="DNG or other RAW files")
    add("-o", "--output", metavar="OUT", help="a .png, or a folder; default: here")
    add("--bits", type=int, choices=(8, 16), default=8, help="per channel; default: 8")
    add("--half", action="store_true", help="half the size, without demosaicing")
    add(
        "--brightness",
        type=number(0.001, 1000),
        default=1.0,
        metavar="X",
        help="multiplies the picture; default: 1",
    )
    add(
        "--auto-bright",
        action=argparse.BooleanOptionalAction,
        default=False,
        help="stretch until 1 %% of the pixels clip; default: no",
    )
    add("--json", action="store_true", help="the report as JSON, for programs")
    add("--quiet", action="store_true", help="no report, no progress; errors only")


def run(arguments: argparse.Namespace) -> int:
    """Render all inputs; return 0, or 1 if one failed."""
    outputs = outputs_of(arguments.inputs, arguments.output, ".png")
    return each_file(
        "render",
        list(zip(arguments.inputs, outputs, strict=True)),
        lambda path, output: render(path, output, arguments),
        arguments,
        "rendering",
        lambda r: f"wrote     {r['output']}: {r['width']}x{r['height']}",
    )


def render(path: str, output: str, arguments: argparse.Namespace) -> dict[str, Any]:
    """Write the PNG of one file; return the report, of JSON's types."""
    from cg2raw import quick_look

    picture = quick_look.develop(
        path,
        bits=arguments.bits,
        half=arguments.half,
        brightness=arguments.brightness,
        auto_bright=arguments.auto_bright,
    )
    quick_look.write_png(output, picture)
    height, width, _ = picture.shape
    return {
        "input": path,
        "output": output,
        "width": width,
        "height": height,
        "bits": arguments.bits,
    }
