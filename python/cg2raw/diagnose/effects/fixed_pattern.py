# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""FixedPattern: the family of effects that are a map of the sensor."""

from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np
from scipy.stats import chi2

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Estimator,
    Gain,
    Parameter,
    Predicted,
    SensorMap,
    Values,
    Whitened,
)
from cg2raw.diagnose.effects.families import TEMPORAL
from cg2raw.diagnose.effects.registry import listed_parameters, registered
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.response import Response
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

MEDIAN_SQUARE = 0.4549  # of a normal value of variance 1
LEAST_SHARE = 1e-3  # of a map's variance, that frames tell of it

Layout = Literal["pixels", "columns", "sparse", "jumps", "spots"]


class FixedPattern(Effect):
    """A map that is the same in all frames; its value is the map's standard deviation.

    layout : "pixels" each of their own, "columns" that share a value, "sparse":
        few pixels have any, "jumps": few have a variance of their own, which whitens
        residuals and moves no prediction, or "spots": smooth, dark where there are any.
    is_log_normal : its pixels' values are, and their median is 0; else normal.
    is_charge : the map adds charge, which has shot noise.
    is_offset : it adds the same to all frames.
    lacks_slow_part : a slow map is shading, and not of the pixels.
    has_long_tails : a few pixels are far out, and no other effect has them."""

    estimator: ClassVar[Estimator] = "fixed pattern"
    measured_by_uniform_frames: ClassVar[bool] = True
    step: ClassVar[float] = 0.01
    search: ClassVar[tuple[Parameter, ...]] = (Parameter("sigma", 0.0, 1.0),)
    families: ClassVar[frozenset[str]] = frozenset({TEMPORAL})
    signature: ClassVar[frozenset[str]] = frozenset({"map"})
    layout: ClassVar[Layout] = "pixels"
    is_log_normal: ClassVar[bool] = False
    is_charge: ClassVar[bool] = False
    is_offset: ClassVar[bool] = False
    lacks_slow_part: ClassVar[bool] = False
    has_long_tails: ClassVar[bool] = False

    @cached_property
    def fills_well(self) -> bool:
        """Whether it acts before a full well is cut."""
        stage = registered(self.cfa)[self.name]["stage"]
        return self.acts_on_light or stage == "response"

    def sensitivity(self, frame: Frame, photons: Array) -> Array | float:
        """Return what the map is multiplied by to be charge, in a frame."""
        return 1.0

    def slope(
        self, frame: Frame, exposed: Array, response: Response | None
    ) -> Array | float:
        """Return the same for the signal, which a response may bend."""
        if response is None or not self.fills_well:
            return self.sensitivity(frame, np.maximum(exposed, 0))
        return response.slope * self.sensitivity(frame, response.charge)

    def shown(self, frame: Frame, p: Prediction) -> Array | float:
        """Return the same as far as pixels show it, which a full well hides."""
        slope = self.slope(frame, p.exposed, p.response)
        return slope * (p.below if self.fills_well else 1.0)

    def whiten_by_map(
        self, z: Array, p: Prediction, sensor_map: SensorMap | None
    ) -> Whitened:
        """Return residuals and the log of a determinant, as Effect.whiten does, of an
        effect whose map is one of variance; None: the map is not known here."""
        return z, 0.0

    def standard_error(self, value: float, sensor_map: SensorMap) -> float:
        """Return that of the map's standard deviation, from the number of its values
        and what is known of each."""
        prior = max(value, 1e-12) ** 2
        known = ~np.isclose(sensor_map.variance, prior, rtol=1e-9, atol=0)
        known |= not known.any()  # else pixels that no frame has tell nothing
        count = int(known.sum())
        if self.layout == "columns":
            count = int(known.any(1).sum())
        unsure = float(np.median(sensor_map.variance[known]))
        if self.has_long_tails:  # of most values, whatever the few are
            told = float(np.median(sensor_map.mean[known] ** 2)) / MEDIAN_SQUARE
            prior = max(told + unsure, prior)
        share = 1 - unsure / prior
        return float(value / np.sqrt(2 * count) / max(share, LEAST_SHARE))

    def standard_errors(self, values: Values, sensor_map: SensorMap) -> list[float]:
        """Return those of all its values."""
        return [self.standard_error(float(values[0]), sensor_map)]

    def interval(
        self, value: float, sensor_map: SensorMap
    ) -> tuple[float, float] | None:
        """Return the 95 % interval of its first value; None for the normal one by its
        standard error."""
        return None

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain | None:
        """The map is learnt from the fit frames as far as their noise lets it."""
        if not fitted:
            return None
        first = next(frame for frame, _ in selected if frame.samples is None)
        shape, tiles = first.signal.shape, first.tiles
        of_columns = self.layout == "columns"

        def told(group: Predicted) -> list[Array]:
            parts = []
            for frame, p in group:
                if frame.signal.shape == shape:
                    sensitivity = self.sensitivity(frame, np.maximum(p.exposed, 0))
                    used = frame.keep & ~frame.censored
                    part = used * sensitivity**2 / p.variance
                    parts.append(tiles.over_columns(part) if of_columns else part)
            return parts

        known, shown = sum(told(fitted)), told(selected)
        # Columns of tiles above each other count once.
        once = shape[1] / tiles.over_columns(np.ones(shape)) if of_columns else 1.0

        def gain(sigma: float) -> float:
            left = sigma**2 / (1 + sigma**2 * known)
            nats = [(sigma**2 * each - np.log1p(left * each)) * once for each in shown]
            return sum(float(each.sum()) for each in nats) / 2

        return gain

    def strength_of(self, stated: Mapping[str, float]) -> float:
        """Return its value, of a profile's parameters."""
        return stated[self.parameters[0]]

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """With what the profile says, if it says anything."""
        stated = listed_parameters(sensor, self.name)
        if stated is None:
            return self.size_in(values, sensor)
        said, unit = self.strength_of(stated), self.units[0]
        of_profile = {self.parameters[0]: Estimate(said, unit, (said, said))}
        found, by_profile = (self.size_in(v, sensor) for v in (values, of_profile))
        return f"{found}; by the profile, {by_profile}"

    def size(self, values: Estimates) -> str:
        return self.size_in(values, None)

    def size_in(self, values: Estimates, sensor: Sensor | None) -> str:
        """Return the same in the units of a sensor, if it is known."""
        return f"standard deviation {of_white(value_of(values, 'sigma'), sensor)}"


def share_interval(value: float, pixels: float) -> tuple[float, float]:
    """Return the 95 % interval of a share of few pixels: their number is Poisson's.

    Source: F. Garwood, Biometrika 28(3/4), 1936."""
    count = value * pixels
    low = 0.5 * chi2.ppf(0.025, 2 * count) if count > 0 else 0.0
    high = 0.5 * chi2.ppf(0.975, 2 * count + 2)
    return float(low / pixels), float(high / pixels)
