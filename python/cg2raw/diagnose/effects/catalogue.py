# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Vocabulary: the effects that a diagnosis can name, and how each is looked for.

An effect is simulated by the registry (cg2raw.effects()); what inference alone needs of
it is here: which numbers are searched, in which steps, and by which of three ways.
"smooth" parameters move mean and variance and are fitted by Fisher scoring; a "flow"
turns its structured noise into white noise and is fitted by search; a "pattern" is a
fixed map of the sensor, estimated pixel by pixel.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core

Way = Literal["smooth", "flow", "pattern"]
Values = NDArray[np.float64]

COLORS = ("exposure", "white_balance", "color_matrix")
GAIN = "gain"
RESPONSE = "response"
SPREAD = "spread"
TEMPORAL = "temporal"
PEDESTAL = "pedestal"


@dataclass(frozen=True)
class Candidate:
    """An effect that may be named.

    parameters, units, low, high, steps : of the numbers that are searched; 0 is none
        of the effect. steps are those of numerical derivatives.
    starts : values from which a search of a flow begins.
    confusable : families of effects that look alike (see `confusable`).
    absorbs : takes up any misfit of the mean, and so comes after effects of the mean.
    needs : what some frames must have to show it: "light", an "image", a "time".
    switches : parameters that are 0 without the effect; all of them if empty.
    """

    name: str
    way: Way
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    low: Values
    high: Values
    steps: Values
    starts: tuple[tuple[float, ...], ...] = ()
    first_scale: float = 0.02
    confusable: frozenset[str] = frozenset()
    absorbs: bool = False
    moves_mean: bool = True
    needs: frozenset[str] = frozenset()
    switches: tuple[str, ...] = ()

    @property
    def null(self) -> Values:
        return np.zeros(len(self.parameters))

    def clipped(self, values: Values) -> Values:
        return np.clip(values, self.low, self.high)


# What the registry does not know: (way, step, families).
_SMOOTH: Mapping[str, tuple[float, frozenset[str]]] = {
    "exposure": (1e-3, frozenset({GAIN})),
    "white_balance": (1e-3, frozenset({GAIN})),
    "color_matrix": (1e-3, frozenset({GAIN})),
    "lateral_chromatic_aberration": (0.02, frozenset({SPREAD})),
    "blur": (5e-3, frozenset({SPREAD})),
    "veiling_glare": (2e-3, frozenset({SPREAD, PEDESTAL})),
    "lens_shading": (2e-3, frozenset({GAIN})),
    "color_shading": (2e-3, frozenset({GAIN})),
    "crosstalk": (1e-3, frozenset({SPREAD})),
    "gr_gb_imbalance": (1e-3, frozenset({GAIN})),
    "nonlinearity": (2e-3, frozenset({GAIN, RESPONSE})),
    "early_clipping": (1e-3, frozenset({RESPONSE})),
    "dark_current": (1e-4, frozenset({PEDESTAL})),
    "black_level": (1e-4, frozenset({PEDESTAL})),
}
_PATTERNS: Mapping[str, frozenset[str]] = {
    "prnu": frozenset({TEMPORAL}),
    "dsnu": frozenset({TEMPORAL}),
    "column_noise": frozenset({TEMPORAL}),
    "hot_pixels": frozenset({TEMPORAL, PEDESTAL}),
}
# What frames must have to show an effect. Without light there is no gain of it; of a
# uniform frame a filter makes what it was, and a matrix what a white balance makes.
_NEEDS: Mapping[str, frozenset[str]] = {
    **dict.fromkeys(
        (
            "exposure",
            "white_balance",
            "lens_shading",
            "color_shading",
            "crosstalk",
            "gr_gb_imbalance",
            "prnu",
            "nonlinearity",
            "shot_noise",
            "photon_statistics",
            "early_clipping",
        ),
        frozenset({"light"}),
    ),
    **dict.fromkeys(
        ("color_matrix", "lateral_chromatic_aberration", "blur", "veiling_glare"),
        frozenset({"light", "image"}),
    ),
    **dict.fromkeys(("dark_current", "hot_pixels"), frozenset({"time"})),
}
_BAYER_ONLY = frozenset({"gr_gb_imbalance", "black_level", "noise_reduction"})
_OWN_BOUNDS: Mapping[str, tuple[float, float]] = {
    "ring": (-0.6, 0.6),
    "red_scale": (-0.6, 0.6),
    "blue_scale": (-0.6, 0.6),
    "below_white": (0.0, 0.7),
}


def _bounds(parameter: Mapping[str, Any]) -> tuple[float, float]:
    for start, bounds in _OWN_BOUNDS.items():
        if parameter["name"].startswith(start):
            return bounds
    return parameter["min"], parameter["max"]


def _smooth(effect: Mapping[str, Any]) -> Candidate:
    step, families = _SMOOTH[effect["name"]]
    parameters = effect["parameters"]
    bounds = np.array([_bounds(p) for p in parameters], float)
    return Candidate(
        name=effect["name"],
        way="smooth",
        parameters=tuple(p["name"] for p in parameters),
        units=tuple(p["unit"] for p in parameters),
        low=bounds[:, 0],
        high=bounds[:, 1],
        steps=np.full(len(parameters), step),
        confusable=families,
        needs=_NEEDS.get(effect["name"], frozenset()),
    )


def _one(name: str, way: Way, parameters: str, low: Any, high: Any, **more: Any) -> Any:
    names = tuple(parameters.split())
    steps = np.full(len(names), more.pop("step", 0.01))
    units = tuple("1" for _ in names)
    low, high = (np.atleast_1d(np.asarray(x, float)) for x in (low, high))
    more["needs"] = _NEEDS.get(name, frozenset())
    return Candidate(name, way, names, units, low, high, steps, **more)


def _noises() -> list[Candidate]:
    temporal = {"confusable": frozenset({TEMPORAL}), "absorbs": True}
    still = {"moves_mean": False}
    return [
        _one("shot_noise", "smooth", "log_gain", -1.5, 1.5, **temporal, **still),
        _one("read_noise", "smooth", "log_variance", -2.5, 3, **temporal, **still),
        _one(
            "row_noise",
            "flow",
            "sigma",
            0,
            4,
            starts=((0.03,), (0.1,), (0.3,), (0.8,)),
            **temporal,
            **still,
        ),
        _one(
            "photon_statistics",
            "flow",
            "fraction",
            0,
            1.5,
            starts=((0.5,), (1.0,)),
            **still,
        ),
        _one(
            "heavy_tailed_noise",
            "flow",
            "fraction variance_ratio",
            (1e-4, 1.1),
            (0.5, 80.0),
            starts=((0.01, 9.0), (0.03, 9.0), (0.01, 25.0)),
            switches=("fraction",),
            **temporal,
            **still,
        ),
        _one(
            "noise_reduction",
            "flow",
            "blend diagonal",
            (0.0, -0.1),
            (0.9, 0.4),
            starts=((0.004, 0), (0.02, 0), (0.05, 0), (0.2, 0), (0.4, 0.05)),
            first_scale=0.004,
            step=5e-3,
            confusable=frozenset({SPREAD}),
        ),
    ]


def _pattern(name: str) -> Candidate:
    return _one(
        name,
        "pattern",
        "fraction" if name == "hot_pixels" else "sigma",
        0.0,
        1.0,
        confusable=_PATTERNS[name],
    )


@cache
def _all() -> Mapping[str, Candidate]:
    known = {effect["name"]: effect for effect in _core.effects()}
    smooth = [_smooth(known[name]) for name in _SMOOTH]
    every = [*smooth, *_noises(), *map(_pattern, _PATTERNS)]
    return {candidate.name: candidate for candidate in every}


def names() -> list[str]:
    """Return the names of all effects that can be named."""
    return list(_all())


def candidates(cfa: str, without: Iterable[str] = ()) -> list[Candidate]:
    """Return the effects that can be named for a CFA, but for some.

    Raises ValueError for a name that is none."""
    for name in without:
        if name not in _all():
            raise ValueError(
                f'effect "{name}" cannot be left out, since no diagnosis names it: '
                f"known are {', '.join(_all())}"
            )
    return [
        candidate
        for candidate in _all().values()
        if candidate.name not in set(without)
        and (len(cfa) == 4 or candidate.name not in _BAYER_ONLY)
    ]


def confusable(a: Candidate, b: Candidate) -> bool:
    """Tell whether one effect may pass for the other."""
    return bool(a.confusable & b.confusable)
