# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A denoiser by least squares: a site is corrected by what surrounds it."""

from dataclasses import dataclass, replace

import numpy as np

from studies.learners.least_squares import Features, Learnt, features, fitted
from studies.learners.lesson import Array, Denoiser, Learner, Lesson
from studies.protocol import DenoisingRules

FLOOR = 0.01  # of white, added before the root that makes noise alike


@dataclass(frozen=True)
class PatchDenoiser:
    """Corrections of sites, as they are learnt of patches."""

    learnt: Learnt
    reach: int  # sites of a plane on each side of the one that is denoised

    def __call__(self, noisy: Array) -> Array:
        """Return planes (n, 4, h, w) of noisy ones; borders are reflected."""
        reach = self.reach
        edges = ((0, 0), (0, 0), (reach, reach), (reach, reach))
        wide = np.pad(noisy, edges, mode="reflect")
        frames = [self.corrections(frame[None]) for frame in wide]
        shape = (len(noisy), *noisy.shape[2:], noisy.shape[1])
        correction = np.stack(frames).reshape(shape).transpose(0, 3, 1, 2)
        return np.asarray(noisy + correction, np.float32)

    def corrections(self, wide: Array) -> Array:
        """Return (m, 4) for the inner sites of planes (1, 4, h, w)."""
        windows = windows_of(wide, self.reach)
        return self.learnt(rooted(flat(windows.transpose(0, 2, 3, 1, 4, 5))))


def patch_learner(rules: DenoisingRules, mode: str) -> Learner:
    """Return the Learner of random features. mode : quick or full."""

    def learner(lesson: Lesson) -> Denoiser:
        rng = np.random.default_rng([lesson.seed, 77])
        noisy, count = lesson.noisy(lesson.clean, rng), lesson.validation
        training, validation = (
            sampled(noisy[part], lesson.clean[part], rules, rules.samples[mode], rng)
            for part in (slice(None, -count), slice(-count, None))
        )
        layer = local_features(training[0], rules, lesson.seed)
        learnt = fitted(layer, training, validation, rules.ridges)
        return PatchDenoiser(learnt, rules.reach)

    return learner


def local_features(values: Array, rules: DenoisingRules, seed: int) -> Features:
    """Return random Features of patches (m, 4 side^2), each of a neighbourhood of its
    own: its weights fall off as a Gaussian of rules.focus, a range of sd in sites."""
    drawn = features(values, rules.features, seed, rules.spread)
    places = np.arange(-rules.reach, rules.reach + 1) ** 2
    squares = np.tile(np.add.outer(places, places).ravel(), 4)
    low, high = np.log(rules.focus)
    rng = np.random.default_rng([seed, 89])
    logs = rng.uniform(float(low), float(high), rules.features)
    focus = np.exp(-0.5 * squares[:, None] / np.exp(2.0 * logs))
    focus /= np.sqrt((focus**2).mean(axis=0))
    return replace(drawn, weights=np.asarray(drawn.weights * focus, np.float32))


def sampled(
    noisy: Array,
    clean: Array,
    rules: DenoisingRules,
    count: int,
    rng: np.random.Generator,
) -> tuple[Array, Array]:
    """Return (inputs, corrections) of at most count sites, drawn from all frames."""
    windows, goals = (windows_of(planes, rules.reach) for planes in (noisy, clean))
    frames, _, height, width = windows.shape[:4]
    chosen = rng.permutation(frames * height * width)[:count]
    frame, row, column = np.unravel_index(chosen, (frames, height, width))
    at = (frame, slice(None), row, column)
    centre = (..., rules.reach, rules.reach)
    inputs = windows[at]
    return rooted(flat(inputs)), goals[at][centre] - inputs[centre]


def windows_of(planes: Array, reach: int) -> Array:
    """Return a view (n, 4, h - 2 reach, w - 2 reach, side, side) of planes."""
    side = 2 * reach + 1
    return np.lib.stride_tricks.sliding_window_view(planes, (side, side), (2, 3))


def flat(windows: Array) -> Array:
    """Return patches (m, 4 side^2) of windows (..., 4, side, side)."""
    return windows.reshape(-1, int(np.prod(windows.shape[-3:])))


def rooted(values: Array) -> Array:
    """Return patches in which noise is nearly the same at each signal."""
    return np.asarray(np.sqrt(values.clip(0.0, None) + FLOOR), np.float32)
