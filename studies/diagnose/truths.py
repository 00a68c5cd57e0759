# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Truths: a hidden effect's parameters in the units of the diagnosis.

Of effects whose parameters are the same quantity in both; of the others, such as
shading, which is cos^4 in one and a polynomial in the other, there is none."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from cg2raw.synthetic.camera import Camera
from cg2raw.synthetic.captures import UNEVEN

Values = Mapping[str, float]


@dataclass(frozen=True)
class Unit:
    """One electron, read noise and DN, as shares of the range from black to white."""

    electron: float
    read_noise: float
    dn: float


def expected(
    hidden: Mapping[str, Values], camera: Camera
) -> dict[str, dict[str, float]]:
    """Return effect -> parameter -> true value, in the registry's units: beyond the
    profile, but for what a finding replaces.

    hidden : the generator's parameters. camera : all its sites have one noise."""
    unit = Unit(
        float((1 / camera.full_well).mean()),
        float((camera.read_noise / camera.full_well).mean()),
        1 / float((camera.white - camera.black).mean()),
    )
    known = [name for name in hidden if name in TRUTHS]
    found = {name: TRUTHS[name](hidden[name], unit) for name in known}
    if UNEVEN in hidden and "dark_current" in found:  # whose median a profile states
        more = hidden[UNEVEN]["electrons_per_second"] * unit.electron
        found["dark_current"]["per_second"] += more
    return found


def _stops(stops: float) -> float:
    return float(2.0**stops - 1)


def _spread(values: Values, unit: Unit) -> dict[str, float]:
    return {"sigma": values["read_noises"] * unit.read_noise}


def _black_level(values: Values, unit: Unit) -> dict[str, float]:
    return {f"offset_{key[3:]}": value * unit.dn for key, value in values.items()}


def _mismatch(values: Values, unit: Unit) -> dict[str, float]:
    way = "vertical" if values["one_above_the_other"] else "horizontal"
    return {
        f"{way}_offset": values["read_noises"] * unit.read_noise,
        f"{way}_response": values["gain"],
    }


TRUTHS: Mapping[str, Callable[[Values, Unit], dict[str, float]]] = {
    "exposure": lambda v, _: {"gain": _stops(v["stops"])},
    "white_balance": lambda v, _: {
        "red": _stops(v["red_stops"]),
        "blue": _stops(v["blue_stops"]),
    },
    "prnu": lambda v, _: {"sigma": v["sigma"]},
    "dark_current": lambda v, unit: {
        "per_second": v["electrons_per_second"] * unit.electron
    },
    "full_well": lambda v, _: {"below_white": v["below_white"]},
    "shot_noise": lambda v, _: {"log_gain": v["log_gain"]},
    "read_noise": lambda v, _: {"log_variance": v["log_variance"]},
    "row_noise": _spread,
    "column_fixed_pattern": _spread,
    "dsnu": _spread,
    "black_level_drift": _spread,
    "amplifier_mismatch": _mismatch,
    "black_level": _black_level,
    "pdaf_pixels": lambda v, _: {
        "gain": -v["loss"],
        "pitch": v["period"],
        "row": v["row"],
        "column": v["column"],
    },
    "dust": lambda v, _: {"density": v["per_megapixel"]},
    "read_noise_correlation": lambda v, _: {"coefficient": v["correlation"]},
}
