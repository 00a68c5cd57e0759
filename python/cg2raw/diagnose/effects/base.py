# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Effect: what the inference needs to know, beside the physics in the registry.

The registry (cg2raw.effects()) says what an effect does to a signal. A file of this
folder says the rest, and only where the default does not do.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from cg2raw.cfa import is_mono
from cg2raw.diagnose.diagnosis import Curve, Estimate
from cg2raw.diagnose.effects.registry import registered
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

Values = NDArray[np.float64]
Estimates = Mapping[str, Estimate]  # of an effect's parameters
EstimatesByEffect = Mapping[str, Estimates]
Gain = Callable[[float], float]  # nats that a strength is expected to gain
Predicted = Sequence[tuple[Frame, Prediction]]
Labels = Callable[[Frame, Prediction], NDArray[np.int64]]  # of the pixels of a frame
# (labels of the pixels of a frame, number of labels) -> label, measured over predicted
MeasuredRatio = Callable[[Labels, int], tuple[Array, Array]]


@dataclass(frozen=True)
class Parameter:
    """A number that is fitted: its bounds; 0 is none of the effect."""

    name: str
    low: float
    high: float
    unit: str = "1"


class Effect:
    """An effect that may be named; subclasses state what differs.

    name : of the registry. title : in plain words. where : what residuals look like.
    of_mean : its parameters move the mean of images, which are fitted by derivatives;
        else darks and flats decide it, and images take it as the profile states it.
    of_images : images tell it apart from others where flats do not; what else moves the
        mean is asked of them where no darks and flats show it.
    fitted : parameters that are fitted, if they are not the registry's own. unfitted :
        those of which images tell nothing.
    bounds : narrower than the registry's, by the beginning of a parameter's name.
    step : of numerical derivatives.
    affine : means are, in its parameters.
    shapes : parameters that say nothing where all others are 0.
    signature : what it changes, for the captures that discriminate it from others (see
        discriminating_captures); told_apart : the same for one other effect.
    from_means : tables of patch means show it: neither pixels nor places are needed,
        nor does it look like errors of the chart's own colours, the same in all frames.
    taken_up_by : effects that take up what this one's model does not describe, and the
        share of its gain up to which they are none.
    bayer_only : other CFAs have none. nameable : False for what is never looked for.
    detailed : with the parameters of its `detail`. cfa : the sensor's; see `of_cfa`."""

    name: ClassVar[str] = ""
    title: ClassVar[str] = ""
    where: ClassVar[str] = ""
    of_mean: ClassVar[bool] = True
    fitted: ClassVar[tuple[Parameter, ...]] = ()
    unfitted: ClassVar[frozenset[str]] = frozenset()
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {}
    step: ClassVar[float] = 1e-3
    affine: ClassVar[bool] = True
    shapes: ClassVar[frozenset[str]] = frozenset()
    signature: ClassVar[frozenset[str]] = frozenset()
    told_apart: ClassVar[Mapping[str, str]] = {}
    from_means: ClassVar[bool] = False
    taken_up_by: ClassVar[Mapping[str, float]] = {}
    bayer_only: ClassVar[bool] = False
    nameable: ClassVar[bool] = True
    cfa: str | None = None
    detailed: bool = False

    @property
    def of_images(self) -> bool:
        return self.of_mean and not self.scales

    # How it is predicted.

    # Of the noise model: its values are the log of a factor of these betas.
    scales: ClassVar[Literal["", "beta1", "beta2"]] = ""
    whitens_variance: ClassVar[bool] = False  # of what pixels share

    @property
    def predicted(self) -> bool:
        """Whether the registry moves a prediction by its values, on top of those that
        the profile has."""
        return self.of_mean and not self.scales

    def variance_left(self, values: Values) -> float:
        """Return what it leaves of the variance of white noise, if it blends pixels."""
        return 1.0

    def expected_gain(self, selected: Predicted) -> Gain | None:
        """Return what a strength gains on frames; None where derivatives say it."""
        return None

    # How it comes into a profile.

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        """Return the fitted values by which a profile draws it beyond its
        variance; None if not. row : of its noise table. read_noise : the deviation."""
        return None

    def variance_in_table(self, sensor: Sensor, row: Mapping[str, Any]) -> float:
        """Return the part of a noise table's beta2 that is its own."""
        return 0.0

    def change_noise_table(self, profile: dict[str, Any], values: Values) -> bool:
        """Write it into a profile's noise table; False if that is not its place."""
        return False

    # What is said of it.

    in_photon_transfer: ClassVar[bool] = False  # it moves that curve

    def size(self, values: Estimates) -> str:
        """Return how strong it is, in words with numbers."""
        parts = (
            f"{name} {e.value:.4g} ({e.ci95[0]:.4g} to {e.ci95[1]:.4g})"
            for name, e in values.items()
        )
        return ", ".join(parts)

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """Return the same of one sensor, whose levels and shape are known."""
        return self.size(values)

    def curve(
        self, values: Values, estimates: Estimates, measured: MeasuredRatio
    ) -> Curve | None:
        """Return its curve beside what was measured; None if it is none."""
        return None

    # Parameters; nothing below is meant to be overridden.

    def of_cfa(self, cfa: str) -> "Effect":
        """Return the effect as a sensor of a CFA has it: without filters it has one
        site, and no parameters that tell colours apart."""
        if not is_mono(cfa):
            return self
        one = type(self)()
        one.cfa = cfa
        return one

    @cached_property
    def detail(self) -> frozenset[str]:
        """Parameters that files may leave out, and that stay at 0 until the end."""
        return frozenset(p["name"] for p in self._known if p["optional"])

    @cached_property
    def in_detail(self) -> "Effect | None":
        """The effect with the parameters of its detail; None if it has them."""
        if self.detailed or not self.detail:
            return None
        one = type(self)()
        one.cfa, one.detailed = self.cfa, True
        return one

    @property
    def used(self) -> list[str]:
        """Parameters that images are fitted by."""
        left_out = self.unfitted | (set() if self.detailed else self.detail)
        return [name for name in self.parameters if name not in left_out]

    @cached_property
    def is_used(self) -> NDArray[np.bool_]:
        """Which parameters these are."""
        return np.isin(self.parameters, self.used)

    def with_used(self, values: Values) -> Values:
        """Return all parameters, of which those used have values."""
        every = self.null
        every[self.is_used] = values
        return every

    @property
    def _known(self) -> Sequence[Mapping[str, Any]]:
        """The registry's parameters."""
        known: list[dict[str, Any]] = registered(self.cfa)[self.name]["parameters"]
        return known

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        return tuple(parameter.name for parameter in self._fitted)

    @cached_property
    def units(self) -> tuple[str, ...]:
        return tuple(parameter.unit for parameter in self._fitted)

    @cached_property
    def low(self) -> Values:
        return np.array([parameter.low for parameter in self._fitted], float)

    @cached_property
    def high(self) -> Values:
        return np.array([parameter.high for parameter in self._fitted], float)

    @property
    def null(self) -> Values:
        return np.zeros(len(self._fitted))

    def clipped(self, values: Values) -> Values:
        """Return values within the bounds of the fit."""
        return np.clip(values, self.low, self.high)

    def is_possible(self, values: Values) -> bool:
        """Whether light can do what all of its values, with a profile's, say."""
        return True

    def within_registry_bounds(self, values: Values) -> Values:
        """Return values within the bounds of the registry: a found value and the
        profile's are each within them, and their sum need not be."""
        low, high = ([p[end] for p in self._known] for end in ("min", "max"))
        return np.clip(values, low, high)

    @cached_property
    def _fitted(self) -> tuple[Parameter, ...]:
        if self.fitted:
            return self.fitted
        return tuple(
            Parameter(p["name"], *self._bounds_of(p), p["unit"]) for p in self._known
        )

    def _bounds_of(self, parameter: Mapping[str, Any]) -> tuple[float, float]:
        for start, bounds in self.bounds.items():
            if parameter["name"].startswith(start):
                return bounds
        return parameter["min"], parameter["max"]
