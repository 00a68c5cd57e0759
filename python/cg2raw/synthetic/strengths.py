# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Effects that can be hidden: ranges of their strengths, and their random parameters.

Every effect has one strength, whose magnitude is log-uniform over the range where it
matters; its other parameters are drawn beside it. Parameters are the generator's own.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from cg2raw.synthetic.camera import Camera

Draw = Callable[[Generator, float, Camera], dict[str, float]]


@dataclass(frozen=True)
class Kind:
    """An effect that can be hidden.

    strength : what it is, with its unit. low, high : of its magnitude.
    draw : (random generator, strength, camera) -> all its parameters.
    """

    strength: str
    low: float
    high: float
    draw: Draw

    def random_strength(self, rng: Generator) -> float:
        """Return a magnitude, log-uniform in the range."""
        return float(np.exp(rng.uniform(np.log(self.low), np.log(self.high))))


def _sign(rng: Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _stops(relative: float) -> float:
    return float(np.log2(1 + relative))


def _white_balance(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    turn = rng.uniform(0, 2 * np.pi)
    red, blue = s * np.cos(turn), s * np.sin(turn)
    return {"red_stops": _stops(red), "blue_stops": _stops(blue)}


def _color_matrix(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    v = rng.standard_normal(3)
    v *= s / np.linalg.norm(v)
    return {"saturation": v[0], "hue": v[1], "red_as_green": v[2]}


def _blur(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    return {
        "disc_px": s,
        "cutoff": rng.uniform(1.5, 5.0),  # cycles/px: f/5 to f/1.6 at 1 um and 550 nm
        "red_scale": rng.uniform(0.9, 1.15),
        "blue_scale": rng.uniform(0.9, 1.15),
    }


def _lateral(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    turn = rng.uniform(0, 2 * np.pi)
    return {
        "red_px": s * np.cos(turn),
        "blue_px": s * np.sin(turn),
        "bend": rng.uniform(-0.3, 0.6),
    }


def _axis(rng: Generator, most: float) -> dict[str, float]:
    return {"axis_x": rng.uniform(-most, most), "axis_y": rng.uniform(-most, most)}


def _lens_shading(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    return {"corner_loss": s, **_axis(rng, 0.12)}


def _color_shading(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    """Powers such that the stronger of red and blue changes by s in the corner."""
    degrees = rng.uniform(20, 35)
    unit = np.log1p(-s) / np.log(np.cos(np.radians(degrees)))
    other = rng.uniform(-0.8, 0.8)
    red, blue = rng.permutation([1.0, other]) * _sign(rng)
    return {
        "corner_degrees": degrees,
        "red_power": unit * red,
        "blue_power": unit * blue,
        **_axis(rng, 0.08),
    }


def _glare(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    return {
        "share": s,
        "even": rng.uniform(0.6, 1.0),
        "wing_length": rng.uniform(0.08, 0.16),
    }


def _crosstalk(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    left, right, above, below = s * rng.dirichlet(np.full(4, 6.0))
    names = ("from_left", "from_right", "from_above", "from_below")
    return dict(zip(names, (left, right, above, below), strict=True))


def _gr_gb(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    return {"split": s * _sign(rng), "lean": rng.uniform(0, 1)}


def _nonlinearity(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    fills = rng.random() < 0.5
    return {"loss": s, "power": 0.0 if fills else rng.uniform(0.8, 2.0)}


def _black_level(rng: Generator, s: float, camera: Camera) -> dict[str, float]:
    """Common to all sites, and each its own, in read noises; parameters in DN."""
    unit = s * float((camera.dn_per_electron * camera.read_noise).mean())
    shifts = unit * (_sign(rng) + 0.4 * rng.standard_normal(4))
    names = [f"dn_{row}{col}" for row in range(2) for col in range(2)]
    return dict(zip(names, shifts, strict=True))


def _bias_structure(rng: Generator, s: float, camera: Camera) -> dict[str, float]:
    """A plane that differs by s read noises from edge to edge, and columns that settle
    by halves; parameters in DN."""
    unit = s * float((camera.dn_per_electron * camera.read_noise).mean())
    turn = rng.uniform(0, 2 * np.pi)
    return {
        "right_dn": unit * np.cos(turn),
        "down_dn": unit * np.sin(turn),
        "first_dn": unit * _sign(rng) * rng.uniform(0.5, 2.0),
        "half_px": np.exp(rng.uniform(np.log(4), np.log(30))),
    }


def _glow(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    """Beside an edge, anywhere along it, or a corner; places in shares of the frame."""
    along = rng.choice([0.0, 1.0, rng.uniform(0.1, 0.9)])
    place = rng.permutation([along, float(rng.choice([0.0, 1.0]))])
    return {
        "electrons_per_second": s,
        "down": place[0],
        "across": place[1],
        "fades_over": rng.uniform(0.06, 0.3),  # of the frame's diagonal
    }


def _pdaf(rng: Generator, s: float, _: Camera) -> dict[str, float]:
    period = 2 * int(rng.integers(4, 9))
    row, column = (float(rng.integers(period)) for _ in range(2))
    tilt = rng.uniform(-0.1, 0.1)  # rays come from one side at the frame's edges
    return {"loss": s, "period": period, "row": row, "column": column, "tilt": tilt}


def _one(name: str, signed: bool = False) -> Draw:
    """Return the draw of an effect that has no other parameter."""

    def draw(rng: Generator, s: float, _: Camera) -> dict[str, float]:
        return {name: s * _sign(rng) if signed else s}

    return draw


KINDS: Mapping[str, Kind] = {
    "exposure": Kind(
        "relative", 0.003, 0.1, lambda rng, s, _: {"stops": _stops(s * _sign(rng))}
    ),
    "white_balance": Kind("relative", 0.003, 0.1, _white_balance),
    "color_matrix": Kind("relative change of chroma", 0.01, 0.1, _color_matrix),
    "blur": Kind("radius of the disc, px", 0.3, 1.5, _blur),
    "lateral_chromatic_aberration": Kind("px in the corner", 0.03, 1.0, _lateral),
    "lens_shading": Kind("loss in the corner", 0.05, 0.6, _lens_shading),
    "color_shading": Kind("change in the corner", 0.01, 0.15, _color_shading),
    "veiling_glare": Kind("share of the light", 0.003, 0.05, _glare),
    "crosstalk": Kind("share that comes from neighbours", 0.004, 0.08, _crosstalk),
    "gr_gb_imbalance": Kind("relative", 0.002, 0.03, _gr_gb),
    "prnu": Kind("relative rms", 0.003, 0.02, _one("sigma")),
    "dark_current": Kind("electrons/s", 0.1, 6.0, _one("electrons_per_second")),
    "nonlinearity": Kind("loss at white", 0.003, 0.1, _nonlinearity),
    "full_well": Kind("of the range below white", 0.01, 0.3, _one("below_white")),
    "shot_noise": Kind("log of the variance", 0.03, 0.4, _one("log_gain", True)),
    "poisson_shot_noise": Kind(
        "none: photons are counted", 1.0, 1.0, _one("photons_are_counted")
    ),
    "read_noise": Kind("log of the variance", 0.05, 1.0, _one("log_variance", True)),
    "heavy_tailed_noise": Kind(
        "share of noisy pixels",
        0.005,
        0.06,
        lambda rng, s, _: {"share": s, "ratio": np.exp(rng.uniform(1.6, 3.2))},
    ),
    "row_noise": Kind("read noises rms", 0.05, 0.6, _one("read_noises")),
    "column_fixed_pattern": Kind("read noises rms", 0.05, 0.6, _one("read_noises")),
    "dsnu": Kind(
        "read noises rms",
        0.15,
        1.0,
        lambda rng, s, _: {"read_noises": s, "shape": rng.uniform(2, 6)},
    ),
    "hot_pixels": Kind(
        "share of the pixels",
        3e-4,
        5e-3,
        lambda rng, s, _: {
            "share": s,
            "electrons_per_second": np.exp(rng.uniform(np.log(20), np.log(150))),
        },
    ),
    "black_level": Kind("read noises", 0.1, 2.0, _black_level),
    "noise_reduction": Kind("share of the neighbours", 0.01, 0.4, _one("blend")),
    "bias_structure": Kind("read noises from edge to edge", 0.1, 2.0, _bias_structure),
    "black_level_drift": Kind("read noises rms", 0.03, 0.5, _one("read_noises")),
    "dark_current_nonuniformity": Kind(
        "electrons/s that half of the pixels have at least",
        0.7,
        6.0,
        lambda rng, s, _: {"electrons_per_second": s, "skew": rng.uniform(0.3, 1.5)},
    ),
    "amplifier_glow": Kind("electrons/s beside the amplifier", 0.7, 30.0, _glow),
    "read_noise_correlation": Kind(
        "correlation with the next pixel", 0.03, 0.3, _one("correlation", True)
    ),
    "mains_flicker": Kind(
        "relative swing",
        0.003,
        0.05,
        lambda rng, s, _: {
            "swing": s,
            "rows": rng.uniform(20, 80),
            "exposed": rng.uniform(0.3, 0.8),
        },
    ),
    "random_telegraph_noise": Kind(
        "share of the pixels",
        2e-3,
        2e-2,
        lambda rng, s, _: {
            "share": s,
            "read_noises": np.exp(rng.uniform(np.log(5), np.log(15))),
            "switches": rng.uniform(0.4, 0.7),
        },
    ),
    "pdaf_pixels": Kind("loss of the shaded pixels", 0.02, 0.3, _pdaf),
    "dust": Kind(
        "loss in the middle of a spot",
        0.01,
        0.2,
        lambda rng, s, _: {
            "loss": s,
            "per_megapixel": rng.uniform(200, 800),
            "radius_px": rng.uniform(3, 9),
            "soft_px": rng.uniform(1, 3),
        },
    ),
    "lens_distortion": Kind("px in the corner", 0.5, 3.0, _one("corner_px", True)),
    "amplifier_mismatch": Kind(
        "read noises that offsets differ by",
        0.1,
        1.0,
        lambda rng, s, _: {
            "read_noises": s * _sign(rng),
            "gain": _sign(rng) * rng.uniform(0.002, 0.01),
            "one_above_the_other": float(rng.random() < 0.5),
        },
    ),
}

# The first names that there were: numbers of a benchmark's cases go through these
# before any other, so that what was published stays as it was.
FIRST_NAMES = tuple(KINDS)[:24]

# A seed draws of these what it drew under their former names: benchmarks stay as they
# were published.
DRAWN_AS = {
    "full_well": "early_clipping",
    "poisson_shot_noise": "photon_statistics",
    "column_fixed_pattern": "column_noise",
}

UNKNOWN_KINDS: Mapping[str, Kind] = {
    "smear": Kind("share of a column's light", 0.005, 0.05, _one("share")),
    "line_jitter": Kind("px rms", 0.1, 0.6, _one("rms_px")),
    "motion_blur": Kind(
        "px",
        1.0,
        5.0,
        lambda rng, s, _: {"length_px": s, "angle": rng.uniform(0, np.pi)},
    ),
    "ghost_image": Kind(
        "share of the light",
        0.003,
        0.02,
        lambda rng, s, _: {"share": s, "disc_px": rng.uniform(1.5, 5)},
    ),
    "column_gain": Kind("rms", 0.003, 0.02, _one("rms")),
}


def draw_effect(
    name: str, rng: Generator, camera: Camera, strength: float | None = None
) -> dict[str, float]:
    """Return the parameters of a hidden effect; its strength is drawn if it is None.

    Raises ValueError that lists the names, and for a strength below 0."""
    kind = KINDS.get(name) or UNKNOWN_KINDS.get(name)
    if kind is None:
        known = ", ".join(sorted([*KINDS, *UNKNOWN_KINDS]))
        new = {former: current for current, former in DRAWN_AS.items()}.get(name)
        if new:
            raise ValueError(f"hidden effect {name!r} is called {new!r} now")
        raise ValueError(f"hidden effect {name!r} is unknown; there are {known}")
    if strength is None:
        strength = kind.random_strength(rng)
    if not strength > 0 or strength > 10 * kind.high:
        raise ValueError(
            f"strength {strength} of {name} ({kind.strength}) must be above 0 and at "
            f"most {10 * kind.high:g}"
        )
    return {
        key: float(value) for key, value in kind.draw(rng, strength, camera).items()
    }
