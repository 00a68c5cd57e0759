# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command scripts/evidence."""

import argparse
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from studies.cameras import FILES, NUS, Camera, known_camera, own_camera
from studies.docs_page import write_page
from studies.draws import JUDGE, LEARNED, RENDERS, Run, go_on, made_by_of
from studies.figures.files import figures_of_results, figures_of_world, write_figures
from studies.fingerprint import MadeBy, limited, made_by, need_pinned
from studies.mitsuba_judge.folder import PATTERN, judge_frames
from studies.places import (
    DATA_VARIABLE,
    LUXPY_VARIABLE,
    data_folder,
    files_hash,
    luxpy_folder,
)
from studies.protocol import PROTOCOL
from studies.results import (
    Results,
    add,
    entry_of,
    others,
    read_results,
    set_aside,
    write_results,
)
from studies.sources.renders import read_renders
from studies.summaries import COMMITTED, Summaries, read_committed, summaries
from studies.tables_of_results import tables_by_study, together
from studies.tasks.classical import classical
from studies.tasks.colour import colour
from studies.tasks.illuminant import need_torch
from studies.world.shots import KINDS, World, load_world

Study = Callable[[World, Camera, str], Any]  # world, camera, quick or full
TABLES = "tables.md"
STOPPED = 130  # as shells have it: 128 and SIGINT


def run_classical(world: World, camera: Camera, mode: str) -> Any:
    """Return the errors of classical methods; None of a camera without grey cards."""
    frames = world.protocol.classical.frames[mode]
    return classical(world, camera, frames) if camera.id in NUS else None


def run_colour(world: World, camera: Camera, mode: str) -> Any:
    """Return study 0's errors by kind of scenes."""
    frames = world.protocol.colour.frames[mode]
    return {kind: colour(world, camera, kind, frames) for kind in KINDS}


MEASURED: dict[str, Study] = {"classical": run_classical, "colour": run_colour}
STUDIES = (*MEASURED, *LEARNED)
HOURS = ("light_draws", "held_out_leds", "denoising_unet", "isp_unet")
PHOTOGRAPHS = "photographs"
NEED_TORCH = ("illuminant", *HOURS)


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """Return the command line."""
    parser = argparse.ArgumentParser(
        prog="evidence",
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
    add_places(parser)
    parser.set_defaults(mode="quick")
    found = parser.parse_args(given)
    unknown = [name for name in found.studies if name not in STUDIES]
    if unknown:
        parser.error(f"study {unknown[0]} must be one of {', '.join(STUDIES)}")
    if (found.ssf is None) != (found.sensor is None):
        parser.error("--ssf and --sensor go together: sensitivities and profile")
    if found.docs and found.mode != "full":
        parser.error("--docs needs --full: no page has numbers of few frames")
    return found


def add_places(parser: argparse.ArgumentParser) -> None:
    """Add the options of what is read from where, and written to where."""
    parser.add_argument(
        "--ssf", type=Path, help="sensitivities of a camera of your own (.csv, .json)"
    )
    parser.add_argument("--sensor", type=Path, help="that camera's profile (.json)")
    parser.add_argument(
        "--renders",
        type=Path,
        help="folder of rendered images that RAW is made of, in place of the world's",
    )
    parser.add_argument(
        "--judge",
        type=Path,
        help="folder of mitsuba-judge: more test frames for scenes at night",
    )
    parser.add_argument("--data", type=Path, help="folder of camera data")
    parser.add_argument(
        "--luxpy", type=Path, help=f"folder of luxpy's data; or {LUXPY_VARIABLE}"
    )
    parser.add_argument(
        "-o", "--out", type=Path, default=Path("out/study"), help="%(default)s"
    )
    parser.add_argument(
        "--docs",
        action="store_true",
        help="with --full: put results into docs/evidence.json, and tables and figures "
        "of all that is there into docs/evidence.md",
    )


def cameras(given: argparse.Namespace, data: Path, study: str) -> list[Camera]:
    """Return the cameras that a command line names, or the protocol's of a study."""
    if given.ssf is not None:
        return [own_camera(given.ssf, given.sensor, data)]
    if given.cameras is not None:
        names = given.cameras.split(",")
    else:
        names = list(getattr(PROTOCOL, study).cameras[given.mode])
    return [known_camera(name, data) for name in names]


def asked(names: list[str], mode: str) -> list[str]:
    """Return the studies of a command line; of all, those that can run here.

    Those that take hours are among all in full mode alone."""
    if set(names) & set(NEED_TORCH):
        need_torch()
    if names:
        return names
    found = [name for name in STUDIES if mode == "full" or name not in HOURS]
    needs = [(need_torch, NEED_TORCH), (LEARNED[PHOTOGRAPHS].files, (PHOTOGRAPHS,))]
    for need, studies in needs:
        try:
            need()
        except ValueError as error:
            warn(f"left out: {error}")
            found = [name for name in found if name not in studies]
    return found


def prepared(given: argparse.Namespace, luxpy: Path | None) -> Run:
    """Return the Run of a command line. Raises ValueError for data that are missing."""
    if luxpy is None:
        said = (
            "no data files of luxpy: colour-science's reflectances and lamps stand for "
            "IES TM-30's, by which the world was calibrated; --luxpy names the folder"
        )
        if given.docs:
            raise ValueError(said)
        warn(said)
    world = load_world(luxpy, PROTOCOL)
    run = Run(world, given.mode, read_results(given.out), given.out, warn)
    folders = {}
    if given.renders is not None:
        renders = read_renders(given.renders, PROTOCOL.scene)
        run = replace(run, renders=renders)
        folders[RENDERS] = renders.digest
    if given.judge is not None:
        run = replace(run, judge=partial(judge_frames, given.judge))
        folders[JUDGE] = files_hash(sorted(given.judge.glob(PATTERN)))
    return replace(run, folders=folders)


def made_by_in(run: Run, study: str, entry: str) -> MadeBy:
    """Return what an entry of any study would be made by in a run."""
    if study in LEARNED:
        return made_by_of(run, study, entry)
    module = f"studies.tasks.{study}"
    return made_by(run.world, run.mode, [study], [module], [MEASURED[study]])


def without_others(run: Run, studies: list[str]) -> Results:
    """Return the results of a run less those that its studies would make otherwise now.

    The file that has them is kept under another name."""
    differs = {}
    for name in run.results:
        study, _, made_of = name.partition(", ")
        parts = set(made_of.split(", ")) & {RENDERS, JUDGE}
        if study in studies and parts <= set(run.folders):
            if found := others(run.results, name, made_by_in(run, study, name)):
                differs[name] = found
    if not differs:
        return run.results
    kept = set_aside(run.folder)
    said = "; ".join(f"{name} in {', '.join(of)}" for name, of in differs.items())
    warn(f"earlier results differ: {said}: they are in {kept} now")
    return {name: of for name, of in run.results.items() if name not in differs}


def run(given: argparse.Namespace) -> str:
    """Run the studies of a command line and return their tables. Raises ValueError."""
    need_pinned()
    luxpy, data = luxpy_folder(given.luxpy), data_folder(given.data)
    os.environ[DATA_VARIABLE] = str(data)  # for all that look for it
    names = asked(given.studies, given.mode)
    prepared_run = prepared(given, luxpy)
    results = without_others(prepared_run, names)
    prepared_run = replace(prepared_run, results=results)
    world = prepared_run.world
    for name in names:
        for camera in cameras(given, data, name):
            if name in LEARNED:
                go_on(prepared_run, name, camera)
                continue
            if entry_of(results, camera, name):
                continue
            entry = MEASURED[name](limited(world, [name]), camera, given.mode)
            if entry is None:
                warn(f"{name}: {camera.id} has no grey cards of NUS: left out")
                continue
            add(results, camera, name, entry, made_by_in(prepared_run, name, name))
            write_results(given.out, results)
    given.out.mkdir(parents=True, exist_ok=True)
    made = summaries(results)
    found = tables_by_study(made, world.protocol.classical.within)
    (given.out / TABLES).write_text(together(found))
    shown = figures_of_world(prepared_run, cameras(given, data, "isp")[0], names)
    write_figures(given.out, figures_of_results(made) | shown)
    if given.docs:
        for line in replaced(read_committed(), made):
            warn(line)
        write_page(made, given.out)
    return together(found)


def replaced(committed: Summaries, made: Summaries) -> list[str]:
    """Return a line for each committed study of which summaries are made otherwise."""
    differs = {
        name: others(committed, name, of["made by"]) for name, of in made.items()
    }
    return [
        f"{COMMITTED.name} had {name} with other {', '.join(found)}: it is replaced"
        for name, found in differs.items()
        if found
    ]


def warn(message: str) -> None:
    """Print one line on stderr."""
    print(f"evidence: {message}", file=sys.stderr)


def main(given: list[str] | None = None) -> int:
    """Run the command; one line on stderr and exit 1 for data that are missing, and
    130 if it is stopped."""
    try:
        print(run(arguments(given)), end="")
    except KeyboardInterrupt:
        warn("stopped: the same command goes on after the last draw that was done")
        return STOPPED
    except ValueError as error:
        warn(str(error))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
