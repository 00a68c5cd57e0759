# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Synthetic camera: one with hidden effects, and the frames that it takes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import get_args
from zlib import crc32

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from cg2raw.diagnose.captures.capture import Group, Kind
from cg2raw.synthetic import charge, conditions, light, scenes
from cg2raw.synthetic.camera import Camera, Plane
from cg2raw.synthetic.charge import Patterns
from cg2raw.synthetic.density import log_density
from cg2raw.synthetic.dust import transmission
from cg2raw.synthetic.light import Field, Hidden
from cg2raw.synthetic.measured import Measured
from cg2raw.synthetic.photons import ROUNDING
from cg2raw.synthetic.posterior import Observation, Posterior, posterior
from cg2raw.synthetic.readout import (
    blended,
    noise_of,
    read_out,
    row_unit,
)
from cg2raw.synthetic.telegraph import Traps, offsets, traps_of

# px around a frame that scenes have more: lenses look beyond its edges.
MARGIN = 12
PATTERNS = {
    *("prnu", "dsnu", "column_fixed_pattern", "hot_pixels"),
    "dark_current_nonuniformity",
}
GROUPS: tuple[Group, ...] = get_args(Group)


@dataclass(frozen=True)
class Shot:
    """One frame that is taken. repeat : its number in the set. seconds : exposure
    time."""

    name: str
    kind: Kind
    group: Group
    set: str
    repeat: int
    seconds: float


def plan(
    seed: int, groups: tuple[Group, ...] = GROUPS, twice: bool = False
) -> list[Shot]:
    """Return the standard set, 8 frames per group: darks of two exposure times, two
    flats, two scenes twice.

    twice : each dark and flat as well, 12 frames per group: what repeats has a scatter.
    """
    shots = []
    for group in groups:
        rng = stream(seed, f"plan/{group}")
        dark_times = (rng.uniform(0.01, 0.05), rng.uniform(1.5, 4.0))
        for n, seconds in enumerate(dark_times):
            name = f"{group}_dark_{n}"
            shots.append(Shot(name, "dark", group, f"{group}_dark", n, seconds))
        for n in range(2):
            name, seconds = f"{group}_flat_{n}", rng.uniform(0.02, 0.2)
            shots.append(Shot(name, "flat", group, name, 0, seconds))
        for n in range(2):
            name, seconds = f"{group}_scene_{n}", rng.uniform(0.02, 0.5)
            for repeat in range(2):
                one = f"{name}_{repeat}"
                shots.append(Shot(one, "scene", group, name, repeat, seconds))
    if not twice:
        return shots
    return [one for shot in shots for one in (shot, *_again(shot))]


def _again(shot: Shot) -> list[Shot]:
    """Return the second frame of a dark or flat; a scene has one already."""
    again = replace(shot, name=f"{shot.name}_again")
    return [] if shot.kind == "scene" else [again]


def stream(seed: int, purpose: str) -> Generator:
    """Return random numbers that depend on a seed and what they are for."""
    return np.random.default_rng([seed, crc32(purpose.encode())])


class SyntheticCamera:
    """Draws frames, and knows their density.

    nuisances : all of conditions.STUDIO, as conditions.checked returns them. twice : as
    of plan."""

    def __init__(
        self,
        camera: Camera,
        hidden: Hidden,
        seed: int,
        shape: tuple[int, int],
        nuisances: Mapping[str, float],
        measured: Measured | None = None,
        twice: bool = False,
    ) -> None:
        self.camera, self.hidden, self.twice = camera, hidden, twice
        self.measured = measured or Measured()
        self.seed, self.shape, self.nuisances = seed, shape, nuisances
        self.field = Field(shape, MARGIN)
        self.noise = noise_of(hidden)
        rng = stream(seed, "patterns")
        self.patterns = charge.patterns(rng, shape, hidden, camera)
        self.shots = plan(seed, twice=twice)
        self.fit_shots = [shot for shot in self.shots if shot.group == "fit"]
        self._scene = lru_cache(maxsize=2)(self._drawn_scene)
        self._on_sensor = lru_cache(maxsize=6)(self._light_on_sensor)

    def _drawn_scene(self, name: str) -> NDArray[np.float32]:
        height, width = self.shape
        padded = (height + 2 * MARGIN, width + 2 * MARGIN)
        return scenes.scene(stream(self.seed, f"scene/{name}"), padded, self.camera)

    def flat(self, name: str) -> NDArray[np.float32]:
        """Return the radiance of a flat, (3,): the first of a group is the darker."""
        rng = stream(self.seed, f"flat/{name}")
        low, high = (0.12, 0.35) if name.endswith("0") else (0.45, 0.85)
        tint = 1 + 0.06 * rng.standard_normal(3)
        radiance: Plane = rng.uniform(low, high) * tint / tint.max()
        return radiance.astype(np.float32)

    def render(self, shot: Shot) -> NDArray[np.float32]:
        """Return what is said to stand before the lens: (H, W, 3), or (3,)."""
        if shot.kind == "dark":
            return np.zeros(3, np.float32)
        if shot.kind == "flat":
            return self.flat(shot.set)
        scene = self._scene(shot.set)[self.field.inner]
        rng = stream(self.seed, f"render/{shot.set}")
        return conditions.rendered(rng, scene, self.nuisances)

    def _light_on_sensor(self, kind: str, name: str) -> Plane:
        if kind == "flat":
            flat = self.flat(name).astype(np.float64)
            scene = np.broadcast_to(flat, (*self.field.x.shape, 3))
        else:
            rng = stream(self.seed, f"place/{name}")
            scene = conditions.misregistered(
                rng, self._scene(name).astype(np.float64), self.field, self.nuisances
            )
        entering = light.camera_light(scene, self.camera, self.hidden)
        return light.through_lens(entering, self.hidden, self.field)

    def brightness(self, shot: Shot) -> float:
        """Return the factor on a shot's light that nobody knows."""
        most = self.nuisances["exposure"]
        of_set = 1 + stream(self.seed, f"exposure/{shot.set}").uniform(-most, most)
        jitter = stream(self.seed, f"jitter/{shot.name}").standard_normal()
        return of_set * (1 + self.nuisances["light"] * jitter)

    def expected(self, shot: Shot, patterns: Patterns) -> tuple[Plane, Plane]:
        """Return charge, electrons, and pedestal, DN, of a sensor with patterns."""
        foot = charge.pedestal(self.hidden, self.camera, patterns, self.shape)
        if shot.kind == "dark":
            x = np.zeros(self.shape)
        else:
            on_sensor = self._on_sensor(shot.kind, shot.set) * self.brightness(shot)
            jitter = stream(self.seed, f"line_jitter/{shot.name}")
            on_sensor = light.jittered(jitter, on_sensor, self.hidden)
            phase = stream(self.seed, f"flicker/{shot.name}").random()
            x = charge.mosaic_light(on_sensor, self.hidden, self.camera, phase)
            x = x * self.dust
            if self.measured.transmission is not None:
                x = x * self.measured.transmission
        return (
            charge.electrons(x, self.hidden, self.camera, patterns, shot.seconds),
            foot,
        )

    def _jumps(self, shot: Shot) -> Plane | float:
        """Return what traps add to a frame, DN, as they are in it."""
        traps = self.traps
        if traps is None:
            return 0.0
        number = [one.name for one in self.shots].index(shot.name)
        return offsets(
            traps, number, lambda n: stream(self.seed, f"telegraph/states/{n}")
        )

    @cached_property
    def dust(self) -> Plane:
        """The share of light that dust on the sensor lets through."""
        return transmission(stream(self.seed, "dust"), self.shape, self.hidden)

    @cached_property
    def traps(self) -> Traps | None:
        """What jumps in the sensor."""
        rng = stream(self.seed, "telegraph")
        return traps_of(rng, self.shape, self.hidden, self.camera)

    def raw(self, shot: Shot) -> NDArray[np.uint16]:
        """Return the frame, (H, W) DN."""
        rng = stream(self.seed, f"noise/{shot.name}")
        expected, foot = self.expected(shot, self.patterns)
        foot = foot + self._jumps(shot)
        reader = self.measured.read_noise
        return read_out(rng, expected, foot, self.noise, self.camera, reader)

    def log_density(self, shot: Shot) -> NDArray[np.float32]:
        """Return (H, W) nats per pixel, 1 DN the unit, of the model that drew a frame,
        which knows the nuisances too, and no read noise that was measured.

        Patterns of the sensor are known to it in the fit frames; in others as far as
        the fit frames tell (posterior.py). Of traps it knows steps, and no state."""
        patterns = self.patterns
        unsure: Plane | float = 0.0
        if shot.group != "fit" and self.has_patterns:
            patterns = self.found.mean
            unsure = self.found.variance(self._slopes(shot, patterns))
        expected, foot = self.expected(shot, patterns)

        def at(foot: Plane) -> NDArray[np.float32]:
            raw = self.raw(shot)
            return log_density(raw, expected, foot, self.noise, self.camera, unsure)

        if self.traps is None:
            return at(foot)
        half = self.traps.step / 2
        both = np.logaddexp(at(foot - half), at(foot + half)) - np.log(2)
        return np.asarray(both, np.float32)

    @property
    def has_patterns(self) -> bool:
        """Whether pixels differ."""
        return bool(self.hidden.keys() & PATTERNS)

    @cached_property
    def found(self) -> Posterior:
        """What the fit frames tell of the patterns."""
        seen = [self._observation(shot) for shot in self.fit_shots]
        return posterior(seen, self.hidden, self.camera, self.patterns)

    def _observation(self, shot: Shot) -> Observation:
        without, foot = self.expected(shot, Patterns.none(self.shape))
        known, _ = self.expected(shot, self.patterns)
        gain = self.camera.over(self.camera.dn_per_electron, self.shape)
        read = gain * self.camera.over(self.camera.read_noise, self.shape)
        noise = self.noise
        temporal = float(np.dot(noise.weights, noise.variances))
        variance = gain**2 * noise.excess * known + temporal * read**2 + ROUNDING
        level = self.raw(shot).astype(np.float64)
        well = noise.well * self.camera.over(self.camera.full_well, self.shape)
        clear = known + 4 * np.sqrt(noise.excess * known) < well
        if noise.blend:
            level = blended(level, noise.blend, inverse=True)
        usable = (level > 1) & (level < self.camera.white - 1) & clear
        residual = level - foot - gain * without
        for half, axis in ((noise.frame, (0, 1)), (noise.row, (1,))):
            if half:
                likely = self._offsets(half, axis, residual, variance, usable)
                residual = residual - likely
        slopes = self._slopes(shot, Patterns.none(self.shape))
        return Observation(residual, variance, usable, slopes)

    def _offsets(
        self,
        half: float,
        axis: tuple[int, ...],
        residual: Plane,
        variance: Plane,
        usable: Plane,
    ) -> Plane:
        weight = (usable / variance).sum(axis, keepdims=True)
        pull = (usable * residual / variance).sum(axis, keepdims=True)
        prior = (half * row_unit(self.camera)) ** 2 / 3
        offsets: Plane = pull / (weight + 1 / prior)
        return offsets

    def _slopes(self, shot: Shot, at: Patterns) -> tuple[Plane, Plane, Plane]:
        """Return the change of a level, DN, by gain, leak and offset."""
        gain = self.camera.over(self.camera.dn_per_electron, self.shape)
        here, _ = self.expected(shot, at)
        ones = np.ones(self.shape)
        slopes = []
        for field, step in (("gain", 1e-3), ("leak", 1.0)):
            moved = replace(at, **{field: getattr(at, field) + step * ones})
            slopes.append(gain * (self.expected(shot, moved)[0] - here) / step)
        return slopes[0], slopes[1], gain
