# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Effects of the registry that a calibration calls for, in units of the signal.

A signal is 1 at white, above black. An effect is called for if it stands out from its
standard error; where it was looked for and does not, the profile is not to have it.
"""

from collections.abc import Callable, Mapping
from typing import Literal

from scipy.special import gammaincinv

from cg2raw.calibration.fitting import measured
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.measurements import Measurements

Found = Mapping[str, float | Measured]
CHANCE = 1.35e-3  # of a normal deviate above three standard deviations
CORRELATION_FLOOR = 0.005  # which a few flickering pixels bring
SHADING_FLOOR = 1e-3  # rms; no lamp is flatter
STEADY = 5e-3  # relative, of a lamp and a shutter from exposure to exposure


def effects_found(found: Measurements, has_shapes: bool) -> dict[str, Found | None]:
    """Return {effect: its values, None if it does not stand out}.

    has_shapes : the rows of noise say row_sigma, so that rows' noise is no effect. What
    the frames cannot show is not in it."""
    answers = {look.__name__: look(found) for look in LOOKS}
    if has_shapes and answers["row_noise"]:
        answers["row_noise"] = None
    return {name: answer for name, answer in answers.items() if answer is not False}


def tails(found: Measurements) -> list[str]:
    """Return a note on heavy tails, which a row of noise may say."""
    noise = found.tails
    if noise is None or noise.excess_kurtosis is None or not noise.are_heavy:
        return []
    return [
        f"read noise: its tails are not normal (excess kurtosis "
        f"{noise.excess_kurtosis.value:.2f}, Tukey lambda {noise.tukey_lambda:.2f}); "
        "rows of noise with tukey_lambda and row_sigma say that"
    ]


Answer = Found | None | Literal[False]  # False: the frames cannot show it


def deviation(c: Measurements, name: str, scale: float = 1.0) -> Answer:
    """Return a deviation of the fit as an effect's sigma, in units of @scale."""
    found = c.figure(name)
    if found is None:
        return False
    if not found.variance_stands_out:
        return None
    return {"sigma": found.scaled(1 / scale, "1")}


def row_noise(c: Measurements) -> Answer:
    return deviation(c, "row noise", c.range)


def column_fixed_pattern(c: Measurements) -> Answer:
    return deviation(c, "fixed column pattern", c.range)


def dsnu(c: Measurements) -> Answer:
    return deviation(c, "DSNU", c.range)


def prnu(c: Measurements) -> Answer:
    return deviation(c, "PRNU")


def black_level_drift(c: Measurements) -> Answer:
    """By the chi-square of its few frames: by noise it is as large in 1 of 740."""
    figures = [one for one in c.fit.figures if one.name == "black level drift"]
    if not figures:
        return False
    (drift,) = figures
    half = (sum(c.repeats) - len(c.repeats)) / 2
    # The ends of its interval are those of the total less the part of noise.
    low, most = gammaincinv(half, [0.025, 1 - CHANCE]) / half
    total = (drift.high**2 - drift.value**2) / (1 / low - 1)
    if drift.value == 0 or total <= most * (total - drift.value**2):
        return None
    return {"sigma": measured(drift).scaled(1 / c.range, "1")}


def bias_structure(c: Measurements) -> Answer:
    s = c.structure
    if s is None:
        return False
    parts: dict[str, float | Measured] = {}
    for name in ("horizontal", "vertical"):
        measured = getattr(s, name)
        if measured.stands_out:
            parts[name] = measured.scaled(1 / c.range, "1")
    if s.edge is not None and s.edge_length is not None and not s.edge_is_longer:
        parts["edge"] = s.edge.scaled(1 / c.range, "1")
        parts["edge_length"] = s.edge_length
    return parts or None


def dark_current(c: Measurements) -> Answer:
    if c.dark is None:
        return False
    rate = c.dark.rate
    if not rate.stands_out or rate.value < 0:
        return None
    shine = c.glow.mean if c.glow is not None and c.glow.is_measured else 0.0
    without = Measured(max(rate.value - shine, 0.0), rate.standard_error, rate.unit)
    return {"per_second": without.scaled(1 / c.range, "1/s")}


def dark_current_nonuniformity(c: Measurements) -> Answer:
    s = c.spread
    if s is None or s.has_too_many_hot:
        return False
    if not s.is_uneven:
        return None
    return {"rate": s.rate.scaled(1 / c.range, "1/s"), "log_sigma": s.log_sigma}


def hot_pixels(c: Measurements) -> Answer:
    s = c.spread
    if s is None or s.has_too_many_hot:
        return False
    if not s.has_hot:
        return None
    return {"fraction": s.fraction, "rate": s.hot_rate.scaled(1 / c.range, "1/s")}


def amplifier_glow(c: Measurements) -> Answer:
    g = c.glow
    if g is None:
        return False
    if not g.is_measured:
        return None
    return {
        "per_second": g.per_second.scaled(1 / c.range, "1/s"),
        "row": g.row,
        "column": g.column,
        "extent": g.extent,
    }


def read_noise_correlation(c: Measurements) -> Answer:
    if (r := c.figure("correlation, next in row")) is None:
        return False
    is_seen = r.stands_out and abs(r.value) > CORRELATION_FLOOR
    return {"coefficient": r} if is_seen else None


def lens_shading(c: Measurements) -> Answer:
    if c.light is None:
        return False
    is_shaded = c.light.fall_off.stands_out and c.light.fall_off.value > SHADING_FLOOR
    return dict(c.light.shading) if is_shaded else None


def full_well(c: Measurements) -> Answer:
    if c.transfer is None or c.transfer.saturation is None:
        return False
    if c.transfer.clipped_by != "full well":
        return None
    level = c.transfer.saturation.scaled(1 / c.range, "1")
    return {"below_white": Measured(1 - level.value, level.standard_error, "1")}


def nonlinearity(c: Measurements) -> Answer:
    x = c.linearity
    if x is None:
        return False
    if not x.quadratic.stands_out or x.bend < STEADY:
        return None
    return {"quadratic": x.quadratic, **({"cubic": x.cubic} if x.cubic else {})}


def quantisation(c: Measurements) -> Answer:
    return {"step": c.sites.step / c.range} if c.sites.step > 1 else None


LOOKS: tuple[Callable[[Measurements], Answer], ...] = (
    bias_structure, black_level_drift, column_fixed_pattern, dsnu, row_noise,
    read_noise_correlation, dark_current, dark_current_nonuniformity, hot_pixels,
    amplifier_glow, prnu, lens_shading, nonlinearity, full_well, quantisation,
)  # fmt: skip
