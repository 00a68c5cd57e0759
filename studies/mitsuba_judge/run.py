# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Renders the frames that a folder lacks, in a process that has Mitsuba."""

import json
import os
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.cameras import Camera
from studies.mitsuba_judge.folder import (
    Settings,
    accept,
    frame_path,
    is_done,
    part_path,
)
from studies.mitsuba_judge.scene import Scene, scene
from studies.places import ROOT
from studies.world.shots import World

MODULE = "studies.mitsuba_judge.worker"  # its process knows nothing of cg2raw
FAR = 1_000_003  # between the seeds of two draws


@dataclass(frozen=True)
class Renderer:
    """The Python that has mitsuba, and on how many threads it renders."""

    python: str
    threads: int

    def start(self) -> subprocess.Popen[str]:
        """Return the worker's process, to be used in a with statement."""
        return subprocess.Popen(
            (self.python, "-m", MODULE),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )


def render(
    folder: Path,
    indices: Sequence[int],
    settings: Settings,
    world: World,
    cameras: Sequence[Camera],
    renderer: Renderer,
    say: Callable[[str], None],
) -> None:
    """Render those of the indices that a folder lacks.

    Raises ValueError naming the frame that failed, or that has other settings."""
    folder.mkdir(parents=True, exist_ok=True)
    missing = [i for i in indices if not is_done(frame_path(folder, i), settings)]
    if not missing:
        return
    with renderer.start() as worker:
        for count, index in enumerate(missing, 1):
            what, path = scene(index, world), frame_path(folder, index)
            part = part_path(folder, index)
            asked = request(what, part, settings, cameras, renderer.threads)
            seconds = answered(worker, asked, path)
            accept(part, path, described(what, settings, cameras))
            about = f"{what.kind}, {what.sky}, {'wet' if what.wet else 'dry'}"
            say(f"[{count}/{len(missing)}] {path.name}  {about}  {seconds:.0f} s")


def request(
    what: Scene,
    part: Path,
    settings: Settings,
    cameras: Sequence[Camera],
    threads: int,
) -> dict[str, Any]:
    """Return what the worker is asked for."""
    return {
        "path": str(part.resolve()),
        "seed": what.index + FAR * settings.draw,
        "threads": threads,
        "cameras": [camera.id for camera in cameras],
        "film": {
            "width": settings.width,
            "height": settings.height,
            "samples": settings.samples,
            "channels": [c for each in cameras for c in each.sensitivities.T.tolist()],
        },
        "scene": what.as_json(),
    }


def answered(worker: subprocess.Popen[str], asked: dict[str, Any], path: Path) -> float:
    """Return the seconds that a frame took. Raises ValueError if it failed."""
    line = ""
    if worker.stdin is not None and worker.stdout is not None:
        try:
            print(json.dumps(asked), file=worker.stdin, flush=True)
            line = worker.stdout.readline()
        except OSError:  # its pipe is closed
            line = ""
    if not line:
        raise ValueError(f"{path}: the worker ended with {worker.wait()}")
    answer = json.loads(line)
    if answer["error"]:
        raise ValueError(f"{path}: {answer['error']}")
    return float(answer["seconds"])


def described(
    what: Scene, settings: Settings, cameras: Sequence[Camera]
) -> dict[str, Any]:
    """Return a frame's description: settings, scene and the main light's neutrals."""
    main = what.spectra.lights[[what.main]]
    neutrals = {
        camera.id: camera.neutrals(main)[0].round(7).tolist() for camera in cameras
    }
    return {**settings.as_json(), "scene": what.described(), "neutrals": neutrals}
