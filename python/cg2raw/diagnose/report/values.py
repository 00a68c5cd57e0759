# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Parameters in the units that a reader measures: DN, electrons, percent, factors."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from cg2raw import _core
from cg2raw.diagnose.diagnosis import Diagnosis, Estimate, Finding
from cg2raw.diagnose.report.text import decimal, estimate, number, power_of_ten

# What is a share of white, by the beginning of a parameter's name; of the others that
# have no unit, those of light and all shares are shown in percent.
OF_WHITE: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(
        ("row_noise", "dsnu", "column_fixed_pattern", "black_level_drift"), ("sigma",)
    ),
    "black_level": ("offset",),
    "bias_structure": ("horizontal", "vertical", "edge"),
    "amplifier_mismatch": ("horizontal_offset", "vertical_offset"),
    "dark_current": ("per_second",),
    "amplifier_glow": ("per_second",),
    "dark_current_nonuniformity": ("rate",),
    "hot_pixels": ("rate",),
    "random_telegraph_noise": ("amplitude",),
}
PLAIN = (
    "row",
    "column",
    "extent",
    "log_sigma",
    "ring",
    "tilt",
    *(f"r{n}" for n in range(2, 7)),
)
LOGARITHMS = ("log_variance", "log_gain")  # of a factor of the profile's variance
IN_WORDS = {
    "log_variance": "variance",
    "log_gain": "variance",
    "sigma": "standard deviation",
    "per_second": "",
    "coefficient": "correlation",
}
MOST_DECADES = 300  # that are told apart, as by LARGEST_E
SHARES = ("fraction", "depth", "horizontal_response", "vertical_response")
IN_PERCENT = ("color", "optics", "pixel", "response", "saturation")  # stages


@dataclass(frozen=True)
class Shown:
    """A parameter as it is shown. name : "" where the effect says it all."""

    name: str
    value: str
    interval: str
    unit: str

    @property
    def words(self) -> str:
        """Value and unit after the name."""
        return " ".join(filter(None, (self.name, self.value, self.unit)))


def stage_of(name: str) -> str:
    """Return where in a camera an effect is: "optics"; "" of one that is not known."""
    stages = {one["name"]: one["stage"] for one in _core.effects()}
    return str(stages.get(name, ""))


def shown(finding: Finding, diagnosis: Diagnosis) -> list[Shown]:
    """Return all parameters of an effect, each rounded to its interval."""
    each = [
        in_unit(finding.name, name, one, diagnosis)
        for name, one in finding.parameters.items()
    ]
    if len(each) == 1:  # of a site that is the only one
        return [replace(each[0], name=each[0].name.removesuffix(" 00"))]
    return each


def in_unit(
    effect: str, parameter: str, found: Estimate, diagnosis: Diagnosis
) -> Shown:
    """Return one parameter, in DN and electrons, percent, or as a factor."""
    name = IN_WORDS.get(parameter, parameter.replace("_", " "))
    if parameter in LOGARITHMS:
        low, high = (exp(one) for one in found.ci95)
        factor = Estimate(exp(found.value), "", (low, high))
        value, interval = estimate(factor)
        return Shown(name, value, interval, "times the profile's")
    scale, unit = scale_of(effect, parameter, found.unit, diagnosis)
    low, high = (scale * one for one in found.ci95)
    value, interval = estimate(Estimate(scale * found.value, unit, (low, high)))
    electrons = diagnosis.electrons_per_dn
    if unit.startswith("DN") and electrons:
        ends = (electrons * low, electrons * high)
        _, more = estimate(Estimate(sum(ends) / 2, "", ends))
        unit_e = unit.replace("DN", "e\N{SUPERSCRIPT MINUS}")
        interval += f" {unit} ({more} {unit_e})"
    elif unit:
        interval += f" {unit}"
    return Shown(name, value, interval, unit)


def scale_of(
    effect: str, parameter: str, unit: str, diagnosis: Diagnosis
) -> tuple[float, str]:
    """Return by what a value is multiplied, and the unit that it then has."""
    is_of_white = parameter.startswith(OF_WHITE.get(effect, ("\0",)))
    if is_of_white and unit in ("1", "1/s") and diagnosis.white_dn:
        return diagnosis.white_dn, "DN" + unit[1:]
    is_share = parameter in SHARES or stage_of(effect) in IN_PERCENT
    if unit in ("1", "") and is_share and not parameter.startswith(PLAIN):
        return 100.0, "%"
    return 1.0, "" if unit == "1" else unit


def limit_words(
    effect: str, parameter: str, strength: float, unit: str, diagnosis: Diagnosis
) -> str:
    """Return a detection limit in words: a size without an interval, of two digits."""
    if parameter in LOGARITHMS:
        return f"{number(100 * (exp(strength) - 1), 2)} % of the variance"
    scale, shown_unit = scale_of(effect, parameter, unit, diagnosis)
    name = IN_WORDS.get(parameter, parameter.replace("_", " "))
    words = f"{number(scale * strength, 2)} {shown_unit}".rstrip()
    return f"{words} ({name})" if name else words


def exp(value: float) -> float:
    """Return the exponential; not known where it is beyond all that is measured."""
    return math.exp(value) if abs(value) < 50 else math.nan


def powers(nats: float) -> str:
    """Return by what factor nats make something likelier, in words."""
    decades = math.floor(nats / math.log(10))
    if decades < 4:
        return f"{decimal(max(round(exp(nats)), 1), 0)} times"
    if decades > MOST_DECADES:
        return f"more than {power_of_ten(MOST_DECADES)} times"
    return f"{power_of_ten(decades)} times"
