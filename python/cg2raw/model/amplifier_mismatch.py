# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Amplifier mismatch: halves of the frame that differ in black level or in response.

It is measured by the step in the middle of the columns, and of the rows, and taken
off, so that it gets no name of what is smooth or of lines."""

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cg2raw.statistics.constant import (
    SMOOTH,
    Array,
    ConstantStatistics,
    PlaneStatistics,
    polynomials,
)

NAME = "amplifier_mismatch"
DIRECTIONS = {0: "vertical", 1: "horizontal"}  # of halves, by the axis of an image
SMOOTH_NAMES = "bias_structure", "lens_shading"  # like an offset, and a response
NEAR = 8  # parts of a side, as wide as what is slow can follow a step
ROUNDS = 30  # of variances by what a step leaves
FEWEST = 32  # lines, of which the slow ones, 12 numbers, leave more than half


class Step(NamedTuple):
    """Of the second half less the first, with its standard error: DN of darks, relative
    of light. lines : (n,) the means that have it."""

    value: float
    error: float
    lines: Array


Steps = Mapping[str, Step]  # by a parameter of the effect


@dataclass(frozen=True)
class AmplifierMismatch:
    """gain : nats of the steps that training frames show, on validation frames, over
    those that are stated. alike : effects in whose place steps may be. steps : of both,
    where they gain enough; tested : of test frames. errors : of each parameter that
    validation frames show. stated : steps of the profile."""

    gain: float = 0.0
    alike: Collection[str] = ()
    steps: Steps = field(default_factory=dict)
    tested: Steps = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)
    stated: Mapping[str, float] = field(default_factory=dict)

    def taken_off(self, statistics: ConstantStatistics) -> ConstantStatistics:
        """Return the same of frames without steps: as found, or else as stated."""
        light = _light(statistics)
        for axis, (offset, response) in self._present():
            sizes = offset + response * light
            planes = [
                _less(plane, axis, of_plane)
                for plane, of_plane in zip(statistics.planes, sizes, strict=True)
            ]
            mean_of = partial(_image_of, statistics, axis, sizes)
            statistics = replace(statistics, planes=tuple(planes), mean_of=mean_of)
        return statistics

    def given_back(self, statistics: ConstantStatistics) -> ConstantStatistics:
        """Return what taken_off returned, with the steps beyond those stated."""
        beyond = {n: self.stated.get(n, 0.0) - s.value for n, s in self.steps.items()}
        return AmplifierMismatch(stated=beyond).taken_off(statistics)

    def allowed(self, shape: tuple[int, int]) -> Iterator[tuple[str, float]]:
        """Yield, by name, the variance of a coefficient of what is smooth that errors
        of these steps leave. shape : (h, w) of a plane."""
        for axis in DIRECTIONS:
            of_step = polynomials(shape[axis])[1 : SMOOTH + 1] @ unit_step(shape[axis])
            size = shape[1 - axis] * float((of_step**2).mean())
            for name, shape_name in zip(
                parameter_names(axis), SMOOTH_NAMES, strict=True
            ):
                if name in self.steps:
                    yield shape_name, self.steps[name].error ** 2 * size

    def _present(self) -> Iterator[tuple[int, tuple[float, float]]]:
        """Yield each axis on which halves differ, with offset and response."""
        sizes = {**self.stated, **{n: step.value for n, step in self.steps.items()}}
        for axis in DIRECTIONS:
            offset, response = (sizes.get(name, 0.0) for name in parameter_names(axis))
            if offset or response:
                yield axis, (offset, response)


def amplifier_mismatch(
    statistics: ConstantStatistics,
    splits: tuple[str, str, str],
    least: float,
    stated: Mapping[str, float],
) -> AmplifierMismatch:
    """Return how halves differ.

    splits : to train, to validate and to test by. least : nats that steps other than
    those of the profile need. stated : these, by parameter; DN of offsets."""
    gains, alike, errors = list[float](), set[str](), dict[str, float]()
    steps, tested = dict[str, Step](), dict[str, Step]()
    for axis in DIRECTIONS:
        training, validation, test, both = (
            dict(_split_lines(statistics, some, axis))
            for some in (*([split] for split in splits), splits[:2])
        )
        errors |= {name: one.step().error for name, one in validation.items()}
        total = np.zeros(3)
        own = dict[str, Array]()
        for name in (name for name in training if name in validation):
            own[name] = _gains(training[name], validation[name], stated.get(name, 0.0))
            total += own[name]
        of_both, of_steps, instead = total.tolist()
        is_alone = of_steps > least and instead > least
        gains.append(max(of_both, of_steps) if is_alone else of_both)
        if gains[-1] > least:
            steps |= {name: one.step(not is_alone) for name, one in both.items()}
            tested |= {name: one.step(not is_alone) for name, one in test.items()}
            continue
        for name, smooth in zip(parameter_names(axis), SMOOTH_NAMES, strict=True):
            _, of_steps, instead = own.get(name, np.zeros(3)).tolist()
            if of_steps > least and instead > -least:
                alike.add(smooth)
    gain = sum(one for one in gains if one > least) or max(gains)
    return AmplifierMismatch(gain, frozenset(alike), steps, tested, errors, stated)


def _gains(training: "Lines", validation: "Lines", stated: float) -> Array:
    """Return the nats, (3,), that a step gains on validation frames: over a stated one
    where what is smooth has a variance of its own; the same where that is noise; over
    such a variance, and no step."""
    found = [training.step(is_free).value for is_free in (True, False)]
    with_both, of_step = (
        validation.likelihood(*one) for one in zip(found, (True, False), strict=True)
    )
    of_smooth, of_nothing = (
        validation.likelihood(stated, is_free) for is_free in (True, False)
    )
    return np.array([with_both - of_smooth, of_step - of_nothing, of_step - of_smooth])


def parameter_names(axis: int) -> tuple[str, str]:
    """Return the names of an offset and of a response."""
    return f"{DIRECTIONS[axis]}_offset", f"{DIRECTIONS[axis]}_response"


def unit_of(parameter: str, white: float) -> float:
    """Return what one of the registry's unit is of a step: offsets are DN, shares of
    white there; responses are relative in both."""
    return white if parameter.endswith("offset") else 1.0


def unit_step(count: int) -> Array:
    """Return (n,) of lines: a step of 1 in the middle, whose mean is 0."""
    step: Array = np.where(np.arange(count) < count // 2, -0.5, 0.5)
    return step - float(step.mean())


def _light(statistics: ConstantStatistics) -> Array:
    """Return (P, G) DN of flats above the shortest darks; 0 of darks."""
    levels = np.array([plane.level for plane in statistics.planes])
    darks = np.flatnonzero(~statistics.is_flat)
    times = np.array([statistics.groups[g].exposure_time or 0.0 for g in darks])
    shortest = levels[:, darks[times == times.min(initial=np.inf)]]
    black = shortest.mean(axis=1) if len(darks) else np.zeros(len(levels))
    return np.where(statistics.is_flat, levels - black[:, None], 0.0)


@dataclass(frozen=True)
class Lines:
    """Means of lines, (n,), and how likely they are. value : their step by what no low
    polynomial follows; error : its standard error, by what such steps are elsewhere.
    noise : the variance of a line."""

    lines: Array
    value: float
    error: float
    noise: float

    @classmethod
    def of(cls, lines: Array) -> "Lines":
        count, near = len(lines), len(lines) // NEAR
        low = polynomials(count).T
        places = np.arange(near, count - near)
        steps = np.where(np.arange(count) < places[:, None], -0.5, 0.5)
        steps -= steps @ low @ low.T
        sizes = np.linalg.norm(steps, axis=1)
        middle = int(np.flatnonzero(places == count // 2)[0])
        value = float(steps[middle] @ lines) / float(sizes[middle]) ** 2
        rest = lines - value * steps[middle]
        rest -= low @ (rest @ low)
        each = (steps @ rest / sizes)[np.abs(places - count // 2) > near]
        # Of lines that are alike, and of those that are not.
        squares = np.mean(each**2), rest @ rest / (count - low.shape[1] - 1)
        noise = float(max(squares))
        return cls(lines, value, float(np.sqrt(noise) / sizes[middle]), noise)

    @cached_property
    def parts(self) -> list[tuple[Array, Array]]:
        """Coefficients of the lines and of a step, of what is smooth and of what is
        slow."""
        low = polynomials(len(self.lines))
        both = low @ self.lines, low @ unit_step(len(self.lines))
        ends = slice(1, SMOOTH + 1), slice(SMOOTH + 1, None)
        return [(both[0][part], both[1][part]) for part in ends]

    def likelihood(self, value: float, is_free: bool = True) -> float:
        """Return the log-likelihood of a step, up to a constant. Each part has a
        variance of its own, above the noise, which is not known. is_free : what is
        smooth has, too; else it is noise."""
        nats = -(((value - self.value) / self.error) ** 2) / 2
        for rest, _, variance in self._rests(value, is_free):
            nats -= (len(rest) * math.log(variance) + float(rest @ rest) / variance) / 2
        return nats

    def step(self, is_free: bool = True) -> Step:
        """Return that of most likelihood."""
        alone = [float(a @ b) / float(b @ b) for a, b in self.parts]
        ends = [self._settled(start, is_free) for start in (self.value, *alone)]
        return max(ends, key=lambda step: self.likelihood(step.value, is_free))

    def _settled(self, value: float, is_free: bool) -> Step:
        for _ in range(ROUNDS):
            known = information = 1 / self.error**2
            total = self.value * known
            for rest, of_step, variance in self._rests(value, is_free):
                more = float(of_step @ of_step) / variance
                known, total = known + more, total + more * value
                total += float(of_step @ rest) / variance
                # Of Student's law, whose tails are wider, where it is not the noise's.
                information += more * (1 - 2 / len(rest) * (variance > self.noise))
            value = total / known
        return Step(value, information**-0.5, self.lines)

    def _rests(
        self, value: float, is_free: bool
    ) -> Iterator[tuple[Array, Array, float]]:
        """Yield what a step leaves of each of parts, a step, and the variance."""
        for n, (of_lines, of_step) in enumerate(self.parts):
            rest = of_lines - value * of_step
            own = float(rest @ rest) / len(rest) if is_free or n else 0.0
            yield rest, of_step, max(own, self.noise)


def _split_lines(
    statistics: ConstantStatistics, splits: Collection[str], axis: int
) -> Iterator[tuple[str, Lines]]:
    """Yield the lines of darks, DN, and of light, relative, of splits; none of frames
    without noise."""
    lines = np.array([_lines(plane, axis) for plane in statistics.planes])
    if lines.shape[-1] < FEWEST:
        return
    own, frames = np.isin(statistics.splits, list(splits)), statistics.frames
    light = _light(statistics)
    darks = np.flatnonzero(own & ~statistics.is_flat)
    flats = np.flatnonzero(own & (light > 0).all(axis=0))
    offset, response = parameter_names(axis)
    each = {}
    dark = np.zeros(lines[:, 0].shape)
    if len(darks):
        dark = np.average(lines[:, darks], axis=1, weights=frames[darks])
        each[offset] = Lines.of(dark.mean(axis=0))
    if len(flats):
        relative = (lines[:, flats] - dark[:, None]) / light[:, flats, None]
        weights = frames[flats] * light[:, flats].mean(axis=0)
        mean = np.average(relative, axis=1, weights=weights).mean(axis=0)
        each[response] = Lines.of(mean)
    yield from ((name, one) for name, one in each.items() if one.noise > 0)


def _lines(plane: PlaneStatistics, axis: int) -> Array:
    """Return (G, n) DN, means of columns, axis 1, or of rows."""
    return plane.columns if axis else plane.rows


def _less(plane: PlaneStatistics, axis: int, sizes: Array) -> PlaneStatistics:
    """Return a plane without a step of (G,) DN."""
    before, across = _lines(plane, axis), plane.shape[1 - axis]
    lines = before - np.outer(sizes, unit_step(before.shape[1]))
    whole = plane.whole - across * (before @ before.T - lines @ lines.T)
    found = replace(plane, whole=whole)
    return replace(found, columns=lines) if axis else replace(found, rows=lines)


def _image_of(
    statistics: ConstantStatistics, axis: int, sizes: Array, number: int
) -> NDArray[np.float32]:
    """Return the mean image of a group without steps of (P, G) DN."""
    image, side = statistics.mean_of(number), statistics.side
    for site, plane in enumerate(statistics.planes):
        row, column = divmod(site, side)
        h, w = plane.shape
        own = image[row : side * h : side, column : side * w : side]
        step = sizes[site, number] * unit_step(plane.shape[axis])
        own -= np.float32(step if axis else step[:, None])
    return image
