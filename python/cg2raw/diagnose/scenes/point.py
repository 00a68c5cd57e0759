# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Point: one view under a model, with the derivatives of its mean.

The chain of the core is affine in nearly all parameters and in the light, and takes
less than a millisecond for 100,000 pixels: a derivative is the difference of two
predictions, exact to rounding, and a new effect needs no code here.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.ndimage import maximum_filter
from scipy.sparse import csr_array, hstack

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.registry import registered
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.scenes.gram import Normal, Space
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.nuisances import Nuisance
from cg2raw.diagnose.scenes.predict import (
    by_registry,
    offset_variances,
    pattern_variances,
    predict,
    registry_values,
)
from cg2raw.diagnose.scenes.view import View

NOISE = "noise"  # the stage of effects that move no mean
COLUMN_PATTERN = "column_fixed_pattern"
HIGHEST_MEAN = 0.85  # of white: what clips, or nearly, says nothing of the mean
AROUND = 5  # px of an image where nothing may be brighter: glints are aliased
STEP = 1e-2  # of the brightest light, of derivatives by it
LEAST_LIGHT = 1e-12  # of white, so that nothing is divided by 0
NOT_CUT = 3.0  # standard deviations of a sample to the lowest code


@dataclass(frozen=True)
class Excess:
    """Deviations that captures have beyond noise: of a shift, px; of light, relative;
    and of the colours of a chart's patches, the same in all views of it, relative."""

    shift: float = 0.0
    texture: float = 0.0
    patches: float = 0.0

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.shift or self.texture or self.patches)


@dataclass
class Point:
    """view : its frame's render lies where it was found.

    mean, variance : (T, h, w), of the mean of its frames. base : the mean as if no well
    were full. prediction : of one frame. frame_variance : the same, without patterns.
    noise_variance : of the mean of frames, without what captures have beyond noise.
    patterns : the variance of each fixed pattern. charts : views of one chart, which
    together know its colours no better than one does. root : (T, h, w) of the
    weight, 0 of samples that are left out."""

    view: View
    frame: Frame
    model: Model
    mean: Array
    variance: Array
    root: Array
    base: Array
    prediction: Prediction
    frame_variance: Array
    noise_variance: Array
    patterns: Mapping[str, Array | float]
    excess: Excess
    charts: int = 1

    @property
    def z(self) -> Array:
        """Residuals in standard deviations, (T, h, w)."""
        return (self.view.signal - self.mean) * self.root


def point_of(view: View, frame: Frame, model: Model, excess: Excess) -> Point:
    """Return a view under a model. frame : its own, placed."""
    p = predict(model, frame)
    light = np.maximum(p.exposed, 0)
    patterns = pattern_variances(model, frame, p.exposed)
    own = p.variance - sum(patterns.values())
    fixed = sum(one for name, one in patterns.items() if name != COLUMN_PATTERN)
    variance = noise = own / view.n + fixed
    is_table = frame.samples is not None
    if frame.capture.shows.image and not is_table and (excess.shift or excess.texture):
        slope, _ = frame.squared_slope_and_light
        variance = variance + excess.shift**2 * slope
        variance = variance + excess.texture**2 * light**2
    used = view.keep & (p.mean < HIGHEST_MEAN)
    if p.well is not None:
        used &= ~p.well.is_near(p.photon_variance)
    if frame.capture.shows.render:
        used &= maximum_filter(p.mean, (0, AROUND, AROUND)) < HIGHEST_MEAN
    lowest = -np.asarray(model.sensor.black_level, float).min() / frame.range
    used &= p.mean - NOT_CUT * np.sqrt(p.variance) > lowest
    root = np.where(used, 1 / np.sqrt(variance), 0.0)
    base = mean_of(model, frame)
    return Point(
        view=view,
        frame=frame,
        model=model,
        mean=p.mean,
        variance=variance,
        root=root,
        base=base,
        prediction=p,
        frame_variance=own,
        noise_variance=noise,
        patterns=patterns,
        excess=excess,
    )


def normal_of(
    point: Point,
    effects: Sequence[Effect],
    space: Space,
    theta: Array,
    nuisances: Sequence[Nuisance],
) -> Normal:
    """Return the normal equations of a view: rows of effects, nuisances, residual.

    theta : (P,) where the point is; parameters are counted from the profile's."""
    count = space.size + len(nuisances) + 1
    rows = np.empty((count, point.root.size), np.float32)
    root = point.root
    is_table = point.frame.samples is not None
    for effect in effects:
        if is_table and not effect.from_means:
            rows[space.slices[effect.name]] = 0.0
            continue
        for k, column in enumerate(derivatives(point, effect)):
            rows[space.slices[effect.name].start + k] = (column * root).ravel()
    for k, column in enumerate(by_nuisances(point, nuisances)):
        rows[space.size + k] = (column * root).ravel()
    used = root.ravel() > 0
    there = np.flatnonzero(theta)
    rows[-1] = point.z.ravel() + theta[there] @ rows[there]
    rows = rows[:, used]
    return Normal(int(used.sum()), *products_of(rows, point))


@dataclass(frozen=True)
class Offset:
    """What groups of samples have together, by a normal number each, that is known to
    be 0 up to a deviation. labels : (T, h, w), the group of each sample. along : what a
    sample has of it."""

    name: str
    labels: Array
    sigma: float
    along: Array | float = 1.0


def offsets_of(point: Point) -> list[Offset]:
    """Return the offsets that the profile says a view has."""
    frame, n = point.frame, point.view.n
    shape = point.root.shape
    rows, columns = frame.tiles.rows_and_columns()
    variances = offset_variances(frame)
    found = []
    shared = (("rows", "row_noise", rows), ("frame", "black_level_drift", np.int64(0)))
    for name, effect, labels in shared:
        if effect in variances:
            sigma = float(np.sqrt(variances[effect] / n))
            found.append(Offset(name, np.broadcast_to(labels, shape), sigma))
    of_columns = point.patterns.get(COLUMN_PATTERN)
    if of_columns is not None:
        sigma = float(np.sqrt(np.mean(of_columns)))
        found.append(Offset("columns", np.broadcast_to(columns, shape), sigma))
    if point.view.is_chart:
        sigma = point.excess.patches * np.sqrt(max(point.charts, 1))
        light = np.maximum(point.base, 0)
        found.append(Offset("patches", point.view.patches, sigma, light))
    return [one for one in found if one.sigma > 0]


@dataclass(frozen=True)
class _Offsets:
    """Those of the used samples of a view: G groups, of which any two may have some
    samples in common, as rows and columns have.

    own : (n, G) what a sample has of each, in standard deviations. sigmas : (G,), how
    large each may be. are_columns : (G,) which are of the column pattern. precision :
    (G, G) of them."""

    own: csr_array
    sigmas: Array
    are_columns: NDArray[np.bool_]
    precision: Array

    @classmethod
    def of(cls, point: Point) -> "_Offsets":
        used = point.root > 0
        parts = [csr_array((int(used.sum()), 0))]
        sigmas, are_columns = [np.zeros(0)], [np.zeros(0, bool)]
        for one in offsets_of(point):
            groups, label = np.unique(one.labels[used], return_inverse=True)
            own = (point.root * one.along)[used]
            at = np.arange(len(own)), label
            parts.append(csr_array((own, at), shape=(len(own), len(groups))))
            sigmas.append(np.full(len(groups), one.sigma))
            are_columns.append(np.full(len(groups), one.name == "columns"))
        whole, sigma = csr_array(hstack(parts)), np.concatenate(sigmas)
        precision = (whole.T @ whole).toarray() + np.diag(sigma**-2)
        return cls(whole, sigma, np.concatenate(are_columns), precision)

    def likeliest(self, along: Array) -> Array:
        """Return (K, G), the offsets of most likelihood. along : (K, G), what samples
        have of them."""
        if not along.size:
            return along
        return np.asarray(cho_solve(cho_factor(self.precision), along.T).T)


def products_of(rows: Array, point: Point) -> tuple[Array, Array | float]:
    """Return A A^T of the samples that are used, in which offsets are integrated out;
    and A S A^T, S the variance of fixed patterns, which all frames of a camera have in
    common, in units of that of a sample; 0 where the profile states none.

    rows : (K, n) of them."""
    offsets = _Offsets.of(point)
    along = np.asarray(rows @ offsets.own)
    found = offsets.likeliest(along)
    products = _summed(rows) - along @ found.T
    used = point.root > 0
    fixed = sum(v for name, v in point.patterns.items() if name != COLUMN_PATTERN)
    share = (np.broadcast_to(fixed, used.shape)[used] * point.root[used] ** 2).clip(0)
    shared = _summed(rows, share) if share.any() else 0.0
    if offsets.are_columns.any():
        # Of an offset that is integrated out, so much is left in a score.
        left = (found / offsets.sigmas)[:, offsets.are_columns]
        shared = shared + left @ left.T
    return products, shared


def _summed(rows: Array, weights: Array | None = None) -> Array:
    """Return the products of rows (K, n), in double precision, in pieces so that they
    do not depend on threads."""
    size = 8192
    products = np.zeros((len(rows), len(rows)))
    for first in range(0, rows.shape[1], size):
        part = rows[:, first : first + size].astype(np.float64)
        other = part if weights is None else part * weights[first : first + size]
        products += part @ other.T
    return products


def without_offsets(z: Array, point: Point) -> Array:
    """Return residuals (n,) of the used samples without their likeliest offsets."""
    offsets = _Offsets.of(point)
    [found] = offsets.likeliest(np.asarray(z[None] @ offsets.own))
    return np.asarray(z - offsets.own @ found)


def derivatives(point: Point, effect: Effect) -> list[Array]:
    """Return those of the mean by each parameter of an effect, (T, h, w) each."""
    numbers = np.flatnonzero(effect.is_used)
    return [derivative(point, effect, int(number)) for number in numbers]


def derivative(point: Point, effect: Effect, number: int) -> Array:
    """Return that by one parameter of an effect, (T, h, w)."""
    term = point.model.term(effect.name)
    moved = effect.null if term is None else term.values.copy()
    step = effect.step
    moved[number] += step
    ahead = mean_of(point.model.with_effect(effect, moved), point.frame)
    if effect.affine:
        return np.asarray((ahead - point.base) / step)
    moved[number] -= 2 * step
    behind = mean_of(point.model.with_effect(effect, moved), point.frame)
    return np.asarray((ahead - behind) / (2 * step))


def by_light(point: Point, change: Array) -> Array:
    """Return the derivative of the mean by a change (T, 3, H, W) of camera RGB."""
    frame = point.frame
    size = max(float(np.abs(change).max()), LEAST_LIGHT)
    step = STEP * max(float(frame.camera.max()), LEAST_LIGHT) / size
    ahead = mean_of(point.model, frame, frame.camera + step * change)
    return np.asarray((ahead - point.base) / step)


def by_nuisances(point: Point, nuisances: Iterable[Nuisance]) -> Iterator[Array]:
    """Yield the derivative of the mean by each nuisance, (T, h, w); of several that
    are one change it is worked out once."""
    change, column = None, np.zeros(0)
    for one in nuisances:
        if one.change is not change:
            change, column = one.change, by_light(point, one.change)
        yield column * one.down * one.across


def mean_of(model: Model, frame: Frame, camera: Array | None = None) -> Array:
    """Return the mean of a frame, as if no well were full.

    camera : in the place of the frame's."""
    noiseless = [
        (name, values)
        for name, values in registry_values(model, frame)
        if registered()[name]["stage"] != NOISE
    ]
    given = None if camera is None else camera.astype(np.float32)
    return by_registry(model, frame, noiseless, given)[0].astype(np.float64)
