# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a converter records of normal noise: rounded to codes, clipped at 0 and white.

Mean and variance of codes are those of the signal and 1/12 DN^2 more while noise is
above 1.2 DN. Below, they depend on where between two codes the signal lies."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import ndtr

from cg2raw.statistics.constant import Array

ROUNDING = 1 / 12  # DN^2: variance of a uniform distribution over one code
# DN^2. Above, codes change mean and variance by less than 1e-11 of a code: the first
# term of Sheppard's series, exp(-2 pi^2 variance) (W. Sheppard, 1898).
FINE = 1.5
REACH = 7  # sigma: beyond, a normal distribution has 3e-12
# Places per DN and per sigma, the fewer of both: between them moments are linear.
STEPS, STEPS_PER_SIGMA = 32, 10
LEAST_OFFSET = 1e-4  # DN^2: far below the step between two places of STEPS
LEAST_RESPONSE = 1e-3  # of codes that nearly always are 0: they say nothing
LEAST = 2.5e-3  # DN^2: with noise of 0.05 DN a sample mostly repeats its code
AROUND = 4  # times the noise by the codes, or by a fit: the table's reach to each side
NOISES = 12  # in the table
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(15)
WEIGHTS = WEIGHTS / WEIGHTS.sum()


class Moments(NamedTuple):
    """Of recorded codes, DN, DN^2 and 1: (N,) each. kurtosis : excess."""

    mean: Array
    variance: Array
    kurtosis: Array


def recorded(mean: Array, variance: float, white: int) -> Moments:
    """Return the moments of the codes of signals of the same noise.

    mean : (N,) DN, before rounding. variance : DN^2, above 0. white : DN."""
    mean, sigma = np.asarray(mean, float)[:, None], np.sqrt(variance)
    reach = int(np.ceil(REACH * sigma)) + 1
    codes = np.rint(mean) + np.arange(-reach, reach + 1)
    below = ndtr((codes + 0.5 - mean) / sigma)
    below[:, -1] = 1.0
    share = np.diff(below, axis=1, prepend=0.0)
    codes = np.clip(codes, 0, white)
    first = (share * codes).sum(axis=1)
    rest = codes - first[:, None]
    second = np.maximum((share * rest**2).sum(axis=1), 1e-12)
    fourth = (share * rest**4).sum(axis=1)
    return Moments(first, second, fourth / second**2 - 3)


class Recording(NamedTuple):
    """What a group's codes say of it.

    place : DN, the mean of the signal. variance : DN^2, of a code between frames, but
    for the offsets of lines. lines : by how much lines that are new in every frame are
    recorded, rms. fixed : by how much the mean code moves with the signal. steps :
    DN^2, variance of the mean codes of pixels beyond fixed^2 times that of their
    offsets."""

    place: float
    variance: float
    lines: float
    fixed: float
    steps: float


class Offsets(NamedTuple):
    """Variances of what is added to each place of a group, all normal, DN^2.

    noise : of a pixel. lines : of rows and columns, new in each frame like it. fixed :
    of pixels, the same in all frames."""

    noise: float
    lines: float
    fixed: float


@dataclass(frozen=True)
class Recorder:
    """A group of frames whose mean code is known: where its signal lies follows.

    level : DN, of the codes. about : offsets for which the table is exact, of noise
    within AROUND; near them it is linear. table : of (Recording, slopes by lines,
    slopes by fixed), (15,), by the logarithm of the noise's variance; None where codes
    are fine in any case."""

    level: float
    about: Offsets
    table: CubicSpline | None

    def __call__(self, offsets: Offsets) -> tuple[Array, Array]:
        """Return a Recording, (5,), and its slopes by the offsets, (5, 3)."""
        noise = offsets.noise
        if self.table is None:
            found = np.array([self.level, noise + ROUNDING, 1.0, 1.0, 0.0])
            return found, np.eye(5, 3, -1) * [1.0, 0.0, 0.0]
        at = np.clip(np.log(noise), *self.table.x[[0, -1]])
        known, slopes = (self.table(at, n).reshape(3, 5) for n in (0, 1))
        lines, fixed = (
            offsets.lines - self.about.lines,
            offsets.fixed - self.about.fixed,
        )
        moved = np.array([1.0, lines, fixed])
        by_noise = moved @ slopes / noise * (at == np.log(noise))
        return moved @ known, np.column_stack([by_noise, known[1], known[2]])


def recorder_of(
    level: float,
    places: Array,
    about: Offsets,
    noise: float,
    white: int,
    inside: bool,
) -> Recorder:
    """Return the Recorder of a group.

    level : DN, mean of its codes. places : (frames, N) DN, mean codes at places of each
    frame to that, all alike probable. noise : DN^2, of its codes. inside : none is
    clipped."""
    if inside and noise > FINE + ROUNDING:
        return Recorder(level, about, None)

    def at(offsets: Offsets) -> Array:
        return np.array(_recording(level + places, offsets, white, inside))

    table = []
    middle = max(about.noise, LEAST)
    variances = np.geomspace(middle / AROUND, middle * AROUND, NOISES)
    for variance in variances:
        one = about._replace(noise=float(variance))
        known = [at(one)]
        for name, value in (("lines", about.lines), ("fixed", about.fixed)):
            step = 0.1 * value + LEAST_OFFSET
            more = at(one._replace(**{name: value + step}))
            known.append((more - known[0]) / step)
        table.append(np.concatenate(known))
    return Recorder(level, about, CubicSpline(np.log(variances), table))


def _recording(codes: Array, offsets: Offsets, white: int, inside: bool) -> Recording:
    """Return what is recorded where the mean codes are @codes, (frames, N) DN.

    inside : far from 0 and white, where one code is like the next."""
    steps = min(STEPS, STEPS_PER_SIGMA / np.sqrt(offsets.noise))
    if inside:
        low, high, whole = 0, 1, np.floor(codes)
        grid = np.linspace(0, 1, STEPS + 1)
        moments = recorded(grid + 100, offsets.noise, 200)
        errors = moments.mean - 100 - grid
    else:
        most = REACH * np.sqrt(sum(offsets)) + 1
        low, high = int(codes.min() - 2 * most) - 1, int(codes.max() + most) + 1
        grid, whole = np.linspace(low, high, int((high - low) * steps) + 2), 0 * codes
        moments = recorded(grid, offsets.noise, white)
        errors = moments.mean - grid

    def smeared(values: Array, square: float) -> tuple[Array, Array, Array]:
        """Return mean, slope and variance beyond slope^2 @square over normal offsets of
        variance @square."""
        square = max(square, LEAST_OFFSET)
        at = grid[:, None] + NODES * np.sqrt(square)
        at = at % 1 if inside else at
        each = np.interp(at, grid, values)
        mean = each @ WEIGHTS
        slope = each @ (WEIGHTS * NODES) / np.sqrt(square)
        rest = each**2 @ WEIGHTS - mean**2 - slope**2 * square
        return mean, slope, np.maximum(rest, 0.0)

    errors, _, steps_of_lines = smeared(errors, offsets.lines)
    noise, _, _ = smeared(moments.variance, offsets.lines)
    noise, _, _ = smeared(noise + steps_of_lines, offsets.fixed)
    errors, slope, jumps = smeared(errors, offsets.fixed)
    # The mean code rises with the place.
    places = np.interp(codes - whole, grid + errors, grid)
    noise, slope, jumps = (
        np.interp(places, grid, values) for values in (noise, 1 + slope, jumps)
    )
    fixed = slope.mean(axis=0)  # of the mean of all frames
    return Recording(
        float((whole + places).mean()),
        float(noise.mean()),
        float(np.sqrt((slope.mean(axis=1) ** 2).mean())),
        max(float(fixed.mean()), LEAST_RESPONSE),
        float(jumps.mean() + fixed.var() * offsets.fixed),
    )
