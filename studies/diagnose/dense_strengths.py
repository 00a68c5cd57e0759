# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dense strengths: parameters of every effect that a camera may have, by the registry.

Magnitudes are log-uniform over the ranges of synthetic.strengths.KINDS, the same as for
the hidden effects of other suites. Units are the registry's: shares of the range from
black to white."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.random import Generator

from cg2raw.synthetic.strengths import KINDS

Parameters = dict[str, float]

# An effect without a line below takes this share of the way from its null to the far
# bound of each parameter: the bounds leave room for any camera.
SHARE_OF_BOUNDS = (1e-3, 1e-2)


@dataclass(frozen=True)
class Unit:
    """What one read noise, and one electron, is of the range from black to white."""

    read_noise: float
    electron: float


Draw = Callable[[Generator, float, Unit], Parameters]


def draw_dense(
    name: str, rng: Generator, known: Sequence[Mapping[str, Any]], unit: Unit
) -> Parameters:
    """Return an effect's parameters, drawn. known : the registry's (cg2raw.effects()),
    whose bounds hold."""
    if name in DRAWS:
        drawn = DRAWS[name](rng, KINDS[name].random_strength(rng), unit)
    else:
        drawn = {p["name"]: _within_bounds(rng, p) for p in known}
    bounds = {p["name"]: (p["min"], p["max"]) for p in known}
    return {
        key: float(np.clip(value, *bounds[key])) if key in bounds else float(value)
        for key, value in drawn.items()
    }


def _log_uniform(rng: Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _within_bounds(rng: Generator, parameter: Mapping[str, Any]) -> float:
    null, ends = parameter["null"], (parameter["min"], parameter["max"])
    far = float(rng.choice([end for end in ends if end != null]))
    return float(null + (far - null) * _log_uniform(rng, *SHARE_OF_BOUNDS))


def _sign(rng: Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _turned(rng: Generator, s: float, *names: str) -> Parameters:
    """Return s in any direction of these parameters."""
    v = rng.standard_normal(len(names))
    return dict(zip(names, s * v / np.linalg.norm(v), strict=True))


def _shared(rng: Generator, s: float, *names: str) -> Parameters:
    """Return parts of s, which add up to it."""
    parts = rng.dirichlet(np.full(len(names), 3.0))
    return dict(zip(names, s * parts, strict=True))


def _blur(rng: Generator, s: float, _: Unit) -> Parameters:
    """An OTF with the width of a disc of radius s: its variance is s^2 / 4 an axis, and
    that of cos(n w) - 1 is n^2."""
    width = s * s / 4
    return {
        **{f"ring_{n}": 0.0 for n in range(3, 11)},
        "ring_1": 0.6 * width,
        "ring_2": 0.1 * width,
        "red_scale": rng.uniform(-0.1, 0.2),
        "blue_scale": rng.uniform(-0.1, 0.2),
    }


def _lens_shading(rng: Generator, s: float, _: Unit) -> Parameters:
    tilts = {name: rng.uniform(-0.03, 0.03) for name in ("tilt_x", "tilt_y")}
    thirds = {f"{name}_r2": -0.5 * value for name, value in tilts.items()}
    return {**_shared(rng, -s, "r2", "r4", "r6"), **tilts, **thirds}


def _color_shading(rng: Generator, s: float, _: Unit) -> Parameters:
    drawn = {f"{c}_{p}": 0.1 * s * rng.uniform(-1, 1)
             for c in ("red", "blue") for p in ("r4", "x", "y")}  # fmt: skip
    return {**drawn, **_turned(rng, s, "red_r2", "blue_r2")}


def _lateral(rng: Generator, s: float, _: Unit) -> Parameters:
    first = _turned(rng, s, "red", "blue")
    bend = rng.uniform(-0.3, 0.6)
    return {**first, **{f"{name}_r2": bend * v for name, v in first.items()}}


def _gr_gb(rng: Generator, s: float, _: Unit) -> Parameters:
    split = _shared(rng, s * _sign(rng), "gr", "gb")
    return {"gr": split["gr"], "gb": -split["gb"]}


def _black_level(rng: Generator, s: float, unit: Unit) -> Parameters:
    common = _sign(rng)
    return {
        f"offset_{site}": s * unit.read_noise * (common + 0.4 * rng.standard_normal())
        for site in ("00", "01", "10", "11")
    }


def _pdaf(rng: Generator, s: float, _: Unit) -> Parameters:
    return {"gain": -s, "pitch": 2.0 * rng.integers(4, 9), "row": 2.0, "column": 3.0}


def _glow(rng: Generator, s: float, unit: Unit) -> Parameters:
    corner = {name: _sign(rng) for name in ("row", "column")}
    extent = rng.uniform(0.1, 0.4)
    return {"per_second": s * unit.electron, "extent": extent, **corner}


def _bias(rng: Generator, s: float, unit: Unit) -> Parameters:
    slopes = _turned(rng, s * unit.read_noise, "horizontal", "vertical", "edge")
    return {**slopes, "edge_length": rng.uniform(1, 5)}


def _mismatch(rng: Generator, s: float, unit: Unit) -> Parameters:
    ways = "horizontal", "vertical"
    chosen = rng.choice(ways)
    steps = {
        "offset": s * unit.read_noise * _sign(rng),
        "response": rng.uniform(0.002, 0.01) * _sign(rng),
    }
    return {
        f"{way}_{step}": value if way == chosen else 0.0
        for way in ways
        for step, value in steps.items()
    }


def _one(name: str, unit_of: str = "", signed: bool = False) -> Draw:
    """Return the draw of an effect with one parameter, in a field of Unit or none."""

    def draw(rng: Generator, s: float, unit: Unit) -> Parameters:
        size = s * getattr(unit, unit_of) if unit_of else s
        return {name: size * _sign(rng) if signed else size}

    return draw


def _any_way(*names: str) -> Draw:
    return lambda rng, s, _: _turned(rng, s, *names)


def _in_parts(*names: str) -> Draw:
    return lambda rng, s, _: _shared(rng, s, *names)


DRAWS: Mapping[str, Draw] = {
    "exposure": _one("gain", signed=True),
    "white_balance": _any_way("red", "blue"),
    "color_matrix": _any_way("rg", "rb", "gr", "gb", "br", "bg"),
    "blur": _blur,
    "lateral_chromatic_aberration": _lateral,
    "lens_distortion": _any_way("r2", "r4"),
    "lens_shading": _lens_shading,
    "color_shading": _color_shading,
    "veiling_glare": _in_parts("uniform", "wide"),
    "crosstalk": _in_parts("left", "right", "up", "down"),
    "gr_gb_imbalance": _gr_gb,
    "prnu": _one("sigma"),
    "dark_current": _one("per_second", "electron"),
    "hot_pixels": lambda rng, s, unit: {
        "fraction": s,
        "rate": _log_uniform(rng, 20, 150) * unit.electron,
    },
    "nonlinearity": _in_parts("quadratic", "cubic"),
    "full_well": _one("below_white"),
    "poisson_shot_noise": _one("fraction"),
    "heavy_tailed_noise": lambda rng, s, _: {
        "fraction": s,
        "variance_ratio": float(np.exp(rng.uniform(1.6, 3.2))),
    },
    "row_noise": _one("sigma", "read_noise"),
    "column_fixed_pattern": _one("sigma", "read_noise"),
    "dsnu": _one("sigma", "read_noise"),
    "black_level": _black_level,
    "noise_reduction": lambda rng, s, _: {"blend": s, "diagonal": 0.25 * s * s},
    "bias_structure": _bias,
    "black_level_drift": _one("sigma", "read_noise"),
    "amplifier_mismatch": _mismatch,
    "read_noise_correlation": _one("coefficient", signed=True),
    "dark_current_nonuniformity": lambda rng, s, unit: {
        "rate": s * unit.electron,
        "log_sigma": rng.uniform(0.5, 1.5),
    },
    "amplifier_glow": _glow,
    "mains_flicker": lambda rng, s, _: {
        "amplitude": s,
        "period": rng.uniform(20, 120),
    },
    "pdaf_pixels": _pdaf,
    "dust": lambda rng, s, _: {
        "density": rng.uniform(200, 800),
        "depth": s,
        "radius": rng.uniform(3, 9),
    },
    "random_telegraph_noise": lambda rng, s, unit: {
        "fraction": s,
        "amplitude": rng.uniform(3, 15) * unit.read_noise,
    },
}
# Parameters that say of what shape an effect is, and not how strong.
SHAPES = frozenset(
    {
        *("red_scale", "blue_scale", "rate", "variance_ratio", "edge_length"),
        *("log_sigma", "extent", "row", "column", "period", "pitch"),
        *("density", "radius"),
    }
)
