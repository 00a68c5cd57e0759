# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dense: a camera that has all effects at once, by a profile that is wrong in few.

The registry draws the frames. The doubted profile is the true one but for one, three or
five effects, which it lacks or has at another strength; they are what is hidden."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.effects.registry import registered
from cg2raw.sensor import Sensor
from cg2raw.synthetic.captures import simulate_captures
from cg2raw.synthetic.sensors import drawn_sensor
from cg2raw.synthetic.synthetic_camera import stream
from diagnose.closed_loop import by_registry, simulated
from studies.diagnose.dense_strengths import (
    SHAPES,
    Parameters,
    Unit,
    draw_dense,
)

WRONG = {"dense-1": 1, "dense-3": 3, "dense-5": 5}  # effects of the doubted profile
# What the doubted profile has of an effect, as a factor of the truth. Variances of a
# noise table are known better than other strengths.
FACTORS = (0.0, 0.5, 2.0)
NOISE_FACTORS = (1 / 1.3, 1.3)
CFA = "RGGB"  # drawn sensors are Bayer sensors; all have the same names


def dense_names() -> list[str]:
    """Return the effects that a dense camera has, in the order of the registry."""
    return [effect.name for effect in candidates(CFA)]


# Effects of noise of which a profile may say too much or too little.
OF_NOISE = frozenset(
    {
        *("heavy_tailed_noise", "noise_reduction", "read_noise_correlation"),
        *("row_noise", "black_level_drift"),
    }
)


def draw_faults(seed: int, names: Sequence[str], count: int) -> dict[str, float | None]:
    """Return what the doubted profile has of the effects in which it is wrong, as
    factors of the truth; 0 where it lacks one."""
    rng = stream(seed, "faults")
    effects = {effect.name: effect for effect in candidates(CFA)}
    chosen = rng.choice(names, size=min(count, len(names)), replace=False)
    return {str(n): float(rng.choice(_factors(effects[str(n)]))) for n in chosen}


def _factors(effect: Effect) -> tuple[float, ...]:
    """A profile says how strong a fixed pattern is and not where: captures calibrate
    it, and only its absence is a fault. Photons are counted or they are not."""
    if effect.scales:
        return NOISE_FACTORS
    return FACTORS if effect.of_mean or effect.name in OF_NOISE else (0.0,)


@dataclass(frozen=True)
class DenseCase:
    """One dense camera, and what its profile is wrong in.

    strengths : as of draw_faults. The other fields as of suites.Case."""

    suite: str
    number: int
    seed: int
    strengths: dict[str, float | None]
    without: tuple[str, ...] = ()

    @cached_property
    def bare(self) -> Sensor:
        return drawn_sensor(self.seed)

    @cached_property
    def truth(self) -> dict[str, Parameters]:
        """Parameters of all effects that the camera has; none of those whose strength
        is the noise table's own."""
        row = self.bare.noise[0]
        unit = Unit(float(np.sqrt(np.mean(row["beta2"]))), float(np.mean(row["beta1"])))
        return {
            effect.name: draw_dense(
                effect.name,
                stream(self.seed, f"dense/{effect.name}"),
                registered(CFA)[effect.name]["parameters"],
                unit,
            )
            for effect in candidates(CFA)
            if not effect.scales
        }

    def sensor(self, faults: Mapping[str, float | None]) -> Sensor:
        """Return the dense sensor with faults in it, factors by name."""
        profile = json.loads(self.bare.to_json())
        profile["effects"] = []
        for effect in candidates(CFA):
            factor = faults.get(effect.name, 1.0)
            _add(profile, effect, self.truth.get(effect.name), float(factor or 0.0))
        return Sensor.from_json(json.dumps(profile), self.bare.id)

    def captures(self) -> tuple[CaptureSet, dict[str, dict[str, float]]]:
        """Return (frames with the doubted profile, the true parameters of the effects
        in which it is wrong)."""
        found = replace(self._true_captures, sensor=self.sensor(self.strengths))
        return found, {name: self.truth.get(name, {}) for name in self.strengths}

    @cached_property
    def _true_captures(self) -> CaptureSet:
        plan = simulate_captures(self.bare, {}, seed=self.seed, twice=True)
        truth: CaptureSet = simulated(
            plan, self.sensor({}), partial(by_registry, seed=self.seed)
        )
        return truth

    def evidence(self, _: Sequence[str]) -> dict[str, float]:
        """The density of frames with maps of their own is not known."""
        return {}

    def expected(self) -> dict[str, dict[str, float]]:
        """Return the values that estimates of hidden effects should hold: what is to be
        added to the profile's where the diagnosis adds, else the whole."""
        effects = {effect.name: effect for effect in candidates(CFA)}
        found: dict[str, dict[str, float]] = {}
        for name, factor in self.strengths.items():
            effect, share = effects[name], float(factor or 0.0)
            if effect.scales:
                found[name] = {effect.parameters[0]: -float(np.log(share))}
                continue
            truth = self.truth[name]
            had = _scaled(truth, share) if effect.predicted else {}
            if not share:
                had = {}
            found[name] = {
                key: value - had.get(key, 0.0)
                for key, value in truth.items()
                if key in effect.parameters
            }
        return found


def _scaled(parameters: Parameters, factor: float) -> Parameters:
    return {k: v if k in SHAPES else v * factor for k, v in parameters.items()}


def _add(
    profile: dict[str, Any], effect: Effect, truth: Parameters | None, factor: float
) -> None:
    """Write an effect into a profile, at a factor of the truth."""
    if effect.scales:
        effect.change_noise_table(profile, np.array([np.log(factor)]))
        return
    if truth is None or not factor:
        return
    given = _scaled(truth, factor)
    known = registered(CFA)[effect.name]["parameters"]
    searched = [given[key] for key in effect.parameters if key in given]
    whole = len(searched) == len(effect.parameters)
    if whole and effect.change_noise_table(profile, np.array(searched)):
        return
    bounds = {p["name"]: (p["min"], p["max"]) for p in known if p["name"] in given}
    parameters = {k: float(np.clip(given[k], *ends)) for k, ends in bounds.items()}
    profile["effects"].append({"name": effect.name, "parameters": parameters})
