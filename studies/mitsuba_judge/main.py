# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command ./studies/run mitsuba-judge."""

import argparse
import os
import sys
from pathlib import Path

import numpy as np

from studies.arguments import whole
from studies.cameras import FILES, Camera, known_camera
from studies.mitsuba_judge.folder import Settings
from studies.mitsuba_judge.report import contact_sheet, grain
from studies.mitsuba_judge.run import Renderer, render
from studies.places import LUXPY_VARIABLE, data_folder, luxpy_folder
from studies.world.shots import load_world

PYTHON_VARIABLE = "CG2RAW_MITSUBA_PYTHON"
AGAIN = "again"  # below the folder: the same scenes, other paths
DEVELOPED_BY = "sony-a7s-ii"


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """Return the command line."""
    parser = argparse.ArgumentParser(
        prog="mitsuba-judge",
        description="Render streets and squares at night in spectra by Mitsuba 3, as "
        "the study's cameras see them. Each is drawn from its index; a frame that is "
        "in FOLDER is kept.",
    )
    add = parser.add_argument
    add("folder", type=Path, metavar="FOLDER", help="of judge_0000.npz and their .json")
    add("-n", "--count", type=whole(1), default=40, metavar="N", help="frames")
    add("--width", type=whole(32), default=128, metavar="PIXELS", help="4:3")
    add("--samples", type=whole(4), default=400, metavar="N", help="paths a pixel")
    add("--threads", type=whole(1), default=1, metavar="N", help="%(default)s")
    add(
        "--cameras",
        default=",".join(FILES),
        help=f"ids with commas; {DEVELOPED_BY}, by which frames are shown, among them",
    )
    add(
        "--grain",
        type=whole(1),
        metavar="N",
        help=f"render the first N again, into FOLDER/{AGAIN}, and say how they differ",
    )
    add("--contact-sheet", type=Path, metavar="JPG", help="write a picture of FOLDER")
    add("--data", type=Path, help="folder of camera data")
    add("--luxpy", type=Path, help=f"folder of luxpy's data; or {LUXPY_VARIABLE}")
    return parser.parse_args(given)


def run(given: argparse.Namespace) -> None:
    """Run a command line. Raises ValueError, OSError."""
    data, luxpy = data_folder(given.data), luxpy_folder(given.luxpy)
    cameras = [known_camera(name, data) for name in given.cameras.split(",")]
    shown = known_camera(DEVELOPED_BY, data)
    if given.contact_sheet:
        contact_sheet(given.folder, shown, given.contact_sheet)
        return
    render_all(given, cameras, luxpy)
    if given.grain:
        count = min(given.grain, given.count)
        found = grain(given.folder, given.folder / AGAIN, shown, count)
        print(
            f"grain: {np.mean(found):.2f} CIEDE2000 between two draws of the paths "
            f"({min(found):.2f} to {max(found):.2f}, {count} frames)"
        )


def render_all(
    given: argparse.Namespace, cameras: list[Camera], luxpy: Path | None
) -> None:
    """Render what is missing. Raises ValueError, OSError."""
    if luxpy is None:
        print(
            "mitsuba-judge: no data files of luxpy: colour-science's reflectances and "
            "lamps stand for IES TM-30's; --luxpy names the folder",
            file=sys.stderr,
        )
    world = load_world(luxpy)
    renderer = Renderer(os.environ.get(PYTHON_VARIABLE, sys.executable), given.threads)
    for draw, folder, count in (
        (0, given.folder, given.count),
        (1, given.folder / AGAIN, min(given.grain or 0, given.count)),
    ):
        ids = tuple(camera.id for camera in cameras)
        settings = Settings(given.width, given.samples, draw, ids, world.hashes())
        if count:
            render(folder, range(count), settings, world, cameras, renderer, say)
            say(f"all {count} frames are in {folder}")


def say(line: str) -> None:
    """Print a line at once, also into a pipe."""
    print(line, flush=True)


def main(given: list[str] | None = None) -> int:
    """Run the command; one line on stderr and exit 1 for what is missing."""
    try:
        run(arguments(given))
    except KeyboardInterrupt:
        print("\nmitsuba_judge: ended; the same command goes on", file=sys.stderr)
        return 130
    except (ValueError, OSError) as error:
        print(f"mitsuba-judge: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
