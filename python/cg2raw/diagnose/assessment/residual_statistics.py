# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Residual statistics: sufficient sums of what residual tests ask."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.likelihood.censoring import DRAWN_ABOVE
from cg2raw.diagnose.likelihood.likelihood import Likelihood, log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import pattern_variances

LEVEL_EDGES = (0.003, 0.01, 0.03, 0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.8)
RADIUS_BINS = 10
TILES = (6, 8)
LARGEST_RESIDUAL = 8.0
LAGS = ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0), (2, 2))
STEEPEST = 30.0  # of an edge, in standard deviations per pixel
FAR_ABOVE = 8.0  # standard deviations beyond white that are surely at white
OUTLYING = 3.5  # standard deviations
OF_COLUMNS, JUMPS = "column_fixed_pattern", "random_telegraph_noise"


@dataclass
class TestSums:
    """Sufficient sums of one test: score and its variance, per group.

    repeated : standard deviation of what is the same in all frames, and adds up.
    squared : score already is a sum of squares over groups."""

    score: Any = 0.0
    variance: Any = 0.0
    repeated: Any = 0.0
    squared: bool = False

    @property
    def whole_variance(self) -> Any:
        return self.variance + np.square(self.repeated)


@dataclass(frozen=True)
class Patterns:
    """Standard deviations of the fixed patterns that a profile states, in those of the
    residuals of the pixels that are used: of pixels, and of columns."""

    of_pixels: Array
    of_columns: Array


@dataclass
class FixedSums:
    """Per pixel, of frames of one shape: sums of residuals and of their squares, number
    of frames, and what patterns that a profile states make of the squares of the sums
    beyond the sums of the squares."""

    residuals: Any = 0.0
    squares: Any = 0.0
    counts: Any = 0
    _shown: dict[str, Any] = field(default_factory=dict)
    _alone: Any = 0.0

    def add(self, z: Array, used: Mask, shown: Mapping[str, Array]) -> None:
        """Count residuals. shown : standard deviations of each pattern in them."""
        self.residuals = self.residuals + np.where(used, z, 0)
        self.squares = self.squares + np.where(used, z * z, 0)
        self.counts = self.counts + used
        for name, size in shown.items():
            self._shown[name] = self._shown.get(name, 0.0) + np.where(used, size, 0)
            self._alone = self._alone + np.where(used, size**2, 0)

    @property
    def of_patterns(self) -> Any:
        return sum(size**2 for size in self._shown.values()) - self._alone


@dataclass
class OutlierCounts:
    """Pixels that stand out, and pixels in all: of those that stood out in frames of
    another group, and of the rest."""

    again: int = 0
    suspects: int = 0
    elsewhere: int = 0
    rest: int = 0


@dataclass
class Statistics:
    """Sums of all tests. Frames of another shape have rows, columns and pixels of their
    own; what both have, such as the sites of the CFA, they share."""

    sums: dict[tuple[str, tuple[int, ...]], TestSums] = field(default_factory=dict)
    fixed: dict[tuple[int, ...], FixedSums] = field(default_factory=dict)
    suspects: dict[tuple[int, ...], Mask] = field(default_factory=dict)
    outliers: OutlierCounts = field(default_factory=OutlierCounts)
    below_white: list[Array] = field(default_factory=list)
    pixels: int = 0

    def add(
        self,
        name: str,
        score: Any,
        variance: Any,
        squared: bool = False,
        repeated: Any = 0.0,
    ) -> None:
        key = (name, np.shape(score))
        sums = self.sums.setdefault(key, TestSums(squared=squared))
        sums.score = sums.score + score
        sums.variance = sums.variance + variance
        sums.repeated = sums.repeated + repeated

    def of_test(self, name: str) -> TestSums:
        """Return the sums of a test over frames of all shapes."""
        parts = [sums for (one, _), sums in self.sums.items() if one == name]
        if len(parts) == 1:
            return parts[0]
        score = np.concatenate([np.atleast_1d(part.score) for part in parts])
        variance = np.concatenate(
            [np.atleast_1d(part.whole_variance) for part in parts]
        )
        return TestSums(score, variance)


def statistics_of(
    model: Model, likelihood: Likelihood, others: Likelihood
) -> Statistics:
    """Return the sums of all tests of a model on frames.

    others : of another split, which only say which pixels may stand out."""
    statistics = Statistics(suspects=_suspects(model, others))
    computed = likelihood.each(lambda frame: log_density(model, frame)[1:])
    for frame, (z, p) in zip(likelihood.frames, computed, strict=True):
        _collect(statistics, model, frame, z, p)
    return statistics


def _suspects(model: Model, likelihood: Likelihood) -> dict[tuple[int, ...], Mask]:
    """Return where any frame of a shape has an outlier."""
    found: dict[tuple[int, ...], Mask] = {}
    computed = likelihood.each(lambda frame: log_density(model, frame)[1])
    for frame, z in zip(likelihood.frames, computed, strict=True):
        outlying = frame.keep & ~frame.censored & (np.abs(z) > OUTLYING)
        found[z.shape] = found.get(z.shape, False) | outlying
    return found


def _collect(
    c: Statistics, model: Model, frame: Frame, z: Array, p: Prediction
) -> None:
    # Censored pixels take part: their residuals are drawn. Without them, what is left
    # of a dark whose noise reaches 0 would look lopsided.
    used = frame.keep & (p.mean < DRAWN_ABOVE)
    sure = frame.keep & ~frame.at_white & (p.mean - FAR_ABOVE * np.sqrt(p.variance) > 1)
    c.below_white.append(((frame.signal - p.mean) / np.sqrt(p.variance))[sure])
    z = np.clip(z, -LARGEST_RESIDUAL, LARGEST_RESIDUAL)
    values = z[used]
    if not values.size:
        return
    n = values.size
    c.pixels += n
    if frame.samples is not None:
        _means(c, frame, p, z, used)
        return
    shown = _shown_patterns(model, frame, p)
    patterns = _patterns(shown, used)
    site = np.broadcast_to(frame.site[None], z.shape)[used]
    sites = int(frame.site.max()) + 1
    for name, labels, size in _groups(frame, p):
        chosen = np.broadcast_to(labels, z.shape)[used]
        _group_sums(c, name, chosen, size, values, patterns)
        if name in ("radius", "level", "tile"):
            both = chosen * sites + site
            _group_sums(c, f"{name} by channel", both, size * sites, values, patterns)
    c.add("frame mean", values.sum() ** 2 / n, 1, True)
    c.add("frame variance", (values**2 - 1).sum() ** 2 / (2 * n), 1, True)
    c.add("skewness", (values**3 - 3 * values).sum(), 6 * n)
    c.add("kurtosis", (values**4 - 6 * values**2 + 3).sum(), 24 * n)
    _correlations(c, np.where(used, z, 0), used)
    if frame.capture.shows.render:
        _edges(c, frame, z, p, used)
    _count_outliers(c, model, z, used & ~frame.censored)
    c.fixed.setdefault(z.shape, FixedSums()).add(z, used, shown)


def _means(c: Statistics, frame: Frame, p: Prediction, z: Array, used: Mask) -> None:
    """Add what a table of patch means shows: they lie nowhere, and most of what is left
    of them are the errors of their chart's colours, the same in all its frames."""
    of_light = np.broadcast_to(p.light_variance / p.variance, z.shape)[used]
    for name, labels, size in _groups(frame, p):
        if name in ("channel", "level"):
            chosen = np.broadcast_to(labels, z.shape)[used]
            mean, of_frame, of_chart = (
                np.bincount(chosen, weights, size)
                for weights in (z[used], 1 - of_light, of_light / frame.repeats)
            )
            c.add(f"{name} mean", mean, of_frame, repeated=np.sqrt(of_chart))


def _count_outliers(c: Statistics, model: Model, z: Array, used: Mask) -> None:
    suspect = c.suspects.get(z.shape)
    # Pixels that jump by chance are out again by that same chance.
    if suspect is None or JUMPS in model.profile_parameters:
        return
    outlying = used & (np.abs(z) > OUTLYING)
    c.outliers.again += int((outlying & suspect).sum())
    c.outliers.suspects += int((used & suspect).sum())
    c.outliers.elsewhere += int((outlying & ~suspect).sum())
    c.outliers.rest += int((used & ~suspect).sum())


def _group_sums(
    c: Statistics,
    name: str,
    labels: Array,
    size: int,
    values: Array,
    patterns: Patterns,
) -> None:
    """Add mean and variance of the groups of one kind.

    labels, values : (n,), of the pixels that are used."""
    count = np.bincount(labels, minlength=size)
    mean = np.bincount(labels, values, size)
    repeated = np.bincount(labels, patterns.of_pixels**2, size)
    if name in ("row", "tile"):
        squares = (mean**2 / np.maximum(count + repeated, 1)).sum()
        c.add(f"{name} mean, each frame", squares, int((count > 0).sum()), True)
    if name == "column":
        repeated += np.bincount(labels, patterns.of_columns, size) ** 2
    c.add(f"{name} mean", mean, count.astype(float), repeated=np.sqrt(repeated))
    if name in ("channel", "radius", "level", "row"):
        c.add(f"{name} variance", np.bincount(labels, values**2 - 1, size), 2 * count)


def _groups(frame: Frame, p: Prediction) -> Iterator[tuple[str, Array, int]]:
    """Yield (name, label of every pixel, number of labels)."""
    u, v = frame.tiles.field()
    rows, columns = frame.tiles.rows_and_columns()
    height, width = frame.tiles.shape
    tile = rows * TILES[0] // height * TILES[1] + columns * TILES[1] // width
    yield "channel", frame.site[None], int(frame.site.max()) + 1
    radius = np.sqrt(u * u + v * v) * RADIUS_BINS
    yield "radius", np.minimum(radius.astype(int), RADIUS_BINS - 1), RADIUS_BINS
    yield "level", np.digitize(p.exposed, LEVEL_EDGES), len(LEVEL_EDGES) + 1
    yield "tile", tile, TILES[0] * TILES[1]
    yield "row", rows, height
    yield "column", columns, width


def _shown_patterns(model: Model, frame: Frame, p: Prediction) -> dict[str, Array]:
    """Return (T, h, w) the standard deviation of each pattern that a profile states."""
    found = pattern_variances(model, frame, p.exposed)
    return {name: np.sqrt(one / p.variance) for name, one in found.items()}


def _patterns(shown: Mapping[str, Array], used: Mask) -> Patterns:
    """Return the sizes of patterns in the pixels that are used."""
    of_pixels, of_columns = np.zeros((2, int(used.sum())))
    for name, size in shown.items():
        if name == OF_COLUMNS:
            of_columns = size[used]
        else:
            of_pixels = np.hypot(of_pixels, size[used])
    return Patterns(of_pixels, of_columns)


def _correlations(c: Statistics, z: Array, used: Mask) -> None:
    height, width = z.shape[-2:]
    for down, right in LAGS:
        a, b = (
            (image[:, down:, right:] for image in (z, used)),
            (image[:, : height - down, : width - right] for image in (z, used)),
        )
        (za, ka), (zb, kb) = a, b
        name = f"autocorrelation ({down}, {right})"
        c.add(name, (za * zb).sum(), int((ka & kb).sum()))


def _edges(c: Statistics, frame: Frame, z: Array, p: Prediction, used: Mask) -> None:
    green = frame.camera[:, 1:2].astype(float).repeat(3, 1)
    down, right = np.gradient(green, axis=2), np.gradient(green, axis=3)
    down_down, right_right = np.gradient(down, axis=2), np.gradient(right, axis=3)
    u, v = frame.tiles.field()
    spread = np.sqrt(p.variance)
    slopes = {
        "vertical": frame.of_site(down),
        "horizontal": frame.of_site(right),
        "Laplacian": frame.of_site(down_down + right_right),
        "upright blur": frame.of_site(down_down - right_right),
        "diagonal blur": frame.of_site(np.gradient(down, axis=3)),
    }
    slopes["radial"] = slopes["vertical"] * v + slopes["horizontal"] * u
    for name, slope in slopes.items():
        pull = np.clip(slope / spread, -STEEPEST, STEEPEST)
        for color, letter in ((None, ""), (0, " red"), (2, " blue")):
            if color is not None and name != "radial":
                continue
            chosen = used if color is None else used & (frame.color == color)
            score = (pull * z)[chosen].sum()
            c.add(f"edge: {name}{letter}", score, (pull**2)[chosen].sum())
