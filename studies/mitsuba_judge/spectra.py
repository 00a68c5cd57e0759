# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the things of one scene are made of: spectra of the world's test half."""

from dataclasses import dataclass

import numpy as np

from studies.world.colorimetry import Array, of_luminance_1
from studies.world.halves import Half
from studies.world.lights import FAMILIES
from studies.world.materials import palette
from studies.world.shots import World

HALF: Half = "test"
GLASS, POLE, GROUND, PAVING = range(4)  # materials of every scene; paints follow
DARK = (0.02, 0.05)  # reflectance of what is behind glass, and of poles
GROUND_LEVEL, PAVING_LEVEL = (0.05, 0.16), (0.1, 0.35)  # their mean reflectance
GROUND_COLOUR = 0.4  # share of a material's colour that stone and asphalt have
SIGNS = 4  # lights behind colourful filters; a red one for tail lamps follows
CANDIDATES = 30  # objects of which the most fitting is a filter
PASSES = 2.0  # power of a reflectance that makes a filter of it
RED = 600.0  # nm, where a red filter begins to pass
FINISHES = {"matt": 0.6, "gloss": 0.3, "metal": 0.1}  # shares
ROUGHNESS = (0.15, 0.4)
WET_ROUGHNESS = (0.06, 0.16)


@dataclass(frozen=True)
class Material:
    """A surface: reflectance (81,), finish (matt, gloss, metal) and its roughness."""

    reflectance: Array
    finish: str = "matt"
    roughness: float = 0.1


@dataclass(frozen=True)
class Spectra:
    """Materials and lights of a scene. Lights: lamps, signs, the red one, the sky."""

    materials: tuple[Material, ...]
    lights: Array  # (n, 81), luminance 1
    ids: tuple[int, ...]  # of the lamps and, last, of the sky: in the test half's pool

    @property
    def lamps(self) -> int:
        """How many lights, the first ones, are lamps as measured."""
        return len(self.ids) - 1

    @property
    def red(self) -> int:
        """The light of tail lamps."""
        return len(self.lights) - 2

    @property
    def sky(self) -> int:
        """The light of the sky."""
        return len(self.lights) - 1


def draw_spectra(rng: np.random.Generator, world: World, wet: bool) -> Spectra:
    """Return the Spectra of a scene, wet by rain or dry."""
    measured, pool = world.reflectances[HALF], world.lights[HALF]
    count = int(rng.integers(24, 41))
    rows = palette(rng, measured, count + 2, world.protocol.materials)
    materials = [
        Material(np.full(rows.shape[1], DARK[0]), "gloss", 0.1),
        Material(np.full(rows.shape[1], DARK[1]), "gloss", 0.2),
        ground(rng, rows[0], GROUND_LEVEL, wet),
        ground(rng, rows[1], PAVING_LEVEL, wet),
        *(finished(rng, row) for row in rows[2:]),
    ]
    weight = pool.night_weights(world.protocol.lights)
    lamps = rng.choice(len(weight), int(rng.integers(3, 7)), replace=False, p=weight)
    daylight = np.flatnonzero(pool.family == FAMILIES.index("daylight"))
    ids = [*lamps, rng.choice(daylight)]
    behind = pool.powers[rng.choice(lamps, SIGNS + 1)]
    shown = of_luminance_1(behind * filters(rng, measured))
    lights = np.concatenate([pool.powers[lamps], shown, pool.powers[ids[-1:]]])
    return Spectra(tuple(materials), lights, tuple(int(each) for each in ids))


def ground(
    rng: np.random.Generator, row: Array, level: tuple[float, float], wet: bool
) -> Material:
    """Return a stone or asphalt with little of a reflectance's colour."""
    shape = 1.0 + GROUND_COLOUR * (row / row.mean() - 1.0)
    reflectance = (shape * rng.uniform(*level)).clip(0.0, 0.9)
    if wet:
        return Material(reflectance, "gloss", float(rng.uniform(*WET_ROUGHNESS)))
    return Material(reflectance)


def finished(rng: np.random.Generator, row: Array) -> Material:
    """Return a material of a reflectance, of any finish."""
    finish = str(rng.choice(list(FINISHES), p=list(FINISHES.values())))
    return Material(row, finish, float(rng.uniform(*ROUGHNESS)))


def filters(rng: np.random.Generator, measured: Array) -> Array:
    """Return transmittances (SIGNS + 1, 81) of coloured plastic, the last one red."""
    from cg2raw.profile.spectral_file import WAVELENGTHS

    found = []
    for number in range(SIGNS + 1):
        rows = measured[rng.choice(len(measured), CANDIDATES)]
        if number == SIGNS:
            fit = rows[:, WAVELENGTHS > RED].mean(axis=1) / rows.mean(axis=1)
        else:
            fit = rows.std(axis=1) / rows.mean(axis=1)
        found.append(rows[np.argmax(fit)] ** PASSES)
    return np.array(found)
