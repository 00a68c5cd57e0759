# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectra of lights: a pool of daylight, black bodies and lamps, halved."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.profile.illuminant_spectra import REAL_LIGHTS, illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from studies.protocol import PROTOCOL, LightRules
from studies.world.colorimetry import Array, observer, of_luminance_1
from studies.world.halves import Half, halved

TM30_LAMPS = Path("spds") / "IESTM30_15_Sspds.dat"
TM30_TYPES = Path("spds") / "IESTM30_15_Sinfo.txt"
FAMILIES = ("daylight", "black_body", "lamp")
KEY, HALF_KEY = 7, 5
LEAST_POWER = 1e-3  # of a phase of daylight that scatter took below 0
SECOND_RADIATION = 1.4388e7  # nm K; CIE 015:2018


@dataclass(frozen=True)
class Lights:
    """Lights of one half."""

    powers: Array  # (n, 81), luminance 1
    family: NDArray[np.int64]  # (n,), of FAMILIES
    led: NDArray[np.bool_]  # (n,): whether a lamp is an LED

    def weights(self, shares: dict[str, float]) -> Array:
        """Return (n,), sum 1: each family has its share, all of one family the same."""
        counts = np.bincount(self.family, minlength=len(FAMILIES))
        goal = np.array([shares[name] for name in FAMILIES])
        weight = np.asarray(goal / np.maximum(counts, 1))[self.family]
        return np.asarray(weight / weight.sum())

    def chosen(self, which: NDArray[Any]) -> "Lights":
        """Return the lights of a mask (n,), or of places in the pool."""
        return Lights(self.powers[which], self.family[which], self.led[which])

    def blueness(self) -> Array:
        """Return Z over Y (n,)."""
        return np.asarray((self.powers @ observer())[:, 2])

    def night_weights(self, rules: LightRules = PROTOCOL.lights) -> Array:
        """Return (n,), sum 1: lamps and black bodies of night_kelvin, no daylight."""
        kelvin = mccamy(self.powers)
        low, high = rules.night_kelvin
        kept = self.weights(rules.night_shares) * ((kelvin > low) & (kelvin < high))
        return np.asarray(kept / kept.sum())


def lights(
    luxpy: Path | None, rules: LightRules = PROTOCOL.lights
) -> dict[Half, Lights]:
    """Return the Lights of each half; no light is in both.

    luxpy : its folder of data files, or None for colour-science's lamps alone."""
    rng = np.random.default_rng(KEY)
    powers_of_lamps, led = lamps(luxpy)
    families = daylight(rng, rules), black_bodies(rng, rules), powers_of_lamps
    powers = of_luminance_1(np.concatenate(families))
    family = np.repeat(np.arange(len(FAMILIES)), [len(rows) for rows in families])
    leds = np.concatenate([np.zeros(len(powers) - len(led), bool), led])
    pool = Lights(powers, family, leds)
    return {
        half: pool.chosen(ids) for half, ids in halved(len(powers), HALF_KEY).items()
    }


def daylight(rng: np.random.Generator, rules: LightRules) -> Array:
    """Return phases of daylight (n, 81), even in mired, scattered as measured days are.

    Source: CIE 015:2018, 4.1.2."""
    import colour
    from colour.colorimetry import SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES as basis

    s0, s1, s2 = (
        np.interp(WAVELENGTHS, basis[name].wavelengths, basis[name].values)
        for name in ("S0", "S1", "S2")
    )
    kelvin = even_in_mired(rng, rules.day_kelvin, rules.daylight)
    xy = np.array([colour.temperature.CCT_to_xy_CIE_D(t) for t in kelvin])
    x, y = xy[:, :1], xy[:, 1:]
    m = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m
    m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m
    first, second = (rng.normal(0.0, sd, x.shape) for sd in rules.scatter)
    return np.asarray((s0 + (m1 + first) * s1 + (m2 + second) * s2).clip(LEAST_POWER))


def black_bodies(rng: np.random.Generator, rules: LightRules) -> Array:
    """Return black bodies (n, 81), even in mired, with a slope of glass or age."""
    kelvin = even_in_mired(rng, rules.body_kelvin, rules.black_bodies)[:, None]
    planck = WAVELENGTHS**-5.0 / np.expm1(SECOND_RADIATION / WAVELENGTHS / kelvin)
    slope = rng.normal(0.0, rules.body_tilt, kelvin.shape)
    return np.asarray(planck * np.exp(slope * (WAVELENGTHS - 560.0) / 200.0))


def lamps(luxpy: Path | None) -> tuple[Array, NDArray[np.bool_]]:
    """Return lamps (n, 81), the CIE's, and with luxpy's files the 318 of IES TM-30; and
    which of them are LEDs (n,)."""
    names = [name for name in REAL_LIGHTS if not re.search(r"K$|^A$", name)]
    rows = [illuminant_spectrum(name) for name in names]
    led = [name.startswith("LED") for name in names]
    if luxpy is not None:
        table = np.loadtxt(luxpy / TM30_LAMPS, delimiter=",")
        rows += list(on_grid(table[:, 0], table[:, 1:]).T.clip(0.0))
        lines = (luxpy / TM30_TYPES).read_text().splitlines()[1:]
        led += [line.split(",")[2].strip().startswith("LED") for line in lines]
    kept = once(np.array(rows))
    return np.array(rows)[kept], np.array(led)[kept]


def on_grid(wavelengths: Array, powers: Array) -> Array:
    """Return powers (81, n) at WAVELENGTHS of a table (m, n) every nm.

    Averaged by the triangle that linear interpolation over 5 nm spreads a line by."""
    step = WAVELENGTHS[1] - WAVELENGTHS[0]
    distance = np.abs(wavelengths[None, :] - WAVELENGTHS[:, None])
    weight = np.clip(1.0 - distance / step, 0.0, None)
    return np.asarray(weight @ powers / weight.sum(axis=1, keepdims=True))


def once(powers: Array) -> NDArray[np.intp]:
    """Return which of powers (n, 81) do not stand there before."""
    shapes = of_luminance_1(powers).round(4)
    _, first = np.unique(shapes, axis=0, return_index=True)
    return np.sort(first)


def even_in_mired(
    rng: np.random.Generator, kelvin: tuple[float, float], count: int
) -> Array:
    """Return colour temperatures (count,) in K, uniform in their reciprocal."""
    low, high = kelvin
    return np.asarray(1.0 / rng.uniform(1.0 / high, 1.0 / low, count))


def mccamy(powers: Array) -> Array:
    """Return correlated colour temperatures (n,) in K of powers (n, 81).

    Source: C. S. McCamy, Color Research & Application 17(2), 1992."""
    import colour

    xy = colour.XYZ_to_xy(powers @ observer())
    return np.asarray(colour.temperature.xy_to_CCT_McCamy1992(xy), float)
