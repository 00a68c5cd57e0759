# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Real: darks and flats that a camera took, in two halves. One is calibrated; in the
other an effect is planted, and diagnosed by the profile of the first."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from numpy.random import Generator

from cg2raw.calibration import UniformFrame, calibrate
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.manifest import Frame
from cg2raw.diagnose.captures.reader import divided, read_frames, stratum
from cg2raw.diagnose.effects import catalogue
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.sensor import Sensor
from cg2raw.synthetic.synthetic_camera import stream
from studies.diagnose.planted import PLANTS, levels_of, planted

# Effects that darks do not show.
OF_LIGHT = catalogue.of_images() | {
    *("dust", "mains_flicker", "pdaf_pixels", "prnu", "shot_noise")
}
DISTINCT = 1.2  # ratio of the levels of two flats that show a curve
MANIFEST = "captures.yaml"  # of a folder
PLANTED, CALIBRATED = 6, 4  # frames that repeat each other; 6 are two a split
NEEDED = "its darks and flats by --captures captures.yaml, or a folder with one"


def manifest_of(captures: str | os.PathLike[str] | None) -> Path:
    """Return the manifest of a real suite. Raises ValueError without one."""
    if captures is None:
        raise ValueError(f"suite real reads frames of a camera: give {NEEDED}")
    path = Path(captures)
    path = path / MANIFEST if path.is_dir() else path
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file: give {NEEDED}")
    return path


def plantable(path: Path) -> list[str]:
    """Return the effects that can be planted in a manifest's frames and seen there.

    Raises ValueError for other captures than darks and flats, and for a bad manifest.
    """
    _, sensor, frames, _ = read_frames(path)
    captures = [frame.capture for frame in frames]
    for capture in captures:
        if capture.kind not in ("dark", "flat"):
            raise ValueError(
                f"{path}: {capture.name}: kind {capture.kind} must be dark or flat, "
                "which the suite real calibrates: take it out"
            )
    flats = [capture for capture in captures if capture.kind == "flat"]
    times = [flat.exposure_time or 0.0 for flat in flats]
    hidden = set()
    if not flats or any(flat.scene is None for flat in flats):
        hidden.add("exposure")
    if not flats or max(times) < DISTINCT * min(times):
        hidden.add("nonlinearity")
    known = {effect.name: effect for effect in candidates(sensor.cfa)}
    return [
        name
        for name in PLANTS
        if name in known and name not in hidden and (flats or name not in OF_LIGHT)
    ]


def halves(
    frames: Sequence[Frame], rng: Generator | None = None
) -> tuple[list[Frame], list[Frame]]:
    """Return frames in two halves, to calibrate and to plant in, by turns within kind
    and exposure. Where there are enough, each split of the second has two of each.

    rng : draws which of those that repeat each other go where; None for their order."""
    ordered = list(frames)
    if rng is not None:
        ordered = [frames[int(n)] for n in rng.permutation(len(frames))]
    # Temperature comes last in a stratum, and a cooler leaves it to chance.
    repeated: dict[tuple[Any, ...], list[Frame]] = {}
    for frame in ordered:
        key = (frame.capture.kind, *stratum(frame)[:-1])
        repeated.setdefault(key, []).append(frame)
    first: list[Frame] = []
    second: list[Frame] = []
    for _, group in sorted(repeated.items()):
        total = len(group)
        count = max(total // 2, min(PLANTED, total - CALIBRATED))
        places = {int((n + 0.5) * total / count) for n in range(count)}
        for n, frame in enumerate(group):
            (second if n in places else first).append(frame)
    return first, second


@lru_cache(maxsize=1)  # cases of one division follow each other
def calibrated(path: Path, division: int | None) -> tuple[Sensor, tuple[Frame, ...]]:
    """Return (the sensor with the profile of the first half, the second half).

    division : seed of a random one; None for that by the order of the frames. Raises
    ValueError for frames that cannot be calibrated."""
    _, sensor, frames, _ = read_frames(path)
    rng = None if division is None else stream(division, "halves")
    first, second = halves(frames, rng)
    calm = [uniform(frame.capture) for frame in first]
    return calibrated_by(sensor, calm), tuple(
        replace(frame, borders=()) for frame in second
    )


def calibrated_by(sensor: Sensor, frames: Sequence[UniformFrame]) -> Sensor:
    """Return a sensor with the profile that calibrate makes of darks and flats."""
    text = calibrate(sensor, frames, threads=1).updated_profile()
    return Sensor.from_json(text, f"{sensor.id}, calibrated")


def uniform(capture: Capture) -> UniformFrame:
    """Return a dark or flat as calibrate reads it."""
    return UniformFrame(
        capture.name,
        "dark" if capture.kind == "dark" else "flat",
        capture.raw,
        capture.exposure_time,
        capture.iso,
        capture.temperature,
    )


@dataclass(frozen=True)
class RealCase:
    """One half of real frames, with at most one effect planted. path : of the manifest.
    The other fields as of suites.Case."""

    suite: str
    number: int
    seed: int
    strengths: dict[str, float]
    path: Path
    without: tuple[str, ...] = ()

    def captures(self) -> tuple[CaptureSet, dict[str, dict[str, float]]]:
        """Return (the second half with the first's profile, what is planted in it)."""
        manifest = read_frames(self.path)[0]
        sensor, second = calibrated(self.path, None if self.strengths else self.seed)
        frames = list(second)
        for name, strength in self.strengths.items():
            frames = self._planted(frames, sensor, name, strength)
        captures, notes = divided(frames)
        found = CaptureSet(
            sensor=sensor,
            captures=captures,
            nuisances=manifest.nuisances,
            uncertainty=manifest.uncertainty,
            file=manifest.file,
            notes=notes,
        )
        return found, {name: {"strength": s} for name, s in self.strengths.items()}

    def _planted(
        self, frames: list[Frame], sensor: Sensor, name: str, strength: float
    ) -> list[Frame]:
        captures = [frame.capture for frame in frames]
        isos = [capture.iso for capture in captures if capture.iso is not None]
        iso = isos[0] if isos else float(sensor.noise[0]["iso"])
        levels = levels_of(sensor, iso, captures)
        changed = []
        for frame in frames:
            one = frame.capture
            raw = partial(planted, one, name, strength, levels, self.seed)
            changed.append(replace(frame, capture=replace(one, raw=raw)))
        return changed

    def evidence(self, _: Sequence[str]) -> dict[str, float]:
        """Nobody knows the density of real frames."""
        return {}

    def expected(self) -> dict[str, dict[str, float]]:
        """Nobody knows what is in real frames besides."""
        return {}
