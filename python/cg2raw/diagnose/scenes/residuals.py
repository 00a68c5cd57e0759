# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What is left of test scenes: questions to residuals whose answers are known by
chance, (chi-square, freedom) each."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.special import chdtrc

from cg2raw.diagnose.diagnosis import ResidualTest
from cg2raw.diagnose.scenes.gram import Array, Normal
from cg2raw.diagnose.scenes.noise import noise_parts, noise_shares
from cg2raw.diagnose.scenes.nuisances import Nuisance, fields, legendre, to_edge
from cg2raw.diagnose.scenes.point import (
    Point,
    by_light,
    by_nuisances,
    offsets_of,
    products_of,
    without_offsets,
)
from cg2raw.diagnose.scenes.predict import variance_left

FINEST = 10  # degree of the fields that are looked for
RINGS_ASKED, LEVELS = 8, 8
BLOCK = 16  # px
FEWEST = 50  # samples of a sum that counts as normal
LAGS = ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0))
EIGEN = 1e-9  # of the largest: directions that nuisances leave
WHERE: Mapping[str, str] = {
    "sites": "the residual differs between the sites of the CFA",
    "fields": "the residual differs between places of the frame",
    "radius": "the residual changes from the centre to the corners, by colour",
    "level": "the residual depends on the level of the signal",
    "edges": "the residual lies along edges",
    "streaks": "the residual goes with the light of a whole column or row",
    "rows": "the residual differs from row to row",
    "columns": "the residual differs from column to column",
    "blocks": "the residual differs between blocks of the frame",
    "neighbours": "neighbouring pixels have residuals in common",
    "variance by level": "the size of the residuals depends on the level of the signal",
    "variance by radius": "the size of the residuals changes towards the corners",
    "repeats": "frames that repeat each other differ by another amount than predicted",
}


class Residuals:
    """Sums over the test scenes that are added.

    of_noise : (2, 2), the information by which the size of noise was fitted, of light
    and of the read-out; None where it is known."""

    def __init__(self, of_noise: Array | None = None) -> None:
        self._linear: dict[str, tuple[Any, Any]] = {}
        self._sums: dict[str, list[Array]] = {}
        self._of_noise = of_noise
        self.samples = 0

    def taken(self, point: Point, nuisances: Sequence[Nuisance]) -> Array:
        """Return residuals (T, h, w) of a view without what nuisances take, in standard
        deviations."""
        return self._add(point, nuisances, ())

    def add(self, point: Point, nuisances: Sequence[Nuisance]) -> None:
        """Count a view."""
        left = self._add(point, nuisances, list(_columns(point)))
        used = point.root > 0
        self.samples += int(used.sum())
        waves = any(one.name.startswith("flicker") for one in nuisances)
        for name, sums in _sums(point, left, used, waves):
            self._sums.setdefault(name, []).append(sums)

    def _add(
        self,
        point: Point,
        nuisances: Sequence[Nuisance],
        questions: Sequence[tuple[str, list[Array]]],
    ) -> Array:
        root, used = point.root, point.root > 0
        z = point.z[used]
        changes = [*by_nuisances(point, nuisances)]
        every = [*changes, *(column for _, columns in questions for column in columns)]
        rows = [(column * root)[used] for column in every]
        normal = Normal(len(z), *products_of(np.array([*rows, z]), point))
        at = np.arange(len(nuisances))
        deviations = np.array([one.deviation for one in nuisances])
        numbers = normal.found(at, deviations, np.zeros(0))
        left = normal.without(at, deviations).products
        first = len(nuisances)
        for name, columns in questions:
            part = slice(first, first := first + len(columns))
            before = self._linear.get(name, (0.0, 0.0))
            self._linear[name] = (
                before[0] + left[part, -1],
                before[1] + left[part, part],
            )
        for number, row in zip(numbers, rows, strict=False):
            z = z - number * row
        residuals = np.zeros_like(root)
        residuals[used] = without_offsets(z, point)
        return residuals

    def tests(self) -> list[ResidualTest]:
        """Return all tests, those that explain most nats first."""
        found: list[tuple[str, float, float]] = []
        for name, (score, information) in self._linear.items():
            values, vectors = np.linalg.eigh(information)
            shown = values > EIGEN * max(values[-1], 1e-300)
            along = vectors[:, shown].T @ score
            found.append(
                (name, float((along**2 / values[shown]).sum()), int(shown.sum()))
            )
        for name, sums in self._sums.items():
            every = np.concatenate(sums, axis=1)
            z, slopes = every[0], every[1:]
            squares = z @ z
            if self._of_noise is not None:  # its error is in all of them
                known, along = self._of_noise + slopes @ slopes.T, slopes @ z
                squares -= along @ np.linalg.solve(known, along)
            found.append((name, float(squares), len(z)))
        tests = [self._test(*one) for one in found if one[2] > 0]
        return sorted(tests, key=lambda test: -test.nats_per_pixel)

    def _test(self, name: str, squares: float, freedom: float) -> ResidualTest:
        nats = 0.5 * (squares - freedom) / max(self.samples, 1)
        where = WHERE[name]
        p_value = float(chdtrc(freedom, max(squares, 0.0)))
        return ResidualTest(name, squares / freedom - 1, p_value, nats, where)


def _columns(point: Point) -> Iterator[tuple[str, list[Array]]]:
    """Yield (question, columns (T, h, w) that no effect has)."""
    frame = point.frame
    light = np.maximum(point.base, 0)
    shape = light.shape
    v, u = (np.broadcast_to(one, shape) for one in frame.tiles.field()[::-1])
    sites = [np.broadcast_to(frame.site == k, shape) for k in np.unique(frame.site)]
    yield "sites", [light * one for one in sites] + [one * 1.0 for one in sites]
    if frame.samples is not None:
        return
    y, x = to_edge(v), to_edge(u)
    down = [legendre(k, y) for k in range(FINEST + 1)]
    across = [legendre(k, x) for k in range(FINEST + 1)]
    yield "fields", [light * down[a] * across[b] for a, b in fields(FINEST)]
    colors = [np.broadcast_to(frame.color == k, shape) for k in np.unique(frame.color)]
    rings = _hats(np.hypot(u, v), RINGS_ASKED)
    yield "radius", [light * ring * one for ring in rings for one in colors]
    top = max(float(light[point.root > 0].max(initial=0.0)), 1e-12)
    yield "level", [light * hat for hat in _hats(light / top, LEVELS)]
    if frame.capture.shows.image:
        yield "edges", _edges(point)
        streaks = [light.mean(axis=axis, keepdims=True) for axis in (1, 2)]
        yield "streaks", [np.broadcast_to(x - x.mean(), shape) for x in streaks]


def _edges(point: Point) -> list[Array]:
    """Return columns of a render that is displaced, bent, or blurred in a direction."""
    frame = point.frame
    camera = frame.camera.astype(float)
    v, u = frame.tiles.places()
    slopes = [np.gradient(camera, axis=axis) for axis in (2, 3)]
    twice = [np.gradient(slopes[k], axis=axis) for k, axis in ((0, 2), (0, 3), (1, 3))]
    changes = [by_light(point, change) for change in (*slopes, *twice)]
    down, across = changes[:2]
    changes.append((down * v + across * u) * (v**2 + u**2))
    return changes + [
        one * by for one in (down, across) for by in (v * v, u * v, u * u)
    ]


def _hats(x: Array, count: int) -> list[Array]:
    """Return functions that add up to 1, each of one part of 0 to 1."""
    knots = np.linspace(0, 1, count)
    return [np.maximum(1 - np.abs(x - k) * (count - 1), 0) for k in knots]


def _sums(
    point: Point, z: Array, used: Array, waves: bool
) -> Iterator[tuple[str, Array]]:
    """Yield (question, (3, K) standard normal sums of residuals in standard deviations,
    with their slopes by the logarithm of the size of noise: of light, of the read-out).

    waves : whether rows have light of their own in each frame, as a lamp flickers."""
    frame, light = point.frame, np.maximum(point.base, 0)
    if frame.samples is not None:
        return  # tables share the errors of their chart
    top = max(float(light[used].max(initial=0.0)), 1e-12)
    labels = np.minimum((light / top * LEVELS).astype(int), LEVELS - 1)
    left = variance_left(point.model)
    known = {offset.name for offset in offsets_of(point)}
    single = z / np.sqrt(left)  # of pixels by themselves
    shares = noise_shares(point)
    yield "variance by level", _variances(single, used, shares, labels, LEVELS)
    if point.view.n > 1:
        yield "repeats", _repeats(point, used, "rows" in known, waves)
    v, u = frame.tiles.field()[::-1]
    ring = np.minimum((np.hypot(u, v) * RINGS_ASKED).astype(int), RINGS_ASKED - 1)
    yield "variance by radius", _variances(single, used, shares, ring, RINGS_ASKED)
    if "rows" not in known:
        yield "rows", _normal(z.sum(2), used.sum(2))
    if "columns" not in known:
        yield "columns", _normal(z.sum(1), used.sum(1))
    height, width = (n // BLOCK * BLOCK for n in z.shape[1:])
    inner = [one[:, :height, :width] for one in (z, used)]
    shape = (len(z), height // BLOCK, BLOCK, width // BLOCK, BLOCK)
    yield "blocks", _normal(*(one.reshape(shape).sum((2, 4)) for one in inner))
    if left < 1:
        return  # neighbours are known to have noise in common
    products, counts = [], []
    for row, col in LAGS:
        product = _lagged(z, row, col)
        count = _lagged(used.astype(float), row, col)
        for site in np.unique(frame.site):
            here = _cut(frame.site, row, col) == site
            products.append((product * here).sum())
            counts.append((count * here).sum())
    yield "neighbours", _normal(np.array(products), np.array(counts))


def _normal(sums: Array, variances: Array, slopes: Array | None = None) -> Array:
    """Return (3, K) of those that are of enough: sums, and slopes (2, ...), by their
    standard deviation."""
    enough = variances > FEWEST if variances.max(initial=0) > FEWEST else variances > 0
    slopes = np.zeros((2, *sums.shape)) if slopes is None else slopes
    every = np.stack([sums, *slopes])
    return np.asarray(every[:, enough] / np.sqrt(variances[enough]))


def _variances(
    z: Array, used: Array, shares: Array, labels: Array, count: int
) -> Array:
    """By the squares of normal residuals, of which each has the variance 2. shares :
    (2, T, h, w) of the variance, of light and of the read-out."""
    labels = np.broadcast_to(labels, z.shape)[used]
    n = np.bincount(labels, minlength=count)
    each = [z[used] ** 2 - 1, *(one[used] for one in shares)]
    sums, *slopes = (np.bincount(labels, one, count) / np.sqrt(2) for one in each)
    return _normal(sums, n, np.array(slopes))


def _repeats(point: Point, used: Array, offsets: bool, waves: bool) -> Array:
    """By the squares of what frames differ by, without what rows are known to have for
    themselves in each: offsets, and light where it comes in waves."""
    n, away = point.view.n, point.view.away
    of_rows = [np.ones_like(point.base)] if offsets else []
    of_rows += [point.base] if waves else []
    freedom = (n - 1) * used.astype(float)
    for along in of_rows:
        along = along * used
        norm = np.maximum((along**2).sum(2, keepdims=True), 1e-300)
        away = away - along * (away * along).sum(3, keepdims=True) / norm
        freedom -= (n - 1) * along**2 / norm
    expected = point.frame_variance * variance_left(point.model)
    each = [
        (away**2).sum(0) / expected - freedom,
        *(n - 1) * noise_parts(point) / expected,
    ]
    sums, *slopes = ([one[used].sum() / np.sqrt(2 * (n - 1))] for one in each)
    return _normal(np.array(sums), np.array([float(used.sum())]), np.array(slopes))


def _lagged(image: Array, row: int, col: int) -> Array:
    """Return products (T, h, w) of pixels with those so far away."""
    _, height, width = image.shape
    first = image[:, row:, max(col, 0) : width + min(col, 0)]
    second = image[:, : height - row, max(-col, 0) : width - max(col, 0)]
    return np.asarray(first * second)


def _cut(image: Array, row: int, col: int) -> Array:
    return np.asarray(image[row:, max(col, 0) : image.shape[1] + min(col, 0)])
