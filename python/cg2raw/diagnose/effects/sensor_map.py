# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""SensorMap: what is known of a map of the sensor."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.rate_law import RateLaw
from cg2raw.diagnose.frames.tiling import Array, Mask

SMALLEST_CHANCE = 1e-12
PLACES_OF_A_MAP = 9  # down and across a tile, where a displaced one may be
STEPS_ACROSS = 4  # of these, for every one down
ANY_REPEAT = 6  # px, of any CFA


@dataclass(frozen=True)
class SensorMap:
    """A fixed map of the sensor as the fit frames show it, on the tiles: (T, h, w) mean
    and variance. An effect's sensitivity says what it is multiplied by.

    covariance : with maps of other effects, by name, whose errors came from the same
        frames: what is wrong with an offset cancels in a rate that it was taken off.
    law : numbers of the distribution of its values, where these are not normal.
    noise_gains : what multiplied beta1 and beta2 of the noise that it was made under.
    unknown, rate_law : (T, h, w), True in pixels that no frame was given, whose rate is
        of a law with long tails: it has that of the law then, and 0 in the map.
    chance : (T, h, w) that a pixel has any, of an effect that few have; its mean is
        then the mean over both.
    told : estimates of its pixels by the frames alone, and the variances of their
        errors, of a normal map.
    beyond_law : what pixels have of values that are not of the law, by the same frames.
    """

    mean: Array
    variance: Array
    covariance: Mapping[str, Array] = field(default_factory=dict)
    law: Mapping[str, Estimate] = field(default_factory=dict)
    chance: Array | None = None
    unknown: Mask | None = None
    rate_law: RateLaw | None = None
    noise_gains: tuple[float, float] | None = None
    told: tuple[Array, Array] | None = None
    beyond_law: "BeyondLaw | None" = None

    def of_tiles(self, places: NDArray[np.intp]) -> "SensorMap":
        """Return the map on some of its tiles."""
        return replace(
            self,
            mean=self.mean[places],
            variance=self.variance[places],
            covariance={name: one[places] for name, one in self.covariance.items()},
            chance=None if self.chance is None else self.chance[places],
            unknown=None if self.unknown is None else self.unknown[places],
        )

    def displaced(self) -> Iterator["SensorMap"]:
        """Yield maps that have every pixel's numbers at another one of its colour: as
        strong, and of none of the pixels that they were made of."""
        height, width = self.mean.shape[-2:]
        share = np.broadcast_to(self.share, self.mean.shape)
        for k in range(1, PLACES_OF_A_MAP):
            places = (k * height, k * STEPS_ACROSS % PLACES_OF_A_MAP * width)
            moved = [
                place // PLACES_OF_A_MAP // ANY_REPEAT * ANY_REPEAT for place in places
            ]
            mean, variance, chance = (
                np.roll(one, moved, (-2, -1))
                for one in (self.mean, self.variance, share)
            )
            yield SensorMap(mean, variance, chance=chance)

    @property
    def share(self) -> Array | float:
        """The chance that a pixel's value is of this effect."""
        return 1.0 if self.chance is None else self.chance

    @property
    def unsure_kind(self) -> Array | float:
        """The part of the variance that is due to the chance: as much as the effect
        has less of a pixel, another has more."""
        return np.asarray(self._less * self.mean)

    def made_up(self, other: Array) -> Array:
        """Return the share (0 to 1) of what the effect has less of a pixel by its
        chance, that the map of another has more."""
        return np.clip(other / np.maximum(self._less, SMALLEST_CHANCE), 0, 1)

    @property
    def _less(self) -> Array:
        """What the effect has less of a pixel by its chance."""
        chance = np.maximum(self.share, SMALLEST_CHANCE)
        return np.asarray((1 - chance) / chance * self.mean)

    @property
    def spread(self) -> float:
        """Standard deviation of the map where it is not known."""
        return float(np.sqrt(np.mean(self.mean**2 + self.variance)))


@dataclass(frozen=True)
class BeyondLaw:
    """What pixels have of values that are not of a map's law, (T, h, w): the chance of
    any, its mean over both, and the variance of that.

    lost : nats, by what a profile says of these values, where they are not of that."""

    chance: Array
    mean: Array
    variance: Array
    lost: float = 0.0
