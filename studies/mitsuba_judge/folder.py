# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The folder of the second judge's frames: judge_0000.npz ..., each with a .json."""

import json
import os
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from studies.sources.frames import Frames, framed

GENERATOR = 1  # raised when the same index no longer gives the same picture
PATTERN = "judge_[0-9]*.npz"
MADE_BY = "./studies/run mitsuba-judge"


@dataclass(frozen=True)
class Settings:
    """What all frames of a folder share."""

    width: int  # pixels, 4:3
    samples: int  # paths a pixel
    draw: int  # of the paths; another one tells what is grain
    cameras: tuple[str, ...]
    world: dict[str, str]  # hashes of its spectra

    @property
    def height(self) -> int:
        """Return the height in pixels."""
        return self.width * 3 // 4

    def as_json(self) -> dict[str, Any]:
        """Return what a description says of them."""
        return {
            "generator": GENERATOR,
            **asdict(self),
            "cameras": list(self.cameras),
            "height": self.height,
        }


def frame_path(folder: Path, index: int) -> Path:
    """Return the path of a frame."""
    return folder / f"judge_{index:04d}.npz"


def part_path(folder: Path, index: int) -> Path:
    """Return the path that a frame is rendered to."""
    return folder / f"judge_{index:04d}.part"


def is_done(path: Path, settings: Settings) -> bool:
    """Return whether a frame is there; it has its name since it was complete.

    Raises ValueError if it was made with other settings: a set must not be mixed."""
    if not path.exists():
        return False
    found = description(path)
    for key, value in settings.as_json().items():
        if found.get(key) != value:
            raise ValueError(
                f"{path}: {key} is {found.get(key)}, not {value}: give another folder, "
                "or remove the frames"
            )
    return True


def accept(part: Path, path: Path, described: dict[str, Any]) -> None:
    """Give a rendered frame its name, its description first. Raises OSError."""
    text = path.with_suffix(".json")
    unfinished = text.with_suffix(".json.part")
    unfinished.write_text(json.dumps(described, indent=1) + "\n")
    os.replace(unfinished, text)
    os.replace(part, path)


def description(path: Path) -> dict[str, Any]:
    """Return what a frame's .json says. Raises ValueError naming the file."""
    text = path.with_suffix(".json")
    try:
        found = json.loads(text.read_text())
    except (OSError, ValueError) as error:
        raise ValueError(f"{text}: cannot be read: {error}") from None
    if not isinstance(found, dict) or "neutrals" not in found:
        raise ValueError(f"{text}: has no neutrals")
    return found


def judge_frames(folder: Path | str, camera: str) -> Frames:
    """Return the Frames of a folder as a camera has them: unbounded camera RGB.

    Neutrals are of the light of which there is most in each scene.
    Raises ValueError for a folder without frames, a camera that they are not of, and a
    file that is no good."""
    paths = sorted(Path(folder).glob(PATTERN))
    if not paths:
        raise ValueError(
            f"{folder}: holds no frames of the second judge ({MADE_BY} {folder} makes "
            "them)"
        )
    return framed((image_of(path, camera), neutral_of(path, camera)) for path in paths)


def image_of(path: Path, camera: str) -> Any:
    """Return camera RGB (H, W, 3). Raises ValueError naming the file."""
    try:
        with np.load(path) as file:
            found = {name: file[name] for name in file.files if name == camera}
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise ValueError(f"{path}: cannot be read: {error}") from None
    if camera not in found:
        raise ValueError(f"{path}: has no camera {camera}")
    image = found[camera]
    if image.ndim != 3 or image.shape[2] != 3 or not np.isfinite(image).all():
        raise ValueError(f"{path}: {camera} is no image of three channels")
    return np.asarray(image, np.float32)


def neutral_of(path: Path, camera: str) -> Any:
    """Return the neutral (3,), G = 1. Raises ValueError naming the file."""
    found = description(path)
    if found.get("generator") != GENERATOR:
        raise ValueError(
            f"{path}: is of generator {found.get('generator')}, not {GENERATOR}: "
            f"remove the frames; {MADE_BY} makes new ones"
        )
    if camera not in found["neutrals"]:
        raise ValueError(f"{path.with_suffix('.json')}: has no neutral of {camera}")
    return np.array(found["neutrals"][camera], np.float64)
