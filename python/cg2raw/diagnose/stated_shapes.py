# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Stated shapes: what a profile says of the mean image, taken off the statistics.

What is left is what frames show beyond the profile."""

from dataclasses import dataclass, replace
from operator import sub
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.model.evaluation import Parameters
from cg2raw.model.mean_images import coefficients_of
from cg2raw.sensor import Sensor
from cg2raw.statistics.constant import (
    FIELD,
    PIXEL,
    Array,
    ConstantStatistics,
    PlaneStatistics,
    polynomials,
)

# Glow of an amplifier is far from the registry's: it stays as frames have it.
NAMES = ("bias_structure", "lens_shading", "color_shading")
# Of the variance of a stated shape: a true one is no polynomial to better than a tenth.
SHAPE_ERROR = 0.01
HALF = 0.5  # of white, light that nothing clips


class Parts(NamedTuple):
    """Of an image of a plane, (h, w): its mean, and rows, columns and field as of
    PlaneStatistics."""

    mean: float
    rows: Array
    columns: Array
    field: Array

    @classmethod
    def of(cls, image: NDArray[np.float32]) -> "Parts":
        mean = float(image.mean(dtype=float))
        down, across = (polynomials(n)[1 : FIELD + 1] for n in image.shape)
        field = np.zeros((FIELD, FIELD))
        field[: len(down), : len(across)] = down @ image @ across.T
        rows, columns = (image.mean(axis=n, dtype=float) - mean for n in (1, 0))
        return cls(mean, rows, columns, field)

    def times(self, factor: float) -> "Parts":
        """Return the parts of this image times a factor."""
        rows, columns, field = (factor * one for one in self[1:])
        return Parts(factor * self.mean, rows, columns, field)


@dataclass(frozen=True)
class StatedShapes:
    """names : of NAMES, that the profile states. offset : of each plane, DN, in all
    frames; light : relative to that in the middle."""

    names: tuple[str, ...] = ()
    offset: tuple[Parts, ...] = ()
    light: tuple[Parts, ...] = ()

    @classmethod
    def of(cls, sensor: Sensor, statistics: ConstantStatistics) -> "StatedShapes":
        """Return those of a profile, for frames of the statistics."""
        stated = {name: listed_values(sensor, name) for name in NAMES}
        given = [(name, values) for name, values in stated.items() if values]
        if not given:
            return cls()
        side = statistics.side
        height, width = (side * n for n in statistics.planes[0].shape)
        white = sensor.signal_range

        def planes(level: float) -> list[Parts]:
            mean, _, _ = _core.predict_blocks(
                sensor.profile,
                given,
                np.full((1, 3, height, width), level, np.float32),
                np.zeros((1, 2), np.int32),
                (height, width),
                0,
                (1.0, 1.0, 1.0),
                0.0,
                None,
            )
            sites = np.ndindex(side, side)
            return [Parts.of(mean[0][r::side, c::side]) for r, c in sites]

        dark, lit = planes(0.0), planes(HALF)
        offset = tuple(one.times(white) for one in dark)
        light = tuple(
            Parts(*map(sub, one, black)).times(1 / HALF)
            for one, black in zip(lit, dark, strict=True)
        )
        return cls(tuple(name for name, _ in given), offset, light)

    @property
    def mean(self) -> Array:
        """(planes,) the mean of light over that in the middle; (1,) without shapes."""
        return np.array([one.mean for one in self.light] if self.names else [1.0])

    def added_to(self, profile: Array, parameters: Parameters) -> Array:
        """Return (n,) parameters of a profile with the means of these shapes, which
        frames' levels have and its own do not."""
        found = profile.copy()
        for site, one in enumerate(self.offset):
            found[parameters.of("black_level", site)] += one.mean
        return found

    def without(
        self, statistics: ConstantStatistics, profile: Array
    ) -> ConstantStatistics:
        """Return statistics of frames without what these shapes add to parts of mean
        images; levels stay. profile : (n,) parameters, with the means."""
        if not self.names:
            return statistics
        parameters = Parameters(len(statistics.planes))
        time = np.array([group.charge_time for group in statistics.groups])
        is_flat = statistics.is_flat
        planes = []
        for site, plane in enumerate(statistics.planes):
            black = float(profile[parameters.of("black_level", site)])
            rate = float(profile[parameters.of("dark_current")])
            if not is_flat.all():
                darks = time[~is_flat], plane.level[~is_flat]
                if np.ptp(darks[0]):
                    rate = float(np.polyfit(*darks, 1)[0])
                black = float((darks[1] - rate * darks[0]).mean())
            light = np.where(is_flat, plane.level - black - rate * time, 0.0)
            planes.append(_less(plane, light, self.offset[site], self.light[site]))
        return replace(statistics, planes=tuple(planes))

    def allowed(self, statistics: ConstantStatistics) -> dict[str, float]:
        """Return the variance of a coefficient that frames may have beyond each shape
        that is stated."""
        return {name: self._allowed(name, statistics) for name in self.names}

    def _allowed(self, name: str, statistics: ConstantStatistics) -> float:
        every = self.offset if name == "bias_structure" else self.light
        image = Parts(*(sum(some) / len(every) for some in zip(*every, strict=True)))
        if name == "color_shading":
            image = Parts(*map(sub, self.light[0], image))
        bare = replace(
            statistics.planes[0],
            rows=image.rows[None],
            columns=image.columns[None],
            field=image.field[None],
        )
        each = coefficients_of(bare, 0, statistics.side)
        return SHAPE_ERROR * max(float((x**2).mean()) for x in each if x.size)


def _less(
    plane: PlaneStatistics, light: Array, dark: Parts, lit: Parts
) -> PlaneStatistics:
    """Return a plane whose mean images lack an offset, and light of a shape. light :
    (G,) DN, the mean."""
    less = [
        one + np.multiply.outer(light / lit.mean, more)
        for one, more in zip(dark[1:], lit[1:], strict=True)
    ]
    found = replace(
        plane,
        rows=plane.rows - less[0],
        columns=plane.columns - less[1],
        field=plane.field - less[2],
    )
    before, after = (one.products[:PIXEL].sum(axis=0) for one in (plane, found))
    return replace(found, whole=plane.whole - before + after)
