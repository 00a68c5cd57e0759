# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Benchmark suites: which case hides which effects, set by seed and number alone."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.sensor import Sensor
from cg2raw.synthetic.captures import (
    ILLUMINANT,
    SHAPE,
    draw_hidden,
    noise_iso,
    simulate_captures,
    synthetic_camera_of,
)
from cg2raw.synthetic.conditions import STUDIO
from cg2raw.synthetic.evidence import evidence
from cg2raw.synthetic.sensors import drawn_sensor
from cg2raw.synthetic.strengths import FIRST_NAMES, KINDS, UNKNOWN_KINDS
from cg2raw.synthetic.synthetic_camera import stream
from studies.diagnose.dense import WRONG, DenseCase, dense_names, draw_faults
from studies.diagnose.real import RealCase, manifest_of, plantable

# Cases that are drawn: per effect where a suite goes through them, else in all.
SUITES = {
    "single": 20,
    "none": 400,
    "pairs": 60,
    "triples": 40,
    "unknown": 12,
    "leave-one-out": 3,
    "nuisance": 2,
    "nuisance-none": 200,
    "power": 12,
    "closed-loop": 2,
    "dense-1": 60,
    "dense-3": 40,
    "dense-5": 40,
    "real": 5,
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
)
# The suite power goes down to this share of an effect's range of strengths.
WEAKEST = 0.02
# Number of the first case of names that came later: the others keep theirs.
FIRST_LATER = 100000
LATER_NAMES = [name for name in KINDS if name not in FIRST_NAMES]


@dataclass(frozen=True)
class Case:
    """One synthetic camera. strengths : effect -> strength, None for one from its
    range. without : effects that the diagnosis must not name."""

    suite: str
    number: int
    seed: int
    strengths: dict[str, float | None]
    without: tuple[str, ...] = ()

    @property
    def nuisances(self) -> Mapping[str, float] | None:
        return STUDIO if self.suite.startswith("nuisance") else None

    def sensor_and_hidden(self) -> tuple[Sensor, dict[str, dict[str, float]]]:
        """Return the doubted model and the parameters of what is hidden."""
        sensor = drawn_sensor(self.seed)
        return sensor, draw_hidden(sensor, self.strengths, seed=self.seed)

    def evidence(self, names: Sequence[str]) -> dict[str, float]:
        """Return the nats that hidden effects bring to the frames that decide."""
        sensor, hidden = self.sensor_and_hidden()
        iso = noise_iso(sensor, None)
        source = synthetic_camera_of(
            sensor, hidden, self.seed, SHAPE, ILLUMINANT, iso, self.nuisances
        )
        return evidence(source, names)

    def expected(self) -> dict[str, dict[str, float]]:
        """Return the values that estimates should hold: the generator's parameters are
        not those of the diagnosis."""
        return {}

    def captures(self) -> tuple[CaptureSet, dict[str, dict[str, float]]]:
        """Return the frames and the parameters that were hidden in them."""
        sensor, hidden = self.sensor_and_hidden()
        found = simulate_captures(
            sensor, hidden, seed=self.seed, nuisances=self.nuisances
        )
        return found, hidden


AnyCase = Case | DenseCase | RealCase


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
            RealCase(
                suite, n, own_seed(suite, n, seed), _planted(suite, n, names), path
            )
            for n in range(total)
        ]
    if suite not in PER_EFFECT:
        names = list(effects or (known if suite in WRONG else FIRST_NAMES))
        return [_case(suite, n, seed, names) for n in range(count)]
    first = [n for n in effects or known if effects or n not in LATER_NAMES]
    later = [n for n in known if n in LATER_NAMES and not effects]
    return [
        _case(suite, start + n, seed, [name])
        for start, names in ((0, first), (FIRST_LATER, later))
        for n, name in enumerate(names * count)
    ]


def _known(suite: str) -> Sequence[str]:
    """Return the effects that a suite may hide."""
    if suite in WRONG:
        return dense_names()
    return list(UNKNOWN_KINDS if suite == "unknown" else KINDS)


def _planted(suite: str, number: int, names: Sequence[str]) -> dict[str, float | None]:
    return {} if suite.endswith("none") else {names[number % len(names)]: None}


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
    if suite in ("pairs", "triples"):
        size = 2 if suite == "pairs" else 3
        chosen = rng.choice(names, size=size, replace=False)
        return Case(suite, number, own, {str(name): None for name in chosen})
    (name,) = names
    strength = _weak(rng, name) if suite == "power" else None
    without = (name,) if suite == "leave-one-out" else ()
    return Case(suite, number, own, {name: strength}, without)


def _weak(rng: Generator, name: str) -> float | None:
    """Return a strength around what can just be seen; None if there is none."""
    kind = KINDS[name]
    if kind.low == kind.high:
        return None
    middle = np.sqrt(kind.low * kind.high)
    return float(np.exp(rng.uniform(np.log(WEAKEST * kind.low), np.log(middle))))
