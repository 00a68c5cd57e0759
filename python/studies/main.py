# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command of ./scripts/study."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from studies.cameras import FILES, NUS, Camera, known_camera, own_camera
from studies.places import LUXPY_VARIABLE, data_folder, luxpy_folder
from studies.protocol import PROTOCOL
from studies.results import (
    Results,
    add,
    fingerprint,
    of_study,
    read_results,
    write_results,
)
from studies.tables import classical_tables, colour_tables
from studies.tables_denoising import denoising_tables
from studies.tables_illuminant import illuminant_tables
from studies.tables_isp import isp_tables
from studies.tasks.classical import classical
from studies.tasks.colour import colour
from studies.tasks.denoising import denoising
from studies.tasks.illuminant import illuminant, need_torch
from studies.tasks.isp import isp
from studies.world.shots import KINDS, World, load_world

Study = Callable[[World, Camera, str], Any]  # world, camera, quick or full
TABLES = "tables.md"
LEARNED: dict[str, Callable[[Any], str]] = {
    "illuminant": illuminant_tables,
    "denoising": denoising_tables,
    "isp": isp_tables,
}


def run_classical(world: World, camera: Camera, mode: str) -> Any:
    """Return the errors of classical methods; None of a camera without grey cards."""
    frames = world.protocol.classical.frames[mode]
    return classical(world, camera, frames) if camera.id in NUS else None


def run_colour(world: World, camera: Camera, mode: str) -> Any:
    """Return study 0's errors by kind of scenes."""
    frames = world.protocol.colour.frames[mode]
    return {kind: colour(world, camera, kind, frames) for kind in KINDS}


STUDIES: dict[str, Study] = {
    "classical": run_classical,
    "colour": run_colour,
    "illuminant": illuminant,
    "denoising": denoising,
    "isp": isp,
}


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """Return the command line."""
    parser = argparse.ArgumentParser(
        prog="study",
        description="What training data by cg2raw is worth, on scenes of measured "
        "spectra. Tables go to the terminal and, with every frame, to OUT.",
    )
    parser.add_argument(
        "studies", nargs="*", metavar="STUDY", help=f"{', '.join(STUDIES)}; all"
    )
    modes = parser.add_mutually_exclusive_group()
    for mode, about in (("quick", "few frames (default)"), ("full", "many frames")):
        modes.add_argument(
            f"--{mode}", dest="mode", action="store_const", const=mode, help=about
        )
    parser.add_argument(
        "--cameras",
        help=f"ids with commas, of {', '.join(FILES)} (default: protocol.toml's)",
    )
    parser.add_argument(
        "--ssf", type=Path, help="sensitivities of a camera of your own (.csv, .json)"
    )
    parser.add_argument("--sensor", type=Path, help="that camera's profile (.json)")
    parser.add_argument("--data", type=Path, help="folder of camera data")
    parser.add_argument(
        "--luxpy", type=Path, help=f"folder of luxpy's data; or {LUXPY_VARIABLE}"
    )
    parser.add_argument(
        "-o", "--out", type=Path, default=Path("out/study"), help="%(default)s"
    )
    parser.set_defaults(mode="quick")
    found = parser.parse_args(given)
    unknown = [name for name in found.studies if name not in STUDIES]
    if unknown:
        parser.error(f"study {unknown[0]} must be one of {', '.join(STUDIES)}")
    if (found.ssf is None) != (found.sensor is None):
        parser.error("--ssf and --sensor go together: sensitivities and profile")
    return found


def cameras(given: argparse.Namespace, data: Path, study: str) -> list[Camera]:
    """Return the cameras that a command line names, or the protocol's of a study."""
    if given.ssf is not None:
        return [own_camera(given.ssf, given.sensor, data)]
    if given.cameras is not None:
        names = given.cameras.split(",")
    else:
        names = list(getattr(PROTOCOL, study).cameras[given.mode])
    return [known_camera(name, data) for name in names]


def tables(results: Results, within: float) -> str:
    """Return all tables of results in Markdown."""
    parts = []
    if found := of_study(results, "classical"):
        parts.append(classical_tables(found, within))
    if found := of_study(results, "colour"):
        for kind in KINDS:
            of_kind = {camera: entry[kind] for camera, entry in found.items()}
            parts.append(colour_tables(of_kind, kind))
    for name, tables_of in LEARNED.items():
        if found := of_study(results, name):
            parts.append(tables_of(found))
    return "\n\n".join(parts) + "\n"


def asked(names: list[str]) -> list[str]:
    """Return the studies of a command line; of all, those that can run here."""
    if "illuminant" in names:
        need_torch()
    if names:
        return names
    try:
        need_torch()
    except ValueError as error:
        warn(f"left out: {error}")
        return [name for name in STUDIES if name != "illuminant"]
    return list(STUDIES)


def run(given: argparse.Namespace) -> str:
    """Run the studies of a command line and return their tables. Raises ValueError."""
    luxpy, data = luxpy_folder(given.luxpy), data_folder(given.data)
    if luxpy is None:
        warn(
            "no data files of luxpy: colour-science's reflectances and lamps stand for "
            "IES TM-30's, by which the world was calibrated; --luxpy names the folder"
        )
    world = load_world(luxpy, PROTOCOL)
    expected = {**fingerprint(world), "mode": given.mode}
    results, differs = read_results(given.out, expected)
    if differs:
        warn(f"{given.out}: earlier results differ in {', '.join(differs)}: left out")
    for name in asked(given.studies):
        for camera in cameras(given, data, name):
            entry = STUDIES[name](world, camera, given.mode)
            if entry is None:
                warn(f"{name}: {camera.id} has no grey cards of NUS: left out")
                continue
            add(results, camera, name, entry)
            write_results(given.out, results)
    given.out.mkdir(parents=True, exist_ok=True)
    text = tables(results, world.protocol.classical.within)
    (given.out / TABLES).write_text(text)
    return text


def warn(message: str) -> None:
    """Print one line on stderr."""
    print(f"study: {message}", file=sys.stderr)


def main(given: list[str] | None = None) -> int:
    """Run the command; one line on stderr and exit 1 for data that are missing."""
    try:
        print(run(arguments(given)), end="")
    except ValueError as error:
        warn(str(error))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
