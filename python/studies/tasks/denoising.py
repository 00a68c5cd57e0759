# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 2: denoising of packed RAW, trained on each source, tested on the camera.

All sources are exposed alike, so that colour alone tells them apart. Noise is that of
one sensor at an ISO: Gaussian, of a variance that is linear in the signal."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor
from studies.cameras import Camera
from studies.learners.least_squares import learn
from studies.protocol import DenoisingRules
from studies.sources.frames import Frames
from studies.sources.real import real
from studies.sources.sets import material, sources
from studies.world.exposure import exposed
from studies.world.shots import World, night_shots

Array = NDArray[np.float32]
Errors = dict[str, dict[str, list[list[float]]]]  # condition: source: (draws, frames)
SITES = ((0, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 2))  # row, column, channel of RGGB
REACH = 2  # sites of a plane on each side of the one that is denoised
SIDE = 2 * REACH + 1
CENTRE = SIDE * SIDE // 2
FLOOR = 0.01  # of white, added before the root that makes noise alike


@dataclass(frozen=True)
class Noise:
    """Variance of a site: of_signal x + constant, x in 0..1."""

    of_signal: float
    constant: float

    def added(self, planes: Array, rng: np.random.Generator) -> Array:
        """Return planes with noise, not clipped below 0."""
        variance = self.of_signal * planes.clip(0.0, None) + self.constant
        noise = rng.standard_normal(planes.shape) * np.sqrt(variance)
        return np.asarray((planes + noise).clip(None, 1.0), np.float32)


@dataclass(frozen=True)
class Draw:
    """How one learner is trained."""

    rules: DenoisingRules
    samples: int  # sites that are learnt of
    seed: int


def noise_of(sensor: Sensor, iso: float) -> Noise:
    """Return the Noise of a sensor, the mean over its sites. Raises ValueError."""
    found = sensor.noise_at(iso)
    return Noise(*(float(np.mean(found[name])) for name in ("beta1", "beta2")))


def denoising(world: World, camera: Camera, mode: str) -> Errors:
    """Return {condition: {source: PSNR in dB of each draw, of each test frame}}.

    A condition is an ISO and a brightness. mode : quick or full."""
    rules = world.protocol.denoising
    lender, samples = Sensor(rules.noise_of), rules.samples[mode]
    shots = night_shots(world, "test", rules.first, rules.tests[mode])
    tests = packed(real(shots, camera.sensitivities))
    conditions = {
        f"ISO {iso}, brightness {brightness:g}": (
            noise_of(lender, iso),
            np.float32(brightness),
        )
        for iso in rules.isos
        for brightness in rules.brightness
    }
    found: Errors = {condition: {} for condition in conditions}
    for seed in range(rules.draws[mode]):
        made = material(
            world, camera, "night", world.protocol.seeds, rules.frames[mode], seed
        )
        for source, make in sources(made, camera, seed).items():
            own = packed(make())
            for condition, (noise, brightness) in conditions.items():
                draw = Draw(rules, samples, seed)
                values = psnr_of(own * brightness, tests * brightness, noise, draw)
                of_source = found[condition].setdefault(source, [])
                of_source.append([round(value, 4) for value in values])
    return found


def packed(frames: Frames) -> Array:
    """Return (n, 4, h, w): the four sites of RGGB of frames as a sensor keeps them."""
    kept = np.stack([exposed(image) for image in frames.images])
    planes = [kept[:, row::2, column::2, channel] for row, column, channel in SITES]
    return np.stack(planes, axis=1)


def psnr_of(own: Array, tests: Array, noise: Noise, draw: Draw) -> list[float]:
    """Return PSNR in dB of the test frames, denoised as learnt of a source's planes.

    own, tests : clean planes (n, 4, h, w). A test frame's noise is the same for all
    sources and draws."""
    rules, rng = draw.rules, np.random.default_rng([draw.seed, 77])
    noisy = noise.added(own, rng)
    count = round(len(own) * rules.validation)
    training, validation = (
        sampled(noisy[part], own[part], draw.samples, rng)
        for part in (slice(None, -count), slice(-count, None))
    )
    learnt = learn(training, validation, rules.features, rules.ridges, draw.seed)
    found = []
    for number, clean in enumerate(tests):
        dark = noise.added(clean[None], np.random.default_rng([number, 78]))
        values = patches(dark)
        restored = centres(values) + learnt(rooted(values))
        goal = clean[:, REACH:-REACH, REACH:-REACH].reshape(4, -1).T
        squares = float(((restored.clip(0.0, 1.0) - goal) ** 2).mean())
        found.append(-10.0 * float(np.log10(squares + 1e-12)))
    return found


def sampled(
    noisy: Array, clean: Array, count: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Return (inputs, corrections) of at most count sites, drawn from all frames."""
    inputs, goal = patches(noisy), centres(patches(clean))
    chosen = rng.permutation(len(inputs))[:count]
    return rooted(inputs[chosen]), goal[chosen] - centres(inputs[chosen])


def patches(planes: Array) -> Array:
    """Return (m, 4 SIDE^2): what surrounds each site of planes (n, 4, h, w)."""
    windows = np.lib.stride_tricks.sliding_window_view(planes, (SIDE, SIDE), (2, 3))
    return windows.transpose(0, 2, 3, 1, 4, 5).reshape(-1, 4 * SIDE * SIDE)


def centres(values: Array) -> Array:
    """Return (m, 4): the middle of patches (m, 4 SIDE^2)."""
    return values.reshape(-1, 4, SIDE * SIDE)[:, :, CENTRE]


def rooted(values: Array) -> Array:
    """Return patches in which noise is nearly the same at each signal."""
    return np.asarray(np.sqrt(values.clip(0.0, None) + FLOOR), np.float32)
