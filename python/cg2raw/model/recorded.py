# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a converter records of normal noise: rounded to codes, clipped at 0 and white.

Mean and variance of codes are those of the signal and 1/12 DN^2 more while noise is
above 0.7 DN. Below, they depend on where between two codes the signal lies."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.interpolate import CubicSpline
from scipy.special import ndtr

from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import PLACES, Array

# DN^2. Above, where a signal lies changes the variance of its codes by less than 1e-4,
# which takes a hundred million samples to see: 4 exp(-2 pi^2 variance), the first term
# of Sheppard's series (W. Sheppard, 1898).
FINE = 0.54
FEW_CODES = 1.5  # DN^2. Below, the law of single draws is that of their codes
SMOOTH = 30.0**2  # DN^2. Above, rounding is less than 1e-4 of the variance of codes
FAR = 100  # codes from 0 and white, where these are not felt
REACH = 7  # sigma: beyond, a normal distribution has 3e-12
# Places per DN and per sigma, the fewer of both: between them moments are linear.
STEPS, STEPS_PER_SIGMA = 128, 32
NARROW = 0.05  # DN: places that differ by less are one within a code
LEAST_OFFSET = 1e-4  # DN^2: far below the step between two places of STEPS
LEAST_RESPONSE = 1e-3  # of codes that nearly always are 0: they say nothing
LEAST = 2.5e-3  # DN^2: with noise of 0.05 DN a sample mostly repeats its code
ROUNDS = 6  # of where frames and places are, in turn
SETTLED = 1e-6  # DN
SAME = 0.01  # relative, of offsets for which a table stays as it is
AROUND = 4  # times the noise by the codes, or by a fit: the table's reach to each side
NOISES = 7  # in the table
FINELY = 200  # places in the table, of which one is looked up
SLOPES = 3  # of each how many of them slopes by other offsets are taken
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(15)
WEIGHTS = WEIGHTS / WEIGHTS.sum()


def recorded(mean: Array, variance: float, white: int) -> tuple[Array, Array]:
    """Return mean, DN, and variance, DN^2, of the codes of signals of the same noise.

    mean : (N,) DN, before rounding. variance : DN^2, above 0. white : DN."""
    return _moments(*_law(mean, variance), white)


def _law(mean: Array, variance: float) -> tuple[Array, Array]:
    """Return (N, codes) the codes that signals may have, and how probable each is."""
    mean, sigma = np.asarray(mean, float)[:, None], np.sqrt(variance)
    reach = int(np.ceil(REACH * sigma)) + 1
    codes: Array = np.rint(mean) + np.arange(-reach, reach + 1)
    below = ndtr((codes + 0.5 - mean) / sigma)
    below[:, -1] = 1.0
    share: Array = np.diff(below, axis=1, prepend=0.0)
    return codes, share


def _moments(codes: Array, share: Array, white: int) -> tuple[Array, Array]:
    """Return mean and variance, (...,), of codes that end at 0 and white."""
    codes = np.clip(codes, 0, white)
    first: Array = (share * codes).sum(axis=-1)
    rest = codes - first[..., None]
    return first, np.maximum((share * rest**2).sum(axis=-1), 1e-12)


def _clipped(mean: Array, sigma: float, white: int) -> tuple[Array, Array]:
    """Return mean and variance, as of recorded, of normal signals that end at 0 and
    white. Source: N. Johnson, S. Kotz, N. Balakrishnan, Continuous Univariate
    Distributions 1, 1994, 13.10.1 (truncated normal)."""
    low, high = -mean / sigma, (white - mean) / sigma
    dense = [np.exp(-(end**2) / 2) / math.sqrt(2 * math.pi) for end in (low, high)]
    inside, above = ndtr(high) - ndtr(low), ndtr(-high)
    first = white * above + mean * inside + sigma * (dense[0] - dense[1])
    square = white**2 * above + (mean**2 + sigma**2) * inside
    square += sigma * (mean * dense[0] - (mean + white) * dense[1])
    return first, np.maximum(square - first**2, 1e-12)


def _with_ends(
    whole: NDArray[np.int64], steps: int, variance: float, white: int
) -> tuple[Array, Array]:
    """Return what recorded does of a grid of signals: whole codes, (n,), and so many
    steps from each to the next DN, but for the last. What is far from 0 and white is of
    each code as of the next, and has the moments of fine codes where noise is not below
    FINE."""
    part = np.arange(steps) / steps
    mean, of_codes = part, np.full(steps, variance + ROUNDING)
    if variance <= SMOOTH:
        codes, share = _law(part, variance)
    if variance <= FINE:
        mean, of_codes = _moments(codes + FAR, share, 2 * FAR)
        mean = mean - FAR
    mean, of_codes = whole[:, None] + mean, np.tile(of_codes, (len(whole), 1))
    reach = REACH * np.sqrt(variance) + 2
    near = (whole < reach) | (whole > white - reach)
    if variance > SMOOTH:
        ends = _clipped(whole[near][:, None] + part, np.sqrt(variance), white)
    else:
        ends = _moments(whole[near][:, None, None] + codes, share, white)
    mean[near], of_codes[near] = ends
    count = (len(whole) - 1) * steps + 1
    return mean.ravel()[:count], of_codes.ravel()[:count]


def differences(
    places: Array, variance: float, wider: float = 0.0, ratio: float = 1.0
) -> Array:
    """Return (N, D) how probable it is that two codes of the same signal differ by 0,
    1, ... codes in size.

    places : (N,) DN, of the signal. variance : DN^2, of its noise. wider : a share of
    it, whose variance is @ratio times as large."""
    sigmas = np.sqrt(variance * np.array([1.0, ratio]))
    reach = int(np.ceil(REACH * sigmas.max())) + 1
    edges = np.arange(-reach, reach + 2) - 0.5 - np.asarray(places)[:, None]
    narrow, wide = (np.diff(ndtr(edges / sigma)) for sigma in sigmas)
    share = (1 - wider) * narrow + wider * wide
    size = 2 * share.shape[1]
    spectrum = np.abs(np.fft.rfft(share, size, axis=1)) ** 2
    found: Array = np.maximum(np.fft.irfft(spectrum, size, axis=1), 0.0)
    found = found[:, : share.shape[1]]
    found[:, 1:] *= 2
    return found


Number = TypeVar("Number", float, Array)


class Recording(NamedTuple, Generic[Number]):
    """What a group's codes say of it, or those of several, (G,) or more each.

    place : DN, the mean of the signal. variance : DN^2, of a code between frames, but
    for the offsets of lines. fixed : by how much the mean code moves with the signal.
    steps : DN^2, variance of the mean codes of pixels beyond fixed^2 times that of
    their offsets and what variance makes. fading : variance of fixed from frame to
    frame. Others, by how much is recorded, rms: places : what places differ by. rows,
    columns : offsets of lines that are new in every frame. across, down : noise that
    neighbours in a row, or in a column, have in common. in_rows, in_columns : by how
    much more neighbours in a line record its offset together than all of it, squared.
    """

    place: Number
    variance: Number
    fixed: Number
    steps: Number
    fading: Number
    places: Number
    rows: Number
    columns: Number
    across: Number
    down: Number
    in_rows: Number
    in_columns: Number


class Records(NamedTuple):
    """Recordings, (G,) each, and their slopes by parameters, (G, n)."""

    values: Recording[Array]
    slopes: Recording[Array]


def joined(each: Sequence[Records]) -> Records:
    """Return the records of planes one after another."""
    values, slopes = (
        Recording(*(np.concatenate(some) for some in zip(*of, strict=True)))
        for of in zip(*each, strict=True)
    )
    return Records(values, slopes)


def fine_records(levels: Array, noise: Array, by_noise: Array) -> Records:
    """Return those of fine codes, of (G,) levels and noise, DN and DN^2, and of the
    slopes of the noise, (G, n)."""
    values = Recording(*(np.full(len(levels), one) for one in FINE_CODES))
    slopes = Recording(*np.zeros((len(values), *by_noise.shape)))
    return Records(
        values._replace(place=levels.copy(), variance=noise + ROUNDING),
        slopes._replace(variance=by_noise),
    )


FINE_CODES = Recording(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0)


class Profiles(NamedTuple):
    """DN, by how much lines of a mean image are above its mean: of all rows, (h,), and
    of all columns, (w,)."""

    rows: Array
    columns: Array


class Offsets(NamedTuple):
    """Variances of what is added to each place of a group, all normal, DN^2.

    noise : of a pixel. lines : of rows and columns, new in each frame like it. fixed :
    of pixels, the same in all frames. charged : DN, by how much noise grows with a
    pixel's fixed offset: that of its charge has a shot noise."""

    noise: float
    lines: float
    fixed: float
    charged: float = 0.0


@dataclass(frozen=True)
class Recorder:
    """A group of frames whose mean code is known: where its signal lies follows.

    about : offsets for which the table is exact, of noise within AROUND; near them it
    is linear. table : of (Recording, slopes by lines, slopes by fixed), (3, 12), by the
    logarithm of the noise's variance; None where codes are fine in any case. by_lines :
    DN^4, variance of the variance of codes from line to line, by where their offsets
    put them."""

    about: Offsets
    table: CubicSpline | None
    by_lines: float = 0.0

    def holds_at(self, offsets: Offsets) -> bool:
        """Whether a table about these offsets would be the same but for second orders
        of SAME."""
        if self.table is None:
            return False
        moved = np.abs(np.subtract(offsets, self.about))
        return bool((moved <= SAME * np.array(self.about) + SAME * LEAST_OFFSET).all())

    def unrounded(self, variance: float) -> float:
        """Return the noise whose codes have a variance, DN^2, within the table."""
        if self.table is None:
            return variance - ROUNDING
        at = np.linspace(self.table.x[0], self.table.x[-1], FINELY)
        place = Recording._fields.index("variance")
        return float(np.interp(variance, self.table(at)[:, 0, place], np.exp(at)))

    def __call__(self, offsets: Offsets) -> tuple[Array, Array]:
        """Return a Recording, (12,), and its slopes by the offsets, (12, 3), of codes
        that are not fine."""
        assert self.table is not None
        noise = offsets.noise
        at = np.clip(np.log(noise), *self.table.x[[0, -1]])
        known, slopes = self.table(at), self.table(at, 1)
        lines, fixed = (
            offsets.lines - self.about.lines,
            offsets.fixed - self.about.fixed,
        )
        moved = np.array([1.0, lines, fixed])
        by_noise = moved @ slopes / noise * (at == np.log(noise))
        return moved @ known, np.column_stack([by_noise, known[1], known[2]])


def recorder_of(
    levels: Array,
    places: Array,
    profiles: Profiles,
    about: Offsets,
    noise: float,
    white: int,
    cut: bool,
) -> Recorder:
    """Return the Recorder of a group.

    levels : (frames,) DN, of each frame's codes. places : (N,) DN, what the mean codes
    of places, all alike probable, differ from the mean level. noise : DN^2, of codes.
    cut : some samples are at 0 or at white; hot or dead ones may be, which no law of
    the others is of."""
    frames = len(levels)
    if np.ptp(places) <= NARROW:
        places = np.zeros(1)
    if np.ptp(levels) <= NARROW:
        levels = levels.mean(keepdims=True)
    reach = REACH * np.sqrt(noise + about.lines + about.fixed) + 1
    low = levels.min() + places.min() - reach
    inside = not cut or (low > 0 and levels.max() + places.max() + reach < white)
    if inside and noise > FINE + ROUNDING:
        return Recorder(about, None)
    image = _Image(
        levels,
        places,
        frames,
        tuple(
            np.quantile(one, PLACES) if np.ptp(one) > NARROW else np.zeros(1)
            for one in profiles
        ),
        tuple(float((np.diff(one) ** 2).sum() / 2 / len(one)) for one in profiles),
    )
    steps = [0.1 * value + LEAST_OFFSET for value in (about.lines, about.fixed)]
    known, slopes, by_lines = list[Array](), list[Array](), 0.0
    middle = max(about.noise, LEAST)
    variances = np.geomspace(middle / AROUND, middle * AROUND, NOISES)
    for number, variance in enumerate(variances):
        one = about._replace(noise=float(variance))
        ends = one._replace(lines=one.lines + steps[0], fixed=one.fixed + steps[1])
        law = _Codes(np.add.outer(levels, places), ends, white, inside)
        found, of_lines = _recording(law, image, one)
        if number == NOISES // 2:
            by_lines = of_lines
        known.append(np.array(found))
        if number % SLOPES == 0:
            each = one._replace(lines=ends.lines), one._replace(fixed=ends.fixed)
            moved = [np.array(_recording(law, image, more)[0]) for more in each]
            slopes.append((np.array(moved) - known[-1]) / np.array(steps)[:, None])
    at = np.log(variances)
    every = CubicSpline(at[::SLOPES], slopes)(at)  # (NOISES, 2, 12)
    table = np.concatenate([np.array(known)[:, None], every], axis=1)
    return Recorder(about, CubicSpline(at, table), by_lines)


class _Image(NamedTuple):
    """levels, places : as of recorder_of. frames : how many. profiles : quantiles of
    rows and of columns, DN. steps : DN^2, what next rows, and columns, do not have in
    common."""

    levels: Array
    places: Array
    frames: int
    profiles: tuple[Array, ...]
    steps: tuple[float, ...]


def shrunk(places: Array, chance: float) -> float:
    """Return what to multiply places by that have a variance by chance, DN^2."""
    return float(np.sqrt(max(1 - chance / max(float(places.var()), 1e-12), 0.0)))


class _Codes:
    """Mean code and its variance at signals, by a grid of them: one period of a code
    far from 0 and white, where one is like the next, or all that samples reach."""

    def __init__(
        self, codes: Array, offsets: Offsets, white: int, inside: bool
    ) -> None:
        """codes : DN, that are recorded. offsets : as of _recording."""
        self.inside, noise = inside, offsets.noise
        if inside:
            self.grid = np.linspace(0, 1, STEPS + 1)
            far, self.variance = recorded(self.grid + FAR, noise, 2 * FAR)
            self.mean = far - FAR
            self.room = np.linspace(-1, 2, 3 * STEPS // 4 + 1)
        else:
            most = REACH * np.sqrt(noise + offsets.lines + offsets.fixed) + 1
            low, high = int(codes.min() - 2 * most) - 1, int(codes.max() + 2 * most) + 1
            power = math.ceil(np.log2(STEPS_PER_SIGMA / np.sqrt(noise)))
            steps, apart = min(STEPS, 2 ** max(power, 0)), 2 ** max(-power, 0)
            count = fft.next_fast_len(-(-(high - low) // apart), real=True)
            whole = low + apart * np.arange(count + 1)
            self.grid = np.linspace(low, whole[-1], count * steps + 1)
            self.mean, self.variance = _with_ends(whole, steps, noise, white)
            self.room = self.grid[::4]

    def of(self, values: Array, at: Array) -> Array:
        """Return what has values on the grid, by linear interpolation."""
        found: Array = np.interp(at % 1 if self.inside else at, self.grid, values)
        return found

    def mean_of(self, mean: Array, at: Array) -> Array:
        """Return mean codes at signals. mean : on the grid."""
        if not self.inside:
            return self.of(mean, at)
        return at + self.of(mean - self.grid, at)

    def smoothed(self, values: Array, variance: float) -> Array:
        """Return what is expected of values, (..., grid), where a normal offset adds to
        the signal; beyond the grid's ends is the next code, or what is before them."""
        count, step = len(self.grid) - 1, self.grid[1] - self.grid[0]
        waves = np.arange(count + 1) / (2 * count * step)
        if not self.inside:
            left = np.exp(-2 * np.pi**2 * variance * waves**2)
            return np.asarray(fft.idct(fft.dct(values, type=1) * left, type=1))
        left = np.exp(-2 * np.pi**2 * variance * waves[::2] ** 2)
        found = np.fft.irfft(np.fft.rfft(values[..., :-1]) * left, count)
        return np.concatenate([found, found[..., :1]], axis=-1)

    def slope(self, values: Array) -> Array:
        """Return how values, (..., grid), move with the signal."""
        found, step = np.empty_like(values), self.grid[1] - self.grid[0]
        found[..., 1:-1] = (values[..., 2:] - values[..., :-2]) / (2 * step)
        found[..., [0, -1]] = (values[..., [1, -1]] - values[..., [0, -2]]) / step
        return found

    def signals(self, mean: Array, codes: Array, shifts: Array) -> Array:
        """Return the (N,) signals where the mean code over shifts is @codes: it rises
        with the signal."""
        room = self.room if self.inside else self.room - shifts.mean()
        # Where in a code a signal lies is the same a whole number of codes farther on.
        far = np.rint(shifts.mean()) * self.inside
        near = self.mean_of(mean, room[:, None] + (shifts - far))
        wanted = codes - far
        whole = np.floor(wanted) * self.inside
        found: Array = whole + np.interp(wanted - whole, near.mean(axis=1), room)
        return found


def _recording(
    law: _Codes, image: _Image, offsets: Offsets
) -> tuple[Recording[float], float]:
    """Return what is recorded of the frames of a mean image, and by_lines. law : of
    codes of the offsets' noise.

    The signal of a sample is that of its place and of its frame, and the offsets of its
    lines and pixel; what it records beyond the sum of what each has alone is of the
    pixel."""
    levels, places, frames = image.levels, image.places, image.frames
    # Places have what lines of all frames have in common; the rest is new in each.
    again = 1 / frames if len(places) > 1 else 0.0
    square = offsets.lines * (1 - again) + LEAST_OFFSET
    fixed = offsets.fixed + LEAST_OFFSET
    # With the offsets of lines, on the grid.
    line, of_noise = law.grid * law.inside, law.slope(law.mean)
    mean, variance, by_noise = law.smoothed(
        np.array([law.mean - line, law.variance, of_noise**2]), square
    )
    mean, of_lines = mean + line, law.slope(mean + line)
    # By a pixel's own noise: normal laws obey the equation of heat, d/dvariance of what
    # is expected of codes, or of their squares, is half its curvature.
    # Where codes end within reach, fits that have it stop short: it is left out there.
    charged = offsets.charged * law.inside
    bent = law.slope(of_lines) / 2
    wider = law.slope(law.slope(variance)) / 2 + by_noise
    # With the offsets of pixels, too; what is in proportion to these goes by the slope.
    codes, more, of_line = law.smoothed(
        np.array([[mean - line, variance], [bent, wider], [of_lines, of_lines**2]]),
        fixed,
    )
    with_pixels, noises = codes + charged * fixed * law.slope(more)
    with_pixels = with_pixels + line
    # Where frames and places are.
    drift, place = np.zeros(len(levels)), np.zeros(len(places))
    for _ in range(ROUNDS if len(levels) > 1 else 1):
        before = drift
        place = law.signals(with_pixels, levels.mean() + places, drift)
        drift = law.signals(with_pixels, levels, place)
        drift -= drift.mean()
        if np.abs(drift - before).max() < SETTLED:
            break
    places_of_frames = np.add.outer(drift, place)
    # Of a line, on average all along it; the rest is of its pixels.
    codes = levels.mean() + np.add.outer(*image.profiles)
    signals = law.signals(with_pixels, codes.ravel(), drift).reshape(codes.shape)
    along = law.of(of_line[0], np.add.outer(drift, signals))
    lines = [float((along.mean(axis=n) ** 2).mean()) for n in (2, 1)]
    square_of_lines = law.of(of_line[1], places_of_frames).mean()
    noise = float(law.of(noises, places_of_frames).mean())
    noise += offsets.lines * float(square_of_lines - np.mean(lines))
    # Of neighbours in a row, and in a column, by the fixed offsets of each.
    pairs = []
    for apart in image.steps[::-1]:
        near = place.mean() + (place - place.mean()) * shrunk(place, apart)
        both = law.smoothed(np.array([of_noise, of_lines]), fixed + apart) ** 2
        both[0] = law.smoothed(both[0], square)
        at = np.add.outer(drift, near)
        # Where codes record hardly anything, a transform may ring below 0.
        pairs.append([max(float(law.of(one, at).mean()), 0.0) for one in both])
    (across, in_rows), (down, in_columns) = pairs
    rows, columns = lines
    # Of pixels, from frame to frame beyond what their place does.
    at = places_of_frames[:, :, None] + NODES * np.sqrt(fixed)
    each = law.mean_of(mean, at)  # (F, N, nodes)
    if charged:
        each += charged * NODES * np.sqrt(fixed) * law.of(bent, at)
    rest = each - (each @ WEIGHTS)[:, :, None]
    rest -= rest.mean(axis=0)
    moved = float(((rest**2) @ WEIGHTS).mean(axis=1).sum()) / max(len(levels) - 1, 1)
    by_frames = (each @ (WEIGHTS * NODES)).mean(axis=1) / np.sqrt(fixed)
    pattern = each.mean(axis=0)
    response = pattern @ (WEIGHTS * NODES) / np.sqrt(fixed)
    jumps = pattern**2 @ WEIGHTS - (pattern @ WEIGHTS) ** 2 - response**2 * fixed
    steps = float(jumps.mean() + response.var() * fixed) - moved / frames
    slope = max(float(response.mean()), LEAST_RESPONSE)
    spread = max(float(places.std() / place.std()), LEAST_RESPONSE) if again else slope
    found = Recording(
        float(place.mean()),
        noise + moved,
        slope,
        steps,
        float(by_frames.var(ddof=1)) if len(levels) > 1 else 0.0,
        spread,
        math.sqrt(rows),
        math.sqrt(columns),
        math.sqrt(across),
        math.sqrt(down),
        in_rows - rows,
        in_columns - columns,
    )
    at = place[:, None] + NODES * np.sqrt(square)
    by_lines = law.of(law.variance, at).mean(axis=0)
    return found, float(by_lines**2 @ WEIGHTS - (by_lines @ WEIGHTS) ** 2)
