# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The scene of an index: what stands where, of what, under which lights."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from studies.mitsuba_judge.kit import MAIN, Kit
from studies.mitsuba_judge.plans import PLANS, View
from studies.mitsuba_judge.spectra import HALF, Spectra, draw_spectra
from studies.mitsuba_judge.things import Thing
from studies.world.colorimetry import Array
from studies.world.halves import generator
from studies.world.shots import World

KEY = 71  # of generators
WET = 0.45  # share of wet scenes
SKIES = {  # radiance of the sky, and its share of scenes; 1: a white under a lamp
    "glow": ((0.001, 0.006), 0.45),
    "moon": ((0.003, 0.012), 0.3),
    "dusk": ((0.015, 0.06), 0.25),
}


@dataclass(frozen=True)
class Scene:
    """A scene."""

    index: int
    kind: str  # of PLANS
    wet: bool
    sky: str  # of SKIES
    sky_light: int
    sky_level: float
    view: View
    things: tuple[Thing, ...]
    spectra: Spectra
    flux: Array  # (n,), of each light: radiance times area

    @property
    def main(self) -> int:
        """The main light: the lamps' of which there is most."""
        return int(np.argmax(self.flux[: self.spectra.lamps]))

    def mean_light(self) -> Array:
        """Return (81,), a mean of the lights in which the dim ones have their part."""
        share = np.sqrt(self.flux)
        return np.asarray(share @ self.spectra.lights / share.sum())

    def described(self) -> dict[str, Any]:
        """Return what a frame's description says of it."""
        return {
            "index": self.index,
            "kind": self.kind,
            "wet": self.wet,
            "sky": self.sky,
            "things": len(self.things),
            "shining": sum(thing.light is not None for thing in self.things),
            "lamps": list(self.spectra.ids[:-1]),  # in the pool of the test half
            "main": self.main,
        }

    def as_json(self) -> dict[str, Any]:
        """Return all that a renderer needs, spectra at WAVELENGTHS included."""
        return {
            "view": asdict(self.view),
            "mean_light": rounded(self.mean_light()),
            "sky": {"light": self.sky_light, "level": self.sky_level},
            "lights": rounded(self.spectra.lights),
            "materials": [
                {
                    "reflectance": rounded(each.reflectance),
                    "finish": each.finish,
                    "roughness": each.roughness,
                }
                for each in self.spectra.materials
            ],
            "things": [asdict(thing) for thing in self.things],
        }


def rounded(values: Array) -> Any:
    """Return lists of numbers of 7 digits."""
    if values.ndim > 1:
        return [rounded(row) for row in values]
    return [float(f"{value:.7g}") for value in values]


def scene(index: int, world: World) -> Scene:
    """Return the Scene of an index: even ones are streets, odd ones squares."""
    rng = generator(HALF, index, KEY)
    kind = list(PLANS)[index % len(PLANS)]
    wet = bool(rng.random() < WET)
    spectra = draw_spectra(rng, world, wet)
    sky = str(rng.choice(list(SKIES), p=[share for _, share in SKIES.values()]))
    sky_level = float(np.exp(rng.uniform(*np.log(SKIES[sky][0]))))
    sky_light = MAIN if sky == "glow" else spectra.sky
    lit, mixed = rng.uniform(0.05, 0.45), rng.uniform(0.0, 0.6)
    kit = Kit(rng, spectra, float(lit), float(mixed))
    things, view = PLANS[kind](kit)
    flux = flux_of(things, len(spectra.lights))
    return Scene(
        index, kind, wet, sky, sky_light, sky_level, view, tuple(things), spectra, flux
    )


def flux_of(things: list[Thing], lights: int) -> Array:
    """Return (lights,), how much there is of each light: radiance times area."""
    flux = np.zeros(lights)
    for thing in things:
        if thing.light is not None:
            flux[thing.light] += thing.level * thing.area()
    return flux
