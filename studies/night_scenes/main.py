# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command ./studies/run night-scenes."""

import argparse
import os
import sys

from ..arguments import whole
from .choices.scenes import COUNT, kind_and_layout
from .folder import Folder, Refused, Settings, name
from .run import render, terminable

DESCRIPTION = """Render scenes at night: streets, squares, waterfronts and rooms, each
drawn from its index. What is complete in FOLDER is kept, so a run can be ended and
started again."""


def parser():
    """Return the command line's parser."""
    made = argparse.ArgumentParser(prog="night-scenes", description=DESCRIPTION)
    add = made.add_argument
    add(
        "folder",
        metavar="FOLDER",
        nargs="?",
        help="of night_0000.exr ... and their .json",
    )
    add("-n", "--count", type=whole(1), default=COUNT, metavar="N", help="frames")
    add("--first", type=whole(0), default=0, metavar="INDEX", help="the first one")
    add(
        "--only",
        type=whole(0),
        nargs="+",
        metavar="INDEX",
        help="these frames, in place of --first and --count",
    )
    add("--width", type=whole(16), default=1280, metavar="PIXELS", help="16:9")
    add("--samples", type=whole(1), default=24, help="paths per pixel, then denoised")
    add("--workers", type=whole(1), default=1, metavar="N", help="processes")
    add("--log", metavar="FILE", help="what Blender says")
    add("--list", action="store_true", help="print kinds and layouts, render nothing")
    add("--statistics", action="store_true", help="measure how FOLDER's frames differ")
    add("--contact-sheet", metavar="PNG", help="write a picture of FOLDER's frames")
    return made


def chosen(options):
    """Return the indices that the options name, each once."""
    if options.only:
        return sorted(set(options.only))
    return list(range(options.first, options.first + options.count))


def render_all(options):
    """Render what is missing."""
    indices = chosen(options)
    threads = max(1, len(os.sched_getaffinity(0)) // options.workers)
    settings = Settings(options.width, options.samples)
    say = line_printer()
    with terminable(), Folder(options.folder, settings) as folder:
        if options.log:
            with open(options.log, "a") as log:
                render(folder, indices, options.workers, threads, say, log=log)
        else:
            render(folder, indices, options.workers, threads, say)
    say(f"all {len(indices)} frames are in {options.folder}")


def line_printer():
    """Return a function that prints a line at once, also into a pipe."""
    return lambda line: print(line, flush=True)


def main(arguments=None):
    """Run the command; return its exit status."""
    command = parser()
    options = command.parse_args(arguments)
    if options.folder is None and not options.list:
        command.error("FOLDER is missing")
    try:
        if options.list:
            for index in chosen(options):
                print(name(index), *kind_and_layout(index), sep="\t")
        elif options.statistics:
            from .statistics import report

            print(report(options.folder))
        elif options.contact_sheet:
            from .contact_sheet import write

            write(options.folder, options.contact_sheet)
        else:
            render_all(options)
    except KeyboardInterrupt:
        print(
            "\nnight-scenes: ended; the same command goes on from here", file=sys.stderr
        )
        return 130
    except BrokenPipeError:
        return 141
    except (Refused, OSError, ValueError) as error:
        print(f"night-scenes: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
