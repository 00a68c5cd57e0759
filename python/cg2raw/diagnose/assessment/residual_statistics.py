# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Residual statistics: sufficient sums of what residual tests ask."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cg2raw.diagnose.assessment.fixed_sums import FixedSums, shown_maps
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.likelihood.censoring import DRAWN_ABOVE
from cg2raw.diagnose.likelihood.likelihood import Likelihood, log_density
from cg2raw.diagnose.likelihood.model import Model

LEVEL_EDGES = (0.003, 0.01, 0.03, 0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.8)
RADIUS_BINS = 10
TILES = (6, 8)
LARGEST_RESIDUAL = 8.0
LAGS = ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0), (2, 2))
STEEPEST = 30.0  # of an edge, in standard deviations per pixel
FAR_ABOVE = 8.0  # standard deviations beyond white that are surely at white
OUTLYING = 3.5  # standard deviations


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
class MapDoubt:
    """Standard deviations of the pixels that are used, of what is the same in all
    frames: independent ones, whose mean over a group a map leaves out; and those that
    the pixels of a column share."""

    of_pixels: Array
    of_columns: Array


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
    doubt = _doubt(model, frame, p, used)
    site = np.broadcast_to(frame.site[None], z.shape)[used]
    sites = int(frame.site.max()) + 1
    for name, labels, size in _groups(frame, p):
        chosen = np.broadcast_to(labels, z.shape)[used]
        _group_sums(c, name, chosen, size, values, doubt)
        if name in ("radius", "level", "tile"):
            both = chosen * sites + site
            _group_sums(c, f"{name} by channel", both, size * sites, values, doubt)
    c.add("frame mean", values.sum() ** 2 / n, 1, True)
    c.add("frame variance", (values**2 - 1).sum() ** 2 / (2 * n), 1, True)
    c.add("skewness", (values**3 - 3 * values).sum(), 6 * n)
    c.add("kurtosis", (values**4 - 6 * values**2 + 3).sum(), 24 * n)
    _correlations(c, np.where(used, z, 0), used)
    if frame.capture.shows.render:
        _edges(c, frame, z, p, used)
    _count_outliers(c, model, z, used & ~frame.censored)
    of_unknown = model.rate_law_on(frame)
    # What is not known of a pixel repeats, as any map of it would.
    mapped = used if of_unknown is None else used & ~of_unknown[0]
    fixed = c.fixed.setdefault(z.shape, FixedSums())
    fixed.residuals = fixed.residuals + np.where(mapped, z, 0)
    fixed.squares = fixed.squares + np.where(mapped, z * z, 0)
    fixed.counts = fixed.counts + mapped
    fixed.count_maps(shown_maps(model, frame, p, mapped))


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
    if suspect is None or any(one.layout == "jumps" for _, one, _ in model.maps):
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
    doubt: MapDoubt,
) -> None:
    """Add mean and variance of the groups of one kind.

    labels, values : (n,), of the pixels that are used."""
    count = np.bincount(labels, minlength=size)
    mean = np.bincount(labels, values, size)
    of_maps = np.bincount(labels, doubt.of_pixels**2, size)
    if name in ("row", "tile"):
        squares = (mean**2 / np.maximum(count + of_maps, 1)).sum()
        c.add(f"{name} mean, each frame", squares, int((count > 0).sum()), True)
    if name == "column":
        of_maps += np.bincount(labels, doubt.of_columns, size) ** 2
    c.add(f"{name} mean", mean, count.astype(float), repeated=np.sqrt(of_maps))
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


def _doubt(model: Model, frame: Frame, p: Prediction, used: Mask) -> MapDoubt:
    """Return what maps leave uncertain of the pixels that are used."""
    count = int(used.sum())
    of_pixels, of_columns = np.zeros(count), np.zeros(count)
    for term, effect, sensor_map in model.maps:
        if sensor_map.mean.shape != p.mean.shape:
            continue
        if effect.layout == "columns":
            of_columns = np.sqrt(sensor_map.variance / p.variance)[used]
        elif effect.lacks_slow_part:
            shown = np.abs(effect.shown(frame, p))
            size = shown * float(term.values[0]) / np.sqrt(p.variance)
            of_pixels = np.hypot(of_pixels, size[used])
    return MapDoubt(of_pixels, of_columns)


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
