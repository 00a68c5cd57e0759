# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Darks and flats: what their statistics name by one model."""

import math
import os
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.effects.catalogue import names as every_name
from cg2raw.diagnose.effects.registry import listed_parameters
from cg2raw.diagnose.levels_of_flats import LevelsOfFlats, doubts_of
from cg2raw.diagnose.stated_shapes import StatedShapes
from cg2raw.diagnose.uniform_frames import UniformFrames, uniform_frames
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.amplifier_mismatch import (
    AmplifierMismatch,
    amplifier_mismatch,
    unit_of,
)
from cg2raw.model.dark_levels import LEVELS
from cg2raw.model.evaluation import Parameters
from cg2raw.model.fit import Fit, fit, gain_of
from cg2raw.model.flat_levels import FlatLevels
from cg2raw.model.full_well import NAME as WELL
from cg2raw.model.full_well import FullWell
from cg2raw.model.lags import NAMES as SHARED
from cg2raw.model.lags import lags_of
from cg2raw.model.profile_values import (
    OF_EFFECTS,
    profile_lags,
)
from cg2raw.model.selection import LAMP, OF_LENS, Selection, selection
from cg2raw.model.shapes import shapes
from cg2raw.model.shapes.heavy_tailed_noise import NAME as TAILS
from cg2raw.model.values import Value, effect_values
from cg2raw.normal import FEWEST_COUNT
from cg2raw.sensor import Sensor
from cg2raw.statistics.constant import Array, ConstantStatistics

TRAINING, VALIDATION, TEST = GROUPS
NOISE_TABLE = ("read_noise", "shot_noise")  # what a profile without noise says not
LARGER = "take frames at a gain at which noise is half a code or more"
ONE_FLAT = (
    "Flats differ in shape by more than their noise: mains flicker, or a lamp or lens "
    "that moved, is in no finding; take two flats of each split, which tell."
)
TWO_CODES = (
    "Darks have two codes, or hardly a pixel another: the share of each tells noise or "
    "the black level, which is taken from the profile; take darks at a higher gain."
)


class WithinCode(ValueError):
    """Noise so small that codes do not tell it."""


@dataclass(frozen=True)
class DarksAndFlats:
    """frames : that decide; their statistics are as read. names : best first. least :
    nats that a name needs. values : of all that the frames show, by training and
    validation frames together, of which both is the fit. statistics : of all splits,
    without steps between amplifiers and shapes that the profile states; as_taken : with
    these shapes. amplifiers : how halves differ. stated : the profile's shapes."""

    captures: CaptureSet
    frames: UniformFrames
    names: Sequence[str]
    selection: Selection
    least: float
    values: Sequence[Value]
    both: Fit
    statistics: ConstantStatistics
    as_taken: ConstantStatistics
    amplifiers: AmplifierMismatch
    stated: StatedShapes

    @property
    def profile(self) -> Array:
        """(n,) parameters as the profile has them."""
        return self.frames.profile

    @cached_property
    def shown(self) -> frozenset[str]:
        """Effects that the frames can show, named or not."""
        of_levels = self.levels_of(self.statistics.of_splits(GROUPS[:2]), self.both)
        flats = of_levels.names if of_levels is not None else []
        others = set(self.selection.gains) - set(LEVELS)
        return frozenset([*others, *self.selection.levels, *flats])

    def levels_of(
        self, statistics: ConstantStatistics, fit: Fit, named: Collection[str] = ()
    ) -> FlatLevels | None:
        """Return the levels of flats of some groups. named : as of LevelsOfFlats."""
        flats = LevelsOfFlats(self.captures, self.frames, self.stated, 0.0)
        return flats.of(statistics, fit, named)


def darks_and_flats(
    captures: CaptureSet,
    alpha: float = 0.01,
    names: Collection[str] | None = None,
    say: Callable[[str, float], None] = lambda text, share: None,
    saved: str | os.PathLike[str] | None = None,
) -> DarksAndFlats:
    """Return what darks and flats of a capture set name.

    alpha : chance of a false name. names : which may be named; None for all. say : is
    called with what is being done and the share that is done. saved : a file of
    saved_statistics. Raises ValueError where their noise is not known, WithinCode if
    for their codes, and for a file that is not of them."""
    sensor, white = captures.sensor, captures.sensor.signal_range
    least = math.log(len(every_name()) / alpha)  # each name may be false
    frames = uniform_frames(
        captures, least, lambda x: say("reading darks and flats", 0.5 * x), saved
    )
    notes, profile, stated = [*frames.notes], frames.profile, StatedShapes()
    may_differ = names is None or MISMATCH in names
    amplifiers = amplifier_mismatch(
        frames.statistics,
        (TRAINING, VALIDATION, TEST),
        least if may_differ else math.inf,
        _steps(sensor),
    )
    whole = as_taken = amplifiers.taken_off(frames.statistics)
    if not frames.are_divided:
        stated = StatedShapes.of(sensor, whole)
        profile = stated.added_to(profile, Parameters(len(whole.planes)))
        whole = stated.without(whole, profile)
    splits = [whole.of_splits([split]) for split in (TRAINING, VALIDATION)]
    both = whole.of_splits((TRAINING, VALIDATION))
    _check_codes(both)
    say("fitting darks and flats", 0.55)
    together = fit(both, profile)
    # What is new in every flat, one flat does not show: those of both splits do.
    lamp = together.parameters.are(LAMP) & together.known
    usual, fits = np.where(lamp, together.theta, profile), list[Fit]()
    for statistics in splits:
        say("fitting darks and flats", 0.65 + 0.05 * len(fits))
        fits.append(fit(statistics, usual))
    if not all(one.is_settled for one in fits):
        raise WithinCode(
            f"{frames.captures[0].name}: noise lies within a code, and what codes hide "
            f"of these frames has several explanations; {LARGER}"
        )
    is_shown = (fits[0].known & fits[1].known)[lamp].any() or not lamp.any()
    if not is_shown and gain_of(lamp, together.theta, together, profile, least) > least:
        notes.append(ONE_FLAT)
    if both.dark_codes == 2:
        notes.append(TWO_CODES)
    say("dropping each name", 0.75)
    hot = listed_parameters(sensor, "hot_pixels")
    of_shapes = shapes(
        whole,
        (TRAINING, VALIDATION),
        (fits[0], fits[1]),
        None if hot is None else (hot["fraction"], hot["rate"] * white),
    )
    tails = of_shapes.found.get(TAILS)
    has_tails = tails is not None and tails.nats > least
    null = profile_lags(sensor)
    first, second = (
        lags_of(one, found, profile, has_tails, null)
        for one, found in zip(splits, fits, strict=True)
    )
    allowed = stated.allowed(whole)
    for name, variance in amplifiers.allowed(whole.planes[0].shape):
        allowed[name] = allowed.get(name, 0.0) + variance
    if first is None or second is None:
        for name in OF_LENS:
            allowed[name] = allowed.get(name, 0.0) + _filtered(together, profile)
    found = selection(
        fits[0],
        fits[1],
        profile,
        least,
        (first, second) if first is not None and second is not None else None,
        of_shapes,
        allowed,
        together,
    )
    named, may_be = found.kept(least), {*(every_name() if names is None else names)}
    flats = LevelsOfFlats(captures, frames, stated, of_shapes.unseen_dust)
    of_levels = flats.names_in_doubt(
        [*zip(splits, fits, strict=True)],
        (both, together),
        named,
        least,
        doubts_of(found.gains, named, both, together) & may_be,
        {name: others for name, others in found.alike.items() if name in named},
    )
    gains, alike = {**found.gains, **of_levels.gains}, dict(found.alike)
    for name, others in of_levels.alike.items():
        alike[name] = (*alike.get(name, ()), *sorted({*others} & may_be))
    if frames.well is not None:
        gains[WELL] = _nats_of_well(frames.well, sensor)
    if amplifiers.errors:
        gains[MISMATCH] = amplifiers.gain
    asked = gains.keys() if names is None else gains.keys() & {*names}
    not_tested = untested(sensor) - {*stated.names}
    if untold := sorted(not_tested & asked):
        notes.append(
            f"The profile states {', '.join(untold)}: darks and flats are not asked "
            "whether it is as strong."
        )
    asked = asked - not_tested - {*(() if frames.has_noise else NOISE_TABLE)}
    gains = {name: gain for name, gain in gains.items() if name in asked}
    found = replace(found, gains=gains, alike=alike)
    say("measuring what was found", 0.9)
    kept = [s for s in of_shapes.found.values() if s.name in found.kept(least)]
    beyond = of_shapes.whole if has_tails else (1.0, 0.0)
    values = tuple(effect_values(both, together, profile, white, kept, beyond))
    return DarksAndFlats(
        captures,
        replace(frames, profile=profile, notes=notes),
        found.kept(least),
        found,
        least,
        values,
        together,
        whole,
        as_taken,
        amplifiers,
        stated,
    )


def _check_codes(statistics: ConstantStatistics) -> None:
    """Raise WithinCode where hardly a sample of darks lies off the commonest code in
    two frames that repeat each other: chance in their number is read as a pattern."""
    darks = np.flatnonzero(~statistics.is_flat)
    frames = statistics.frames[darks]
    both_off, most = np.zeros(len(darks)), np.zeros(len(darks))
    for plane in statistics.planes:
        codes = plane.codes[darks].astype(float)
        off = 1 - codes.max(axis=1) / codes.sum(axis=1)
        both_off += plane.unmasked * off**2 * np.maximum(frames * (frames - 1) / 2, 1)
        most = np.maximum(most, off)
    for g in np.flatnonzero(both_off < FEWEST_COUNT):
        raise WithinCode(
            f"{statistics.groups[darks[g]].frames[0]}: noise lies within a code: all "
            f"but {most[g]:.2%} of its pixels have one code, and noise is not told "
            f"from patterns; {LARGER}"
        )


def _filtered(found: Fit, profile: Array) -> float:
    """Return the variance of a smooth coefficient of flats, relative to light, that
    noise has besides if a filter, which no repeats show, took it from pixels alone."""
    more = [0.0]
    for plane in found.likelihood.planes:
        lit = plane.light > 0
        less = plane.noise(profile) - plane.noise(found.theta)
        more += (less[lit] / plane.frames[lit] / plane.light[lit] ** 2).tolist()
    return max(more)


def _steps(sensor: Sensor) -> dict[str, float]:
    """Return the steps between amplifiers that a profile states, DN or relative."""
    stated = listed_parameters(sensor, MISMATCH) or {}
    return {n: x * unit_of(n, sensor.signal_range) for n, x in stated.items()}


def _nats_of_well(well: FullWell, sensor: Sensor) -> float:
    """Return what a full well gains; of one that the profile states, if it is
    another."""
    stated = listed_parameters(sensor, WELL)
    if stated is None:
        return well.nats
    known = (1 - stated["below_white"]) * sensor.signal_range
    return min(well.nats, ((well.level - known) / well.error) ** 2 / 2)


def untested(sensor: Sensor) -> set[str]:
    """Return the effects that a profile states and darks and flats cannot test: it says
    a law or a shape, and a variance of what is not masked is what they measure."""
    stated = {entry["name"] for entry in sensor.effects or ()}
    stated |= {TAILS} & {*sensor.noise_effects}
    tested = {*OF_EFFECTS, *NOISE_TABLE, *SHARED, WELL, MISMATCH}
    tested |= {"black_level", "hot_pixels"}
    return stated - tested | stated & {"dark_current_nonuniformity"}
