# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Residual tests: is anything left, and where.

Every test asks the standardised residuals of held-out frames one question; without a
gap they are independent N(0, 1), and each statistic has a known distribution.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import chi2, norm

from cg2raw.diagnose.diagnosis import ResidualTest
from cg2raw.diagnose.frames import Frame
from cg2raw.diagnose.tiling import Array
from cg2raw.diagnose.likelihood import Workers, log_density
from cg2raw.diagnose.nuisances import of_site
from cg2raw.diagnose.prediction import Model, Prediction, pattern_bearing

LEVELS = (0.003, 0.01, 0.03, 0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.8)
RINGS = 10
TILES = (6, 8)
LARGEST = 8.0
HIGHEST = 0.97  # of white; above it residuals are drawn, not measured
FEWEST = 20.0  # pixels of a group
LAGS = ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0), (2, 2))
STEEPEST = 30.0  # of an edge, in standard deviations per pixel

WHERE = {
    "channel": "differs between the sites of the CFA",
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
}


@dataclass
class _Sums:
    """Sufficient sums of one test: score and its variance, per group."""

    score: Array | float = 0.0
    variance: Array | float = 0.0
    squared: bool = False  # score already is a sum of squares over groups

    def add(self, score: Array | float, variance: Array | float) -> None:
        self.score = self.score + score
        self.variance = self.variance + variance


@dataclass
class _Collected:
    sums: dict[str, _Sums] = field(default_factory=dict)
    fixed: Array | float = 0.0
    counts: Array | float = 0.0
    posterior: dict[str, list[Array | float]] = field(default_factory=dict)
    columns: Array | float = 0.0

    def add(
        self, name: str, score: Array | float, variance: Array | float, squared: bool
    ) -> None:
        self.sums.setdefault(name, _Sums(squared=squared)).add(score, variance)


def residual_tests(
    model: Model, frames: Sequence[Frame], workers: Workers
) -> list[ResidualTest]:
    """Return all tests, those that explain most nats first."""
    shape = frames[0].signal.shape
    chosen = [frame for frame in frames if frame.signal.shape == shape]
    collected = _Collected()
    computed = workers.map(lambda f: log_density(model, f)[1:], chosen)
    for frame, (z, p) in zip(chosen, computed, strict=True):
        _collect(collected, model, frame, z, p)
    pixels = sum(int((f.keep & ~f.censored).sum()) for f in chosen)
    tests = [_tested(name, sums, pixels) for name, sums in collected.sums.items()]
    tests.append(_fixed(collected, chosen, pixels))
    return sorted(tests, key=lambda test: -test.nats_per_pixel)


def _collect(
    c: _Collected, model: Model, frame: Frame, z: Array, p: Prediction
) -> None:
    used = frame.keep & ~frame.at_white & (p.mean < HIGHEST)
    z = np.clip(z, -LARGEST, LARGEST)
    values = z[used]
    if not values.size:
        return
    for name, labels, size in _groups(frame, p):
        chosen = np.broadcast_to(labels, z.shape)[used]
        count = np.bincount(chosen, minlength=size)
        mean = np.bincount(chosen, values, size)
        if name in ("row", "tile"):
            squares = (mean**2 / np.maximum(count, 1)).sum()
            c.add(f"{name} mean, each frame", squares, (count > 0).sum(), True)
        doubt: Array | float = 0.0
        if name == "column":
            doubt = _column_doubt(model, chosen, p, used, size)
        c.add(f"{name} mean", mean, count + doubt, False)
        if name in ("channel", "radius", "level", "row"):
            spread = np.bincount(chosen, values**2 - 1, size)
            c.add(f"{name} variance", spread, 2 * count, False)
    n = values.size
    c.add("frame mean", values.sum() ** 2 / n, 1, True)
    c.add("frame variance", (values**2 - 1).sum() ** 2 / (2 * n), 1, True)
    c.add("skewness", (values**3 - 3 * values).sum(), 6 * n, False)
    fourth = (values**4 - 6 * values**2 + 3).sum()
    c.add("kurtosis", fourth, 24 * n, False)
    _correlations(c, np.where(used, z, 0), used)
    if frame.capture.kind == "scene":
        _edges(c, frame, z, p, used)
    c.fixed = c.fixed + np.where(used, z, 0)
    c.counts = c.counts + used
    for term in model.terms:
        if term.pattern is not None and term.pattern.mean.shape == z.shape:
            bearing = pattern_bearing(term.name, frame, np.maximum(p.exposed, 0))
            share = bearing * np.sqrt(term.pattern.variance / p.variance) * used
            sums = c.posterior.setdefault(term.name, [0.0, 0.0])
            sums[0], sums[1] = sums[0] + share, sums[1] + share**2


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


def _column_doubt(
    model: Model, labels: Array, p: Prediction, used: Array, size: int
) -> Array | float:
    """Variance of a column's sum that a map of columns leaves uncertain."""
    term = model.term("column_noise")
    if term is None or term.pattern is None:
        return 0.0
    if term.pattern.mean.shape != p.mean.shape:
        return 0.0
    share = np.sqrt(term.pattern.variance / p.variance)[used]
    return np.bincount(labels, share, size) ** 2


def _correlations(c: _Collected, z: Array, used: Array) -> None:
    height, width = z.shape[-2:]
    for down, right in LAGS:
        a, b = (
            (image[:, down:, right:] for image in (z, used)),
            (image[:, : height - down, : width - right] for image in (z, used)),
        )
        (za, ka), (zb, kb) = a, b
        name = f"autocorrelation ({down}, {right})"
        c.add(name, (za * zb).sum(), (ka & kb).sum(), False)


def _edges(c: _Collected, frame: Frame, z: Array, p: Prediction, used: Array) -> None:
    camera = frame.camera.astype(float)
    green = camera[:, 1:2].repeat(3, 1)
    down, right = np.gradient(green, axis=2), np.gradient(green, axis=3)
    bend = np.gradient(down, axis=2) + np.gradient(right, axis=3)
    u, v = frame.tiles.field()
    spread = np.sqrt(p.variance)
    slopes = {
        "vertical": of_site(down, frame),
        "horizontal": of_site(right, frame),
        "Laplacian": of_site(bend, frame),
    }
    slopes["radial"] = slopes["vertical"] * v + slopes["horizontal"] * u
    for name, slope in slopes.items():
        pull = np.clip(slope / spread, -STEEPEST, STEEPEST)
        for color, letter in ((None, ""), (0, " red"), (2, " blue")):
            if color is not None and name != "radial":
                continue
            chosen = used if color is None else used & (frame.color == color)
            score = (pull * z)[chosen].sum()
            c.add(f"edge: {name}{letter}", score, (pull**2)[chosen].sum(), False)


def _where(name: str) -> str:
    key = name.split(":")[0].split()[0]
    text = WHERE.get(key, name)
    if name.endswith("variance"):
        return f"the size of the residuals {text}"
    return f"the residual {text}" if "mean" in name else text


def _tested(name: str, sums: _Sums, pixels: int) -> ResidualTest:
    if sums.squared:
        statistic, freedom = float(sums.score), float(sums.variance)
        p_value = float(chi2.sf(statistic, freedom))
        size, nats = statistic / max(freedom, 1) - 1, 0.5 * (statistic - freedom)
    elif np.ndim(sums.score):
        score, variance = np.asarray(sums.score), np.asarray(sums.variance)
        enough = variance > FEWEST
        statistic = float((score[enough] ** 2 / variance[enough]).sum())
        freedom = int(enough.sum())
        p_value = float(chi2.sf(statistic, freedom)) if freedom else 1.0
        size, nats = statistic / max(freedom, 1) - 1, 0.5 * (statistic - freedom)
    else:
        size = float(sums.score / np.sqrt(max(float(sums.variance), 1.0)))
        p_value, nats = float(2 * norm.sf(abs(size))), 0.5 * (size**2 - 1)
    return ResidualTest(name, size, p_value, nats / max(pixels, 1), _where(name))


def _fixed(c: _Collected, frames: Sequence[Frame], pixels: int) -> ResidualTest:
    """The product of a pixel's residuals over frames, without what a map explains."""
    known = sum(a * a - b for a, b in c.posterior.values())
    used = frames[0].keep & (np.asarray(c.counts) > 1)
    counts = np.asarray(c.counts, float)
    excess = (np.asarray(c.fixed) ** 2 - counts - known)[used].sum()
    size = float(excess / np.sqrt(max(2 * (counts[used] ** 2).sum(), 1)))
    p_value, nats = float(2 * norm.sf(abs(size))), 0.5 * (size**2 - 1)
    name = "fixed pattern: the same pixel in all frames"
    return ResidualTest(name, size, p_value, nats / max(pixels, 1), WHERE["fixed"])
