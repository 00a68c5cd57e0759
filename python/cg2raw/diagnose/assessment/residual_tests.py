# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Residual tests: is anything left, and where.

Every test asks the standardised residuals of held-out frames one question; without a
gap they are independent N(0, 1), and each statistic has a known distribution.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.stats import chi2, norm, poisson

from cg2raw.diagnose.diagnosis import ResidualTest
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.likelihood.censoring import MEASURED
from cg2raw.diagnose.likelihood.likelihood import Workers, log_density
from cg2raw.diagnose.likelihood.nuisance import of_site
from cg2raw.diagnose.likelihood.prediction import Model, Prediction, pattern_bearing

LEVELS = (0.003, 0.01, 0.03, 0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.8)
RINGS = 10
TILES = (6, 8)
LARGEST = 8.0
FEWEST = 20.0  # pixels of a group
LAGS = ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0), (2, 2))
STEEPEST = 30.0  # of an edge, in standard deviations per pixel
SLOW_IS_LEFT = ("prnu", "dsnu")  # maps without their slow part
FAR_ABOVE = 8.0  # standard deviations beyond white that are surely at white
MOST_NATS = 200.0  # that one pixel counts
OUTLYING = 3.5  # standard deviations

WHERE = {
    "channel": "differs between the sites of the CFA",
    "radius by channel": "changes from the centre to the corners, by site of the CFA",
    "level by channel": "depends on the level of the signal, by site of the CFA",
    "tile by channel": "differs between places of the frame, by site of the CFA",
    "radius": "changes from the centre to the corners",
    "level": "depends on the level of the signal",
    "tile": "differs between places of the frame",
    "row": "differs from row to row",
    "column": "differs from column to column",
    "frame": "differs from frame to frame",
    "autocorrelation": "neighbouring pixels share their noise",
    "skewness": "the noise is lopsided",
    "kurtosis": "the noise has heavier or lighter tails than a normal",
    "edge": "lies along edges",
    "fixed": "the same pixels differ in all frames",
    "white": "pixels are below white that are predicted far above it",
    "outliers": "pixels stand out that stood out in other frames",
}


@dataclass
class _Sums:
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
class _Doubt:
    """Standard deviations of the pixels that are used, of what is the same in all
    frames: independent ones, whose mean over a group a map leaves out; and those that
    the pixels of a column share."""

    of_pixels: Array
    of_columns: Array


@dataclass
class _Fixed:
    """Per pixel, of frames of one shape: sums of residuals and of their squares, number
    of frames; and what uncertain maps add to the products, by map: sums of shares and
    of their squares."""

    residuals: Any = 0.0
    squares: Any = 0.0
    counts: Any = 0
    posterior: dict[str, tuple[Any, Any]] = field(default_factory=dict)


@dataclass
class _Outliers:
    """Pixels that stand out, and pixels in all: of those that stood out in frames of
    another group, and of the rest."""

    again: int = 0
    suspects: int = 0
    elsewhere: int = 0
    rest: int = 0


@dataclass
class _Collected:
    """Sums of all tests. Frames of another shape have rows, columns and pixels of their
    own; what both have, such as the sites of the CFA, they share."""

    sums: dict[tuple[str, tuple[int, ...]], _Sums] = field(default_factory=dict)
    fixed: dict[tuple[int, ...], _Fixed] = field(default_factory=dict)
    suspects: dict[tuple[int, ...], Mask] = field(default_factory=dict)
    outliers: _Outliers = field(default_factory=_Outliers)
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
        sums = self.sums.setdefault(key, _Sums(squared=squared))
        sums.score = sums.score + score
        sums.variance = sums.variance + variance
        sums.repeated = sums.repeated + repeated

    def of_test(self, name: str) -> _Sums:
        """Return the sums of a test over frames of all shapes."""
        parts = [sums for (one, _), sums in self.sums.items() if one == name]
        if len(parts) == 1:
            return parts[0]
        score = np.concatenate([np.atleast_1d(part.score) for part in parts])
        variance = np.concatenate(
            [np.atleast_1d(part.whole_variance) for part in parts]
        )
        return _Sums(score, variance)


def residual_tests(
    model: Model,
    frames: Sequence[Frame],
    workers: Workers,
    others: Sequence[Frame] = (),
) -> list[ResidualTest]:
    """Return all tests, those that explain most nats first.

    others : frames of another group, which only tell which pixels may stand out."""
    collected = _Collected(suspects=_suspects(model, others, workers))
    computed = workers.map(lambda f: log_density(model, f)[1:], frames)
    for frame, (z, p) in zip(frames, computed, strict=True):
        _collect(collected, model, frame, z, p)
    names = dict.fromkeys(name for name, _ in collected.sums)
    tests = [_tested(n, collected.of_test(n), collected.pixels) for n in names]
    tests.append(_fixed(collected))
    if any(part.size for part in collected.below_white):
        tests.append(_below_white(collected))
    if collected.outliers.suspects:
        tests.append(_outliers(collected))
    return sorted(tests, key=lambda test: -test.nats_per_pixel)


def _suspects(
    model: Model, frames: Sequence[Frame], workers: Workers
) -> dict[tuple[int, ...], Mask]:
    """Return where any frame of a shape has an outlier."""
    found: dict[tuple[int, ...], Mask] = {}
    computed = workers.map(lambda f: log_density(model, f)[1], frames)
    for frame, z in zip(frames, computed, strict=True):
        outlying = frame.keep & ~frame.censored & (np.abs(z) > OUTLYING)
        found[z.shape] = found.get(z.shape, False) | outlying
    return found


def _collect(
    c: _Collected, model: Model, frame: Frame, z: Array, p: Prediction
) -> None:
    # Censored pixels take part: their residuals are drawn. Without them, what is left
    # of a dark whose noise reaches 0 would look lopsided.
    used = frame.keep & (p.mean < MEASURED)
    sure = frame.keep & ~frame.at_white & (p.mean - FAR_ABOVE * np.sqrt(p.variance) > 1)
    c.below_white.append(((frame.signal - p.mean) / np.sqrt(p.variance))[sure])
    z = np.clip(z, -LARGEST, LARGEST)
    values = z[used]
    if not values.size:
        return
    n = values.size
    c.pixels += n
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
    if frame.capture.kind == "scene":
        _edges(c, frame, z, p, used)
    _count_outliers(c, z, used & ~frame.censored)
    fixed = c.fixed.setdefault(z.shape, _Fixed())
    fixed.residuals = fixed.residuals + np.where(used, z, 0)
    fixed.squares = fixed.squares + np.where(used, z * z, 0)
    fixed.counts = fixed.counts + used
    for term in model.terms:
        if term.pattern is not None and term.pattern.mean.shape == z.shape:
            bearing = pattern_bearing(term.name, frame, np.maximum(p.exposed, 0))
            share = bearing * np.sqrt(term.pattern.variance / p.variance) * used
            linear, square = fixed.posterior.get(term.name, (0.0, 0.0))
            fixed.posterior[term.name] = (linear + share, square + share**2)


def _count_outliers(c: _Collected, z: Array, used: Mask) -> None:
    suspect = c.suspects.get(z.shape)
    if suspect is None:
        return
    outlying = used & (np.abs(z) > OUTLYING)
    c.outliers.again += int((outlying & suspect).sum())
    c.outliers.suspects += int((used & suspect).sum())
    c.outliers.elsewhere += int((outlying & ~suspect).sum())
    c.outliers.rest += int((used & ~suspect).sum())


def _group_sums(
    c: _Collected,
    name: str,
    labels: Array,
    size: int,
    values: Array,
    doubt: _Doubt,
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
    radius = np.sqrt(u * u + v * v) * RINGS
    yield "radius", np.minimum(radius.astype(int), RINGS - 1), RINGS
    yield "level", np.digitize(p.exposed, LEVELS), len(LEVELS) + 1
    yield "tile", tile, TILES[0] * TILES[1]
    yield "row", rows, height
    yield "column", columns, width


def _doubt(model: Model, frame: Frame, p: Prediction, used: Mask) -> _Doubt:
    """Return what maps leave uncertain of the pixels that are used."""
    count = int(used.sum())
    of_pixels, of_columns = np.zeros(count), np.zeros(count)
    for term in model.terms:
        if term.pattern is None or term.pattern.mean.shape != p.mean.shape:
            continue
        bearing = pattern_bearing(term.name, frame, np.maximum(p.exposed, 0))
        if term.name == "column_noise":
            of_columns = np.sqrt(term.pattern.variance / p.variance)[used]
        elif term.name in SLOW_IS_LEFT:
            size = np.abs(bearing) * float(term.values[0]) / np.sqrt(p.variance)
            of_pixels = np.hypot(of_pixels, size[used])
    return _Doubt(of_pixels, of_columns)


def _correlations(c: _Collected, z: Array, used: Mask) -> None:
    height, width = z.shape[-2:]
    for down, right in LAGS:
        a, b = (
            (image[:, down:, right:] for image in (z, used)),
            (image[:, : height - down, : width - right] for image in (z, used)),
        )
        (za, ka), (zb, kb) = a, b
        name = f"autocorrelation ({down}, {right})"
        c.add(name, (za * zb).sum(), int((ka & kb).sum()))


def _edges(c: _Collected, frame: Frame, z: Array, p: Prediction, used: Mask) -> None:
    green = frame.camera[:, 1:2].astype(float).repeat(3, 1)
    down, right = np.gradient(green, axis=2), np.gradient(green, axis=3)
    down_down, right_right = np.gradient(down, axis=2), np.gradient(right, axis=3)
    u, v = frame.tiles.field()
    spread = np.sqrt(p.variance)
    slopes = {
        "vertical": of_site(down, frame),
        "horizontal": of_site(right, frame),
        "Laplacian": of_site(down_down + right_right, frame),
        "upright blur": of_site(down_down - right_right, frame),
        "diagonal blur": of_site(np.gradient(down, axis=3), frame),
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


def _where(name: str) -> str:
    key = name.split(":")[0].removesuffix(" mean").split(" (")[0]
    text = WHERE.get(key) or WHERE.get(key.split()[0], name)
    if name.endswith("variance"):
        return f"the size of the residuals {text}"
    return f"the residual {text}" if "mean" in name else text


def _tested(name: str, sums: _Sums, pixels: int) -> ResidualTest:
    if sums.squared:
        statistic, freedom = float(sums.score), float(sums.variance)
        p_value = float(chi2.sf(statistic, freedom))
        size, nats = statistic / max(freedom, 1) - 1, 0.5 * (statistic - freedom)
    elif np.ndim(sums.score):
        score, variance = np.asarray(sums.score), np.asarray(sums.whole_variance)
        enough = variance > FEWEST
        statistic = float((score[enough] ** 2 / variance[enough]).sum())
        freedom = int(enough.sum())
        p_value = float(chi2.sf(statistic, freedom)) if freedom else 1.0
        size, nats = statistic / max(freedom, 1) - 1, 0.5 * (statistic - freedom)
    else:
        size = float(sums.score / np.sqrt(max(float(sums.variance), 1.0)))
        p_value, nats = float(2 * norm.sf(abs(size))), 0.5 * (size**2 - 1)
    return ResidualTest(name, size, p_value, nats / max(pixels, 1), _where(name))


def _fixed(c: _Collected) -> ResidualTest:
    """The product of a pixel's residuals over frames, without what a map explains."""
    excess, variance = 0.0, 0.0
    for one in c.fixed.values():
        known = sum(a * a - b for a, b in one.posterior.values())
        counts = np.asarray(one.counts, float)
        used = counts > 1
        excess += float((one.residuals**2 - one.squares - known)[used].sum())
        variance += float((2 * counts[used] * (counts[used] - 1)).sum())
    size = excess / np.sqrt(max(variance, 1.0))
    p_value, nats = float(2 * norm.sf(abs(size))), 0.5 * (size**2 - 1)
    name = "fixed pattern: the same pixel in all frames"
    return ResidualTest(name, size, p_value, nats / max(c.pixels, 1), WHERE["fixed"])


def _below_white(c: _Collected) -> ResidualTest:
    """Pixels that should have reached white by far, and did not: none by chance."""
    away = np.concatenate(c.below_white)
    nats = float(np.minimum(0.5 * away**2, MOST_NATS).sum())
    name = "white: pixels that should have reached it"
    p_value = float(2 * norm.sf(np.abs(away).max()))
    per_pixel = nats / max(c.pixels, 1)
    return ResidualTest(name, float(away.size), p_value, per_pixel, WHERE["white"])


def _outliers(c: _Collected) -> ResidualTest:
    """Pixels that stand out in two groups of frames, against as many anywhere: Poisson
    by chance."""
    seen = c.outliers
    chance = (seen.elsewhere + 1) / max(seen.rest, 1) * seen.suspects
    p_value = float(poisson.sf(seen.again - 1, chance)) if seen.again else 1.0
    size = (seen.again - chance) / np.sqrt(max(chance, 1.0))
    nats = seen.again * np.log(max(seen.again, 1) / max(chance, 1e-9))
    nats = float(nats) - (seen.again - chance) if seen.again > chance else 0.0
    per_pixel = nats / max(c.pixels, 1)
    name = "outliers: the same pixels in other frames"
    return ResidualTest(name, float(size), p_value, per_pixel, WHERE["outliers"])
