# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Benchmark suites: which case hides which effects, set by seed and number alone."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.random import Generator

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.sensor import Sensor
from cg2raw.synthetic.camera import Camera, camera_of
from cg2raw.synthetic.captures import (
    ILLUMINANT,
    SHAPE,
    noise_iso,
    simulate_captures,
    strength_stream,
    synthetic_camera_of,
)
from cg2raw.synthetic.conditions import STUDIO
from cg2raw.synthetic.evidence import evidence
from cg2raw.synthetic.sensors import ISO, drawn_sensor, with_noise
from cg2raw.synthetic.strengths import FIRST_NAMES, KINDS, UNKNOWN_KINDS
from cg2raw.synthetic.synthetic_camera import stream
from studies.diagnose.cameras import CameraCase
from studies.diagnose.dense import WRONG, DenseCase, dense_names, draw_faults
from studies.diagnose.real import RealCase, manifest_of, plantable
from studies.diagnose.truths import expected

# Cases that are drawn: per effect where a suite goes through them, else in all.
SUITES = {
    "single": 20,
    "none": 1000,
    "low-none": 200,
    "pairs": 100,
    "triples": 50,
    "nine": 60,
    "unknown": 20,
    "nuisance-none": 400,
    "real": 9,
    "leave-one-out": 3,
    "nuisance": 2,
    "power": 12,
    "closed-loop": 2,
    "few": 6,
    "few-none": 200,
    "dense-1": 60,
    "dense-3": 40,
    "dense-5": 40,
    "real-none": 100,
}
PER_EFFECT = (
    "real",
    "single",
    "unknown",
    "leave-one-out",
    "nuisance",
    "power",
    "closed-loop",
    "few",
)
# Of the suites few, what each split has of each kind: how many levels, scenes or
# exposure times, and how many frames of each.
FEW: Sequence[Mapping[str, tuple[int, int]]] = [
    {"dark": (2, 2)},
    {"flat": (1, 2)},
    {"flat": (2, 1)},
    {"flat": (2, 2)},
    {"dark": (1, 1), "flat": (1, 1)},
    {"dark": (1, 2), "flat": (1, 1)},
    {"dark": (1, 2), "flat": (1, 2)},
    {"dark": (2, 1), "flat": (2, 1)},
    {"dark": (2, 1), "flat": (2, 2)},
    {"dark": (2, 2), "flat": (2, 1)},
    {"scene": (1, 1)},
    {"scene": (1, 2)},
    {"scene": (2, 1)},
    {"scene": (2, 2)},
    {"dark": (1, 1), "scene": (1, 1)},
    {"dark": (1, 1), "scene": (2, 2)},
    {"dark": (2, 2), "scene": (2, 1)},
    {"flat": (1, 1), "scene": (1, 1)},
    {"flat": (2, 2), "scene": (2, 2)},
    {"dark": (1, 1), "flat": (1, 1), "scene": (1, 1)},
    {"dark": (2, 2), "flat": (2, 2), "scene": (1, 1)},
]
# Of the suite nine: all but one are hidden, each in turn is the one that is not.
TEN = (
    *("black_level", "read_noise", "row_noise", "dsnu", "column_fixed_pattern"),
    *("dark_current", "dark_current_nonuniformity", "prnu", "lens_shading"),
    "shot_noise",
)
LOW_BITS, LOW_NOISE_DN, CUT_NOISE_DN = 10, (0.2, 0.5), (0.2, 2.0)
# Darks and flats alone do not show these (docs/diagnose.md, the table of captures).
OF_SCENES = {
    *("color_matrix", "blur", "lateral_chromatic_aberration", "veiling_glare"),
    *("full_well", "poisson_shot_noise"),
    *("lens_distortion", "smear", "line_jitter", "motion_blur", "ghost_image"),
}
# The suite power goes down to this share of an effect's range of strengths.
WEAKEST = 0.02
# Names by the number of their first case: those that came later left others theirs.
GENERATIONS = {
    0: FIRST_NAMES,
    100000: tuple(KINDS)[len(FIRST_NAMES) : 33],
    200000: tuple(KINDS)[33:34],
    300000: tuple(KINDS)[34:],
}
# Of the suite unknown: what it went through when it began, of which some is known now.
ONCE_UNKNOWN = ("lens_distortion", *UNKNOWN_KINDS, "amplifier_mismatch")


@dataclass(frozen=True)
class Case:
    """One synthetic camera, 36 frames: in each split darks of two exposure times, flats
    of two levels and two scenes, each twice; in the suites few, those of FEW by the
    seed. strengths : effect -> strength. without : effects that the diagnosis must not
    name."""

    suite: str
    number: int
    seed: int
    strengths: dict[str, float]
    without: tuple[str, ...] = ()

    @property
    def nuisances(self) -> Mapping[str, float] | None:
        return STUDIO if self.suite.startswith("nuisance") else None

    def sensor_and_hidden(self) -> tuple[Sensor, dict[str, dict[str, float]]]:
        """Return the doubted model and the parameters of what is hidden."""
        is_low = self.suite == "low-none"
        sensor = low_sensor(self.seed) if is_low else drawn_sensor(self.seed)
        camera = camera_of(sensor, ILLUMINANT, noise_iso(sensor, None))
        return sensor, {
            name: _parameters(name, strength, self.seed, camera)
            for name, strength in self.strengths.items()
        }

    def evidence(self, names: Sequence[str]) -> dict[str, float]:
        """Return the nats that hidden effects bring to the frames that decide."""
        sensor, hidden = self.sensor_and_hidden()
        iso = noise_iso(sensor, None)
        source = synthetic_camera_of(
            sensor,
            hidden,
            self.seed,
            SHAPE,
            ILLUMINANT,
            iso,
            self.nuisances,
            twice=True,
        )
        return evidence(source, names)

    def expected(self) -> dict[str, dict[str, float]]:
        """Return the values that estimates should hold."""
        sensor, hidden = self.sensor_and_hidden()
        return expected(hidden, camera_of(sensor, ILLUMINANT, noise_iso(sensor, None)))

    def captures(self) -> tuple[CaptureSet, dict[str, dict[str, float]]]:
        """Return the frames and the parameters that were hidden in them."""
        sensor, hidden = self.sensor_and_hidden()
        found = simulate_captures(
            sensor, hidden, seed=self.seed, nuisances=self.nuisances, twice=True
        )
        few = FEW[self.seed % len(FEW)] if self.suite.startswith("few") else None
        kept = [c for c in found.captures if few is None or _is_of(few, c.kind, c.name)]
        drawn_once = [replace(c, raw=cache(c.raw)) for c in kept]
        return replace(found, captures=drawn_once), hidden


def _is_of(few: Mapping[str, tuple[int, int]], kind: str, name: str) -> bool:
    """Return whether a capture, as "fit_dark_0_again" or "fit_scene_1_0", is kept."""
    levels, frames = few.get(kind, (0, 0))
    _, _, level, *repeat = name.split("_")
    return int(level) < levels and (repeat not in ([], ["0"])) < frames


def _parameters(
    name: str, strength: float, seed: int, camera: Camera
) -> dict[str, float]:
    """Return the parameters that are drawn beside a strength which was drawn first."""
    rng, kind = strength_stream(seed, name), {**KINDS, **UNKNOWN_KINDS}[name]
    kind.random_strength(rng)
    return {key: float(v) for key, v in kind.draw(rng, strength, camera).items()}


def _strength(name: str, seed: int) -> float:
    kind = {**KINDS, **UNKNOWN_KINDS}[name]
    return kind.random_strength(strength_stream(seed, name))


def low_sensor(seed: int) -> Sensor:
    """Return a drawn sensor that is read out coarsely: every other seed cuts its noise
    at a black level of 0, the others have less noise than half a code."""
    rng, sensor = stream(seed, "low"), drawn_sensor(seed)
    profile = json.loads(sensor.to_json())
    black = 0 if seed % 2 else int(rng.choice([4, 16, 64]))
    noise_dn = rng.uniform(*(CUT_NOISE_DN if seed % 2 else LOW_NOISE_DN))
    white = 2**LOW_BITS - 1
    profile |= {"bits": LOW_BITS, "white_level": white, "black_level": [black] * 4}
    read_noise = rng.uniform(2, 5)  # electrons
    coarse = Sensor.from_json(json.dumps(profile), sensor.id)
    return with_noise(coarse, read_noise * (white - black) / noise_dn, read_noise, ISO)


AnyCase = Case | DenseCase | RealCase | CameraCase


def cases(
    suite: str,
    seed: int,
    count: int | None = None,
    effects: Sequence[str] = (),
    captures: str | os.PathLike[str] | None = None,
) -> list[AnyCase]:
    """Return the cases of a suite.

    count : of cases, as of SUITES; None for the number there. effects : only these, of
    a suite that hides some; pairs and triples are else of the first names that there
    were, so that they stay as published. captures : manifest of a real suite, or its
    folder.

    Raises ValueError for unknown names and captures that a suite cannot use."""
    if suite not in SUITES:
        raise ValueError(f"suite {suite!r} must be one of {', '.join(SUITES)}")
    is_real = suite.startswith("real")
    if captures is not None and not is_real:
        raise ValueError(f"captures {captures}: suite {suite} makes its own; only real")
    path = manifest_of(captures) if is_real else None
    count = SUITES[suite] if count is None else count
    known = _known(suite) if path is None else plantable(path)
    for name in effects:
        if name not in known:
            raise ValueError(
                f"effect {name!r} of suite {suite} must be one of {', '.join(known)}"
            )
    if path is not None:
        names = list(effects or known)
        total = count * len(names) if suite in PER_EFFECT else count
        return [
            RealCase(suite, n, own, _planted(suite, n, own, names), path)
            for n in range(total)
            for own in [own_seed(suite, n, seed)]
        ]
    if suite not in PER_EFFECT:
        names = list(effects or (known if suite in WRONG else FIRST_NAMES))
        return [_case(suite, n, seed, names) for n in range(count)]
    turns = ONCE_UNKNOWN if suite == "unknown" else ()
    generations = {0: tuple(effects) or turns} if effects or turns else GENERATIONS
    return [
        _case(suite, start + n, seed, [name])
        for start, every in generations.items()
        for n, name in enumerate(every * count)
        if name in known
    ]


def _known(suite: str) -> Sequence[str]:
    """Return the effects that a suite may hide."""
    if suite in WRONG:
        return dense_names()
    return list(UNKNOWN_KINDS if suite == "unknown" else KINDS)


def _planted(
    suite: str, number: int, seed: int, names: Sequence[str]
) -> dict[str, float]:
    if suite.endswith("none"):
        return {}
    name = names[number % len(names)]
    return {name: _strength(name, seed)}


def own_seed(suite: str, number: int, seed: int) -> int:
    """Return the seed of one case."""
    return int(stream(seed, f"{suite}/{number}").integers(2**31))


def _case(suite: str, number: int, seed: int, names: Sequence[str]) -> Case | DenseCase:
    rng = stream(seed, f"{suite}/{number}")
    own = int(rng.integers(2**31))
    if suite in WRONG:
        return DenseCase(suite, number, own, draw_faults(own, names, WRONG[suite]))
    if suite.endswith("none"):
        return Case(suite, number, own, {})
    if suite == "nine":
        left_out = TEN[number % len(TEN)]
        chosen = [name for name in TEN if name != left_out]
    elif suite in ("pairs", "triples"):
        size = 2 if suite == "pairs" else 3
        chosen = [str(n) for n in rng.choice(names, size=size, replace=False)]
    else:
        chosen = list(names)
    weak = _weak(rng, chosen[0]) if suite == "power" else None
    strengths = {name: weak or _strength(name, own) for name in chosen}
    without = tuple(chosen) if suite == "leave-one-out" else ()
    return Case(suite, number, own, strengths, without)


def _weak(rng: Generator, name: str) -> float | None:
    """Return a strength around what can just be seen; None if there is none."""
    kind = KINDS[name]
    if kind.low == kind.high:
        return None
    middle = np.sqrt(kind.low * kind.high)
    return float(np.exp(rng.uniform(np.log(WEAKEST * kind.low), np.log(middle))))
