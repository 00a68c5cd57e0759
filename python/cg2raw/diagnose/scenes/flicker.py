# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Mains flicker: a wave of light down the rows, of another phase in every frame.

It is in what lit frames that repeat each other differ by, where nothing else of light
is. A wave of even phase is nearly a normal number for its cosine and one for its sine;
both are integrated out, so that amplitude and period are all that is fitted."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import helmert
from scipy.optimize import minimize
from scipy.special import chdtri

from cg2raw.diagnose.captures.capture import Capture
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.diagnosis import Series
from cg2raw.diagnose.scenes.gram import Array
from cg2raw.diagnose.scenes.point import Point
from cg2raw.diagnose.scenes.predict import offset_variances
from cg2raw.diagnose.scenes.view import View
from cg2raw.model.flicker import PADDED, SHORTEST
from cg2raw.normal import ABOVE95
from cg2raw.statistics.constant import SMOOTH, polynomials

AMPLITUDES = np.geomspace(1e-4, 0.5, 40)  # relative to light, that are begun with
AT_ONCE = 256  # frequencies, for the sake of memory
MOST_POINTS = 200  # points of a chart
RELATIVE_STEP = 1e-3  # of a value, of which the curvature is taken


@dataclass(frozen=True)
class Waves:
    """What frames say of light of their rows, relative to that which is predicted, by
    F differences of repeats that have the noise, and the waves, of one frame.

    score : (F, H), sums over rows. information : (F, H)."""

    score: Array
    information: Array

    @property
    def frequencies(self) -> Array:
        """(K,) turns a row, of one wave in the frame to the shortest."""
        count = PADDED * self.score.shape[1]
        found: Array = np.arange(PADDED, count / SHORTEST + 1) / count
        return found

    def at(self, frequencies: Array) -> tuple[Array, Array]:
        """Return score (F, K, 2) and information (F, K, 2, 2) of both phases,
        without what is smooth down the frame. frequencies : (K,)."""
        if len(frequencies) > AT_ONCE:
            parts = np.array_split(frequencies, len(frequencies) // AT_ONCE + 1)
            first, second = zip(*map(self.at, parts), strict=True)
            return np.concatenate(first, axis=1), np.concatenate(second, axis=1)
        seen = np.flatnonzero(self.information.any(axis=0))
        lines, known = self.score[:, seen], self.information[:, seen]
        smooth = polynomials(self.score.shape[1])[: SMOOTH + 1, seen]
        turns = np.exp(2j * np.pi * np.outer(seen, frequencies))
        twice, even = known @ turns**2, known.sum(axis=1)[:, None]
        own = [[even + twice.real, twice.imag], [twice.imag, even - twice.real]]
        along = known[:, None] * smooth
        cross = _phases(along @ turns).transpose(0, 2, 3, 1)
        inner = np.linalg.pinv(along @ smooth.T, hermitian=True)
        taken = cross @ inner[:, None]
        rest = (lines @ smooth.T)[:, None, :, None]
        score = _phases(lines @ turns) - (taken @ rest)[..., 0]
        information = np.moveaxis(np.array(own) / 2, (0, 1), (2, 3))
        return score, information - taken @ cross.swapaxes(2, 3)

    @cached_property
    def each(self) -> tuple[Array, Array]:
        """Those of all frequencies."""
        return self.at(self.frequencies)

    @cached_property
    def unevenness(self) -> float:
        """By how much rows differ at most frequencies, over what their pixels'
        noise makes: rows have more of their own than a profile says."""
        score, information = self.each
        solved = np.linalg.pinv(information, hermitian=True) @ score[..., None]
        squares = (score * solved[..., 0]).sum(axis=(0, 2))
        return max(float(np.median(squares) / chdtri(2 * len(score), 0.5)), 1.0)

    def fitted(self, factor: float) -> Array:
        """Return (amplitude, period) of most evidence. factor : of noise."""
        count = PADDED * self.score.shape[1]
        parts = [one / factor for one in self.each]
        every = np.array([evidence(parts[0], parts[1], one) for one in AMPLITUDES])
        a, k = np.unravel_index(every.argmax(), every.shape)

        def cost(numbers: Array) -> float:
            return -self.nats(np.exp(numbers[0]), count / numbers[1], factor)

        start = np.log(AMPLITUDES[a]), self.frequencies[k] * count
        found = minimize(cost, start, method="Nelder-Mead").x
        return np.array([np.exp(found[0]), count / found[1]])

    def errors(self, values: Array, factor: float) -> Array:
        """Return standard errors of (amplitude, period), by the curvature."""
        found = []
        for k in range(2):
            low, high = (
                values * (1 + sign * RELATIVE_STEP * (np.arange(2) == k))
                for sign in (-1, 1)
            )
            left, middle, right = (
                self.nats(one[0], one[1], factor) for one in (low, values, high)
            )
            bent = 2 * middle - left - right
            found.append(RELATIVE_STEP * values[k] / np.sqrt(max(bent, 1e-300)))
        return np.array(found)

    def smallest(self, least: float) -> float:
        """Return the amplitude of waves that gain as much, nats, in 95 of 100 sets;
        infinite where none does. Two waves of chance phases differ by a wave whose
        square is 1 - cos(phase) of what it is on average."""
        _, information = self.each
        known = np.trace(information, axis1=2, axis2=3) / 2
        for amplitude in AMPLITUDES:
            more = amplitude**2 / 2 * known
            mean = (more - np.log1p(more)).sum(axis=0)
            spread = (more / (1 + more)) ** 2 * (1 + 2 * more + more**2 / 2)
            low = mean - ABOVE95 * np.sqrt(spread.sum(axis=0))
            if np.median(low) > least + 1:
                return float(amplitude)
        return np.inf

    def nats(self, amplitude: float, period: float, factor: float = 1.0) -> float:
        """Return what waves gain, each of its own phase. factor : of noise."""
        score, information = self.at(np.array([1 / period]))
        return float(evidence(score / factor, information / factor, amplitude)[0])


def _phases(turned: Array) -> Array:
    """Return (..., 2), the parts of complex numbers."""
    return np.stack([turned.real, turned.imag], axis=-1)


def evidence(score: Array, information: Array, amplitude: float) -> Array:
    """Return the nats (K,) that waves of an amplitude gain, of a score and
    information as of Waves.at."""
    variance = amplitude**2 / 2
    inner = np.eye(2) + variance * information
    solved = np.linalg.solve(inner, score[..., None])[..., 0]
    squares = variance * (score * solved).sum(axis=2)
    found: Array = (squares - np.log(np.linalg.det(inner))).sum(axis=0) / 2
    return found


def validation_gain(training: Waves, validation: Waves) -> float:
    """Return what validation frames gain by the flicker that training frames have."""
    factor = max(training.unevenness, validation.unevenness)
    amplitude, period = training.fitted(factor)
    return validation.nats(amplitude, period, factor)


def measured(waves: Waves) -> tuple[Array, Array]:
    """Return (amplitude relative to light, period in rows) and their standard errors:
    of chance phases, so that an amplitude is known to 1 / (4 F)^0.5 of it at best."""
    values = waves.fitted(waves.unevenness)
    return values, waves.errors(values, waves.unevenness)


def chart_series(waves: Waves, values: Array) -> Series:
    """Return the light of rows, %, in the difference of frames that shows most of a
    flicker of (amplitude, period), without what is smooth."""
    score, information = (one[:, 0] for one in waves.at(np.array([1 / values[1]])))
    best = int((score**2).sum(axis=1).argmax())
    inner = information[best] + 2 / values[0] ** 2 * np.eye(2)
    phases = np.linalg.solve(inner, score[best])
    known, rows = waves.information[best], np.arange(waves.score.shape[1])
    seen = np.flatnonzero(known > 0)
    turns = 2 * np.pi * rows / values[1]
    wave = phases @ np.stack([np.cos(turns), np.sin(turns)])
    smooth = polynomials(len(rows))[: SMOOTH + 1, seen]
    away = (waves.score[best] / np.maximum(known, 1e-300))[seen]
    along = smooth * known[seen]
    low = np.linalg.lstsq(along @ smooth.T, along @ (away - wave[seen]))[0]
    away = away - smooth.T @ low
    bins = np.array_split(np.arange(len(seen)), min(MOST_POINTS, len(seen)))
    x, measured, after = (
        np.array([one[bin].mean() for bin in bins])
        for one in (rows[seen], 100 * away, 100 * wave[seen])
    )
    return Series("", x, measured, np.zeros_like(x), after)


def is_shown(captures: Iterable[Capture]) -> bool:
    """Return whether flicker can be told by images: those that fit, and those that
    select, have lit frames of pixels that repeat."""
    sets: Counter[tuple[str, object]] = Counter()
    for one in captures:
        if one.has_known_light and one.shows.light and one.means is None:
            sets[one.group, (one.set, one.kind, one.iso, one.exposure_time)] += 1
    repeated = {group for (group, _), count in sets.items() if count > 1}
    return {*GROUPS[:2]} <= repeated


def row_waves(points: Sequence[Point], means: bool = False) -> Waves | None:
    """Return what the frames of views say; None without lit ones that repeat, or whose
    rows are fewer than a wave.

    means : theirs as well, of which all is known but flicker."""
    found = [
        one for point in points if shows(point.view) for one in _rows(point, means)
    ]
    if not found:
        return None
    waves = Waves(*map(np.array, zip(*found, strict=True)))
    return waves if waves.frequencies.size else None


def shows(view: View) -> bool:
    """Return whether a view has repeats that flicker would be in."""
    return view.n > 1 and not view.is_table and view.frame.capture.shows.light


def _rows(point: Point, means: bool) -> Iterator[tuple[Array, Array]]:
    """Yield (score, information) of each difference of a view's frames."""
    n, count, used = point.view.n, point.frame.tiles.shape[0], point.root > 0
    rows, _ = point.frame.tiles.rows_and_columns()
    labels = np.broadcast_to(rows, used.shape)[used]
    light = np.maximum(point.base, 0)[used]
    own = offset_variances(point.frame).get("row_noise", 0.0)
    signals = np.array([frame.signal for frame in point.view.frames])
    differences = np.tensordot(helmert(n), signals, 1)
    each = [(one, point.frame_variance) for one in differences]
    if means and not point.view.is_chart:
        each.append((np.sqrt(n) * (point.view.signal - point.mean), n * point.variance))
    for away, variance in each:
        rest, weight = away[used], 1 / np.broadcast_to(variance, used.shape)[used]
        along = light * weight
        score, information = (
            np.bincount(labels, along * one, count) for one in (rest, light)
        )
        if own:  # offsets of rows, integrated out
            offset, cross, precision = (
                np.bincount(labels, one, count)
                for one in (rest * weight, along, weight)
            )
            score -= cross * offset / (precision + 1 / own)
            information -= cross**2 / (precision + 1 / own)
        yield score, information
