# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The noise of the baseline; estimated where the profile has none."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, nnls

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.frames.noise_model import LEAST_VARIANCE, NoiseModel
from cg2raw.normal import robust_deviation
from cg2raw.sensor import Sensor

MOST_OF_A_KIND = 6  # captures
MOST_PIXELS = 1536  # a side
BRIGHTEST_LEVEL = 0.9  # of white
BINS, FEWEST_PER_LEVEL = 25, 200  # edges of levels; pixels of a level
ERROR_OF_MEDIAN = 5.5  # variance of one pixel's squared median, of its variance
OUTLYING_LEVEL = 2.0  # standard deviations; a level beyond it counts less and less
WIDEST_NOISE = 6.0  # standard deviations of a level that its bin is wide
MOST_CLIPPED = 0.1  # of the pixels of a level, clipped


def noise_models(capture_set: CaptureSet) -> dict[float | None, NoiseModel]:
    """Return the noise of every ISO of the captures.

    Raises ValueError for an ISO that is too far from those of the profile."""
    sensor = capture_set.sensor
    models: dict[float | None, NoiseModel] = {}
    for iso in {capture.iso for capture in capture_set.captures}:
        if sensor.noise and iso is not None:
            models[iso] = _of_row(sensor, sensor.noise_at(iso))
        else:
            chosen = [
                c for c in capture_set.captures if c.iso == iso and c.means is None
            ]
            models[iso] = _estimated(sensor, chosen)
    return models


def _of_row(sensor: Sensor, row: Mapping[str, Any]) -> NoiseModel:
    """Return the noise of one ISO as the profile draws it."""
    beta2 = np.asarray(row["beta2"], float)
    own = sum(effect.variance_in_table(sensor, row) for effect in every().values())
    if own:
        beta2 = np.maximum(beta2 - own, LEAST_VARIANCE)
    read_noise = float(np.sqrt(beta2.mean()))
    drawn = {
        name: values
        for name, effect in every().items()
        if (values := effect.profile_values(sensor, row, read_noise)) is not None
    }
    return NoiseModel(tuple(row["beta1"]), tuple(beta2), drawn=drawn)


def _estimated(sensor: Sensor, captures: Sequence[Capture]) -> NoiseModel:
    """Variance against level from differences of neighbours of one colour.

    Source: A. Foi et al., IEEE Trans. Image Process. 17(10), 2008, for the model."""
    points = [
        point
        for number, capture in enumerate(_spread(captures))
        for point in _levels_and_variances(sensor, capture.raw(), number)
    ]
    if not points:
        raise ValueError(
            f"sensor {sensor.id} has no noise at these ISOs and none of the captures "
            "shows enough pixels to estimate it: give a profile with noise, and iso"
        )
    x, v, count = np.array(points).T
    slope, offset = _line(np.maximum(x, 0), v, count)
    return NoiseModel((max(slope, 1e-8),), (max(offset, 1e-10),), measured=False)


def _line(
    x: NDArray[np.float64], v: NDArray[np.float64], count: NDArray[np.float64]
) -> tuple[float, float]:
    """Return (slope, offset) of variances, each to its own share; levels with edges in
    them lie far above, and count less."""
    design = np.stack([x, np.ones_like(x)], 1)
    start, _ = nnls(design / v[:, None], np.ones_like(v))
    start = np.maximum(start, (1e-8, 1e-10))
    precision = np.sqrt(count / ERROR_OF_MEDIAN)

    def away(logs: NDArray[np.float64]) -> NDArray[np.float64]:
        errors: NDArray[np.float64] = np.log(v) - np.log(design @ np.exp(logs))
        return precision * errors

    fitted = least_squares(away, np.log(start), loss="cauchy", f_scale=OUTLYING_LEVEL)
    slope, offset = np.exp(fitted.x)
    return float(slope), float(offset)


def _spread(captures: Sequence[Capture]) -> list[Capture]:
    """Return some captures of every kind and, of a kind, of as many sets as there are:
    darks alone, which often come first, say nothing about the slope."""
    turns: dict[tuple[str, str], int] = {}
    order = []
    for number, capture in enumerate(captures):
        key = (capture.kind, capture.set)
        turns[key] = turns.get(key, 0) + 1
        order.append((turns[key], number, capture))
    chosen: dict[str, list[Capture]] = {}
    for _, _, capture in sorted(order, key=lambda item: item[:2]):
        of_kind = chosen.setdefault(capture.kind, [])
        if len(of_kind) < MOST_OF_A_KIND:
            of_kind.append(capture)
    return [capture for of_kind in chosen.values() for capture in of_kind]


def _levels_and_variances(
    sensor: Sensor, raw: NDArray[np.uint16], number: int
) -> Iterator[tuple[float, float, int]]:
    """Yield (level, variance, pixels) of pixels that are about as bright.

    Second differences cancel slopes; pixels between unlike neighbours are left out, and
    the median forgets what edges are left. DN are spread over their step first, for a
    median of few DN is coarse."""
    step = repeat_of(sensor.cfa)
    height, width = (min(n, MOST_PIXELS) for n in raw.shape)
    if width <= 2 * step:
        return
    part = raw[:height, :width]
    signal = np.asarray(sensor.signal_from_raw(part), float)
    one_dn = 1 / sensor.signal_range
    rng = np.random.default_rng(number)
    signal += one_dn * (rng.random(signal.shape) - 0.5)
    a, b, c = signal[:, : -2 * step], signal[:, step:-step], signal[:, 2 * step :]
    ends = part[:, : -2 * step], part[:, step:-step], part[:, 2 * step :]
    second, level, unlike = b - (a + c) / 2, (a + b + c) / 3, np.abs(c - a)
    usable = (np.maximum.reduce(ends) < sensor.white_level) & (level < BRIGHTEST_LEVEL)
    if usable.sum() < FEWEST_PER_LEVEL:
        return
    at_zero = (np.minimum.reduce(ends) == 0)[usable]
    second, level, unlike = second[usable], level[usable], unlike[usable]
    edges = _edges(level, second)
    bins = np.digitize(level, edges)
    for one in range(len(edges) + 1):
        chosen = np.flatnonzero(bins == one)
        if len(chosen) < FEWEST_PER_LEVEL or at_zero[chosen].mean() > MOST_CLIPPED:
            continue
        alike = chosen[unlike[chosen] <= np.median(unlike[chosen])]
        spread = robust_deviation(second[alike], 0.0)
        # Of the DN's step: it was rounded, then spread.
        variance = spread**2 / 1.5 - one_dn**2 / 6
        yield level[alike].mean(), max(variance, 1e-12), len(alike)


def _edges(level: NDArray[np.float64], second: NDArray[np.float64]) -> list[float]:
    """Return what divides levels into bins that are wide against their noise: in
    narrower ones the level is noise too, and the slope would come out too flat."""
    every = np.quantile(level, np.linspace(0, 1, BINS))
    bins = np.digitize(level, every[1:-1])
    edges, last = [], every[0]
    for one, edge in enumerate(every[1:-1]):
        here = second[bins == one]
        noise = robust_deviation(here, 0.0) if here.size else 0.0
        wide = WIDEST_NOISE * noise / np.sqrt(1.5 * 3)
        if edge - last > wide and every[-1] - edge > wide:
            edges.append(float(edge))
            last = edge
    return edges
