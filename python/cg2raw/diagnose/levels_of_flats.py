# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Levels of flats of known light: what they name, and what else may have moved them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.cfa import sites_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.stated_shapes import StatedShapes
from cg2raw.diagnose.uniform_frames import UniformFrames
from cg2raw.model.dark_levels import BLACK, DRIFT
from cg2raw.model.fit import Fit
from cg2raw.model.flat_levels import MATRIX, FlatLevels, flat_levels, levels_set
from cg2raw.model.selection import OF_LENS
from cg2raw.model.shapes.dust import NAME as DUST
from cg2raw.model.smallest_set import SmallestSet
from cg2raw.sensor import Sensor
from cg2raw.statistics.constant import Array, ConstantStatistics

Fitted = tuple[ConstantStatistics, Fit]  # of some splits


@dataclass(frozen=True)
class LevelsOfFlats:
    """Those of a capture set. stated : shapes of the profile, which statistics lack.
    unseen_dust : of all light, what dust may take outside of its spots."""

    captures: CaptureSet
    frames: UniformFrames
    stated: StatedShapes
    unseen_dust: float

    def of(
        self,
        statistics: ConstantStatistics,
        found: Fit,
        named: Collection[str],
        doubted: Collection[str] = (),
    ) -> FlatLevels | None:
        """Return the levels of some splits; None if none are of known light, and of
        parts of frames, which light that falls off reaches by less.

        found : their fit. named, doubted : as of flat_levels."""
        if self.frames.are_divided:
            return None
        sensor = self.captures.sensor
        predicted, greys = predicted_of(self.frames.captures, statistics, sensor)
        return flat_levels(
            found,
            predicted,
            sites_of(sensor.cfa),
            white=sensor.signal_range,
            light=self.captures.uncertainty.get("light", 0.0),
            nuisances=self.captures.nuisances,
            named=named,
            doubted=doubted,
            shaded=self.stated.mean,
            unseen_dust=self.unseen_dust,
            greys=greys,
        )

    def names(
        self,
        splits: Sequence[Fitted],
        named: Collection[str],
        least: float,
        doubted: Collection[str] = (),
    ) -> SmallestSet:
        """Return what levels name. splits : training and validation. least : nats that
        a name needs."""
        training, validation = (self.of(*one, named, doubted) for one in splits)
        if training is None or validation is None:
            return SmallestSet({}, {})
        return levels_set(training, validation, least)

    def names_in_doubt(
        self,
        splits: Sequence[Fitted],
        both: Fitted,
        named: Collection[str],
        least: float,
        doubts: Collection[str],
        alike: Mapping[str, Collection[str]],
    ) -> SmallestSet:
        """Return what levels name, and for each name, of `doubts` too, what may have
        moved them instead: without the name, then, both splits together need none.

        alike : by name, what may be in the place of one of `named`, which may have made
        the middle of frames brighter than it is."""
        found = self.names(splits, named, least)
        needed = {name for name, gain in found.gains.items() if gain > least}
        moved = {name: {*found.alike[name]} for name in needed}
        for other in sorted(doubts, reverse=True) if needed else ():
            again = self.names([both, both], named, least, [other]).gains
            left = {name for name, gain in again.items() if gain > least}
            for name in needed - left if left < needed else ():
                if not (other == OF_LENS[1] and OF_LENS[0] in moved[name]):
                    moved[name].add(other)
        for shading in {*OF_LENS} & alike.keys() if needed else ():
            rest = [name for name in named if name != shading]
            again = self.names([both, both], rest, least).gains
            for name in needed - {name for name, gain in again.items() if gain > least}:
                moved[name] |= {*alike[shading]}
        return SmallestSet(found.gains, moved)


def doubts_of(
    shown: Collection[str],
    named: Collection[str],
    statistics: ConstantStatistics,
    found: Fit,
) -> set[str]:
    """Return what may move the levels of both splits alike: what is too little to be
    named, and what such frames do not show.

    shown : names of which frames show something. statistics, found : of both splits."""
    doubts = {*OF_LENS} & {*shown} - {*named} | {MATRIX} | {DUST} & {*named}
    doubts |= {BLACK} if statistics.is_flat.all() else set()
    is_known = found.known[found.parameters.of(DRIFT)]
    return doubts if is_known else doubts | {DRIFT}


def predicted_of(
    captures: Sequence[Capture], statistics: ConstantStatistics, sensor: Sensor
) -> tuple[Array, Array]:
    """Return (sites, G) DN above black that a profile predicts of flats, nan of darks
    and 0 where the light is not known, and those of grey light that is white, 1 where
    there is none."""
    by_name = {capture.name: capture for capture in captures}
    letters, white = sites_of(sensor.cfa), sensor.signal_range
    found = np.full((len(letters), len(statistics.groups)), np.nan)
    greys = np.ones_like(found)
    places = ["RGB".index(letter) if letter in "RGB" else 1 for letter in letters]
    for g, info in enumerate(statistics.groups):
        capture = by_name[info.frames[0]]
        if info.kind != "flat":
            continue
        if capture.scene is None:
            found[:, g] = 0.0
            continue
        rgb = np.array([[capture.scene(), (1.0, 1.0, 1.0)]], np.float32)
        light = sensor.illuminant(capture.illuminant, capture.as_shot)
        camera = sensor.to_camera(rgb, illuminant=light, highlights=False)[0] * white
        found[:, g], greys[:, g] = camera[:, places]
    return found, greys
