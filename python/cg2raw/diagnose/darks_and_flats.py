# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Darks and flats: what their statistics name by one model."""

import math
import os
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.cfa import sites_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.constant_statistics import (
    saved_statistics,
    statistics_by_split,
)
from cg2raw.diagnose.captures.residual_image import Blocks, residual_images
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.effects.catalogue import names as every_name
from cg2raw.diagnose.effects.registry import listed_parameters
from cg2raw.diagnose.stated_shapes import StatedShapes
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.amplifier_mismatch import (
    AmplifierMismatch,
    amplifier_mismatch,
    unit_of,
)
from cg2raw.model.dark_levels import LEVELS
from cg2raw.model.evaluation import Parameters
from cg2raw.model.fit import Fit, fit
from cg2raw.model.flat_levels import FlatLevels, flat_levels, level_gains
from cg2raw.model.full_well import NAME as WELL
from cg2raw.model.full_well import FullWell, full_well
from cg2raw.model.lags import NAMES as SHARED
from cg2raw.model.lags import lags_of
from cg2raw.model.profile_values import (
    OF_EFFECTS,
    profile_lags,
    profile_values,
)
from cg2raw.model.selection import Selection, selection
from cg2raw.model.shapes import shapes
from cg2raw.model.shapes.heavy_tailed_noise import NAME as TAILS
from cg2raw.model.values import Value, effect_values
from cg2raw.sensor import Sensor
from cg2raw.short_messages import plural
from cg2raw.statistics.constant import Array, ConstantStatistics
from cg2raw.statistics.temperature import set_points

TRAINING, VALIDATION, TEST = GROUPS
MOST_LISTED = 20  # lines, by number
NOISE_TABLE = ("read_noise", "shot_noise")  # what a profile without noise says not


@dataclass(frozen=True)
class DarksAndFlats:
    """names : best first. least : nats that a name needs. values : of all that the
    frames show, by training and validation frames together, of which both is the fit.
    statistics : of all splits, of the captures used, without shapes that the profile
    states; as_taken : with them. profile : (n,) parameters as the profile has them.
    notes : sentences on what was left out. has_noise : whether the profile has. well :
    None where no flat has full ones; flats that have are in no other field. stated :
    the profile's shapes. amplifiers : how halves differ, which is in no statistics.
    spoiled : darks with a residual image."""

    captures: CaptureSet
    names: Sequence[str]
    selection: Selection
    least: float
    values: Sequence[Value]
    both: Fit
    statistics: ConstantStatistics
    as_taken: ConstantStatistics
    profile: Array
    used: Sequence[Capture]
    notes: Sequence[str]
    has_noise: bool
    well: FullWell | None = None
    amplifiers: AmplifierMismatch = AmplifierMismatch()
    stated: StatedShapes = StatedShapes()
    spoiled: Sequence[Capture] = ()

    @property
    def looked_at(self) -> list[Capture]:
        """Captures that decided, or were left out for what is in them."""
        return [*self.used, *self.spoiled]

    @property
    def unexplained(self) -> list[str]:
        """Where structure is that no effect has (model.selection.UNNAMED)."""
        return self.selection.unexplained(self.least)

    @cached_property
    def shown(self) -> frozenset[str]:
        """Effects that the frames can show, named or not."""
        both = of_splits(self.statistics, GROUPS[:2])
        of_levels = self.levels_of(both, self.both)
        flats = of_levels.names if of_levels is not None else []
        others = set(self.selection.gains) - set(LEVELS)
        return frozenset([*others, *self.selection.levels, *flats])

    @property
    def masked(self) -> NDArray[np.bool_]:
        """(H, W) samples that are none of a pattern: hot, or in a line that is."""
        if any(capture.divided for capture in self.used):
            return np.zeros(self.used[0].shape, bool)
        return self.statistics.masked(self.used[0].shape)

    def levels_of(
        self, statistics: ConstantStatistics, fit: Fit, named: Collection[str] = ()
    ) -> FlatLevels | None:
        """Return the levels of flats of some groups. named : as of levels_of."""
        return levels_of(
            self.captures, self.used, statistics, fit, named, stated=self.stated
        )

    def of_split(self, split: str) -> ConstantStatistics:
        """Return the statistics of a split."""
        return of_splits(self.statistics, (split,))


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
    saved_statistics. Raises ValueError where their noise is not known, and for a file
    that is not of them."""
    sensor = captures.sensor
    every = [c for c in captures.captures if is_constant(c)]
    if not every:
        raise ValueError("captures: no darks or flats")
    iso = _usual([c.iso for c in every])
    used, notes = _usual_of(every, [c.iso for c in every], "ISO")
    used, more = _usual_of(used, [c.shape for c in used], "size")
    points = set_points([c.temperature for c in used])
    used, most = _usual_of(used, points, "temperature")
    notes += more + most
    for split in GROUPS:
        if all(c.group != split for c in used):
            raise ValueError(
                f"no dark or flat is in the group {split}: not enough to fit, select "
                "and report on different frames; add frames"
            )
    if any(c.divided for c in used):
        notes.append(
            "Darks and flats are divided by columns: no hot pixel is looked for, nor "
            "what moves the mean of a flat, and levels and row noise of training and "
            "validation are those of one frame."
        )
    least = math.log(len(every_name()) / alpha)  # each name may be false
    tell: Callable[[float], None] = lambda share: say(  # noqa: E731
        "reading darks and flats", 0.5 * share
    )
    blocks = Blocks(sensor)
    if saved:
        whole = saved_statistics(saved, used, sensor, tell)
        if len(every) < len(captures.captures):
            notes.append("Darks of saved statistics: no residual image is looked for.")
    else:
        whole = statistics_by_split([*map(blocks.watched, used)], sensor, tell)
    spoiled = _spoiled(captures.captures, used, blocks, least, notes)
    if spoiled:
        used = [c for c in used if c not in spoiled]
        whole = statistics_by_split(used, sensor, tell)
    has_noise = bool(sensor.noise) and iso is not None
    parameters = Parameters(len(whole.planes))
    profile = profile_values(sensor, iso if has_noise else None, parameters)
    well = full_well(whole, GROUPS[:2], profile, has_noise, least)
    rest = _below(well, whole, used) if well is not None else []
    if well is not None and rest:
        notes.append(
            f"{plural(len(used) - len(rest), 'flat')} in which wells are full, at "
            f"{well.level:.0f} DN above black, are in no other number."
        )
        used, whole = rest, statistics_by_split(rest, sensor, tell)
    else:
        well = None
    if not any(c.divided for c in used):
        notes += lines_apart(whole, used)
    if not has_noise:
        profile = _with_noise_of(of_splits(whole, GROUPS[:2]), profile, parameters)
    white = sensor.signal_range
    steps = {
        name: value * unit_of(name, white)
        for name, value in (listed_parameters(sensor, MISMATCH) or {}).items()
    }
    may_differ = names is None or MISMATCH in names
    amplifiers = amplifier_mismatch(
        whole, (TRAINING, VALIDATION, TEST), least if may_differ else math.inf, steps
    )
    whole = as_taken = amplifiers.taken_off(whole)
    stated_shapes = StatedShapes()
    if not any(c.divided for c in used):
        stated_shapes = StatedShapes.of(sensor, whole)
        profile = stated_shapes.added_to(profile, parameters)
        whole = stated_shapes.without(whole, profile)
    splits = [of_splits(whole, (split,)) for split in (TRAINING, VALIDATION)]
    both = of_splits(whole, (TRAINING, VALIDATION))
    fits: list[Fit] = []
    for statistics in splits:
        say("fitting darks and flats", 0.55 + 0.1 * len(fits))
        fits.append(fit(statistics, profile))
    if not all(one.is_settled for one in fits):
        raise ValueError(
            f"{used[0].name}: noise lies within a code, and what codes hide of these "
            "frames has several explanations; take frames at a gain at which noise is "
            "half a code or more"
        )
    if both.dark_codes == 2:
        notes.append(
            "Darks have two codes: the share of each tells noise or the black level, "
            "which is taken from the profile; take darks at a higher gain."
        )
    together = fit(both, profile)
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
    allowed = stated_shapes.allowed(whole)
    for name, variance in amplifiers.allowed(whole.planes[0].shape):
        allowed[name] = allowed.get(name, 0.0) + variance
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
    named = found.kept(least)
    levels = [
        levels_of(captures, used, statistics, one, named, stated_shapes)
        for statistics, one in zip(splits, fits, strict=True)
    ]
    gains = dict(found.gains)
    if levels[0] is not None and levels[1] is not None:
        gains |= level_gains(levels[0], levels[1], least)
    if well is not None:
        gains[WELL] = _nats_of_well(well, sensor, white)
    if amplifiers.errors:
        gains[MISMATCH] = amplifiers.gain
    stated = untested(sensor) - {*stated_shapes.names}
    hidden = {*stated, *(() if has_noise else NOISE_TABLE)}
    asked = set(gains) if names is None else set(gains) & set(names)
    if untold := sorted(stated & asked):
        notes.append(
            f"The profile states {', '.join(untold)}: darks and flats are not asked "
            "whether it is as strong."
        )
    gains = {
        name: gain
        for name, gain in gains.items()
        if (names is None or name in names) and name not in hidden
    }
    found = replace(found, gains=gains)
    say("measuring what was found", 0.9)
    kept = [s for s in of_shapes.found.values() if s.name in found.kept(least)]
    beyond = of_shapes.whole if has_tails else (1.0, 0.0)
    values = tuple(effect_values(both, together, profile, white, kept, beyond))
    return DarksAndFlats(
        captures,
        found.kept(least),
        found,
        least,
        values,
        together,
        whole,
        as_taken,
        profile,
        used,
        notes,
        has_noise,
        well,
        amplifiers,
        stated_shapes,
        spoiled,
    )


def _spoiled(
    captures: Sequence[Capture],
    used: list[Capture],
    blocks: Blocks,
    least: float,
    notes: list[str],
) -> list[Capture]:
    """Return the darks that have a residual image, of which notes are taken; none where
    a split would have no other dark."""
    darks = [c for c in used if c.name in blocks.means]
    found = residual_images(captures, darks, blocks, least)
    names = {one.dark for one in found}
    splits = {c.group for c in darks}
    may_go = splits == {c.group for c in darks if c.name not in names}
    fate = "left out" if may_go else "kept, since its group has no other dark"
    notes += [f"{one}: {fate}." for one in found]
    return [c for c in darks if c.name in names] if may_go else []


def _nats_of_well(well: FullWell, sensor: Sensor, white: float) -> float:
    """Return what a full well gains; of one that the profile states, if it is another.
    white : DN above black."""
    stated = listed_parameters(sensor, WELL)
    if stated is None:
        return well.nats
    away = (well.level - (1 - stated["below_white"]) * white) / well.error
    return min(well.nats, away**2 / 2)


def _below(
    well: FullWell, statistics: ConstantStatistics, captures: Sequence[Capture]
) -> list[Capture]:
    """Return the captures in which no well is full; none where a split would have
    none: then light brings less noise everywhere, and that is no well."""
    full = {name for g in well.groups for name in statistics.groups[g].frames}
    rest = [capture for capture in captures if capture.name not in full]
    splits = {capture.group for capture in captures}
    return rest if {capture.group for capture in rest} == splits else []


def lines_apart(
    statistics: ConstantStatistics, captures: Sequence[Capture]
) -> Iterator[str]:
    """Yield a sentence on rows, and on columns, that are as a whole so far from the
    others that no pattern has them, with their places; none of those that a capture's
    own mask leaves out."""
    masked = statistics.masked(captures[0].shape)
    counted = [capture.mask() for capture in captures if capture.mask is not None]
    known = np.all(counted, axis=0) if counted else np.ones(masked.shape, bool)
    for axis, line in ((1, "row"), (0, "column")):
        apart = masked.all(axis=axis) & known.any(axis=axis)
        if (places := np.flatnonzero(apart)).size:
            listed = ", ".join(map(str, places[:MOST_LISTED]))
            more = ", ..." if places.size > MOST_LISTED else ""
            yield (
                f"{plural(places.size, line)} far from the others, set apart and no "
                f"effect: {line} {listed}{more}."
            )


def _with_noise_of(
    both: ConstantStatistics, profile: Array, parameters: Parameters
) -> Array:
    """Return a profile's parameters, (n,), with noise as in the frames."""
    found, fitted = profile.copy(), fit(both).theta
    for name in ("read_noise", "gain"):
        own = parameters.each(name)
        found[own] = fitted[own]
    return found


def of_splits(
    statistics: ConstantStatistics, splits: Collection[str]
) -> ConstantStatistics:
    """Return the statistics of the groups of splits."""
    return statistics.only(
        [g for g, info in enumerate(statistics.groups) if info.split in splits]
    )


def untested(sensor: Sensor) -> set[str]:
    """Return the effects that a profile states and darks and flats cannot test: it says
    a law or a shape, and a variance of what is not masked is what they measure."""
    stated = {entry["name"] for entry in sensor.effects or ()}
    stated |= {TAILS} & {*sensor.noise_effects}
    tested = {*OF_EFFECTS, *NOISE_TABLE, *SHARED, WELL, MISMATCH}
    tested |= {"black_level", "hot_pixels"}
    return stated - tested | stated & {"dark_current_nonuniformity"}


def is_constant(capture: Capture) -> bool:
    """Return whether a capture is a dark or a flat."""
    return capture.kind in ("dark", "flat")


def _usual(keys: Sequence[Any]) -> Any:
    """Return the most frequent."""
    return max(dict.fromkeys(keys), key=list(keys).count)


def _usual_of(
    captures: Sequence[Capture], keys: Sequence[Any], what: str
) -> tuple[list[Capture], list[str]]:
    """Return the captures of the most frequent key, and a note on others."""
    main = _usual(keys)
    used = [c for c, key in zip(captures, keys, strict=True) if key == main]
    if (count := len(captures) - len(used)) == 0:
        return used, []
    frames = plural(count, "frame")
    return used, [f"{frames} of another {what} left out of the darks and flats."]


def levels_of(
    captures: CaptureSet,
    used: Sequence[Capture],
    statistics: ConstantStatistics,
    found: Fit,
    named: Collection[str] = (),
    stated: StatedShapes | None = None,
) -> FlatLevels | None:
    """Return the levels of flats; None if there are none of known light, and of parts
    of frames, which light that falls off reaches by less.

    used : the captures that the statistics are of. found : their fit. named : effects
    that move the mean of a flat from its middle. stated : shapes that are taken off the
    statistics."""
    if any(capture.divided for capture in used):
        return None
    sensor = captures.sensor
    white = sensor.signal_range
    return flat_levels(
        found,
        predicted_of(used, statistics, sensor, white),
        sites_of(sensor.cfa),
        white=white,
        light=captures.uncertainty.get("light", 0.0),
        nuisances=captures.nuisances,
        is_shaded="lens_shading" in named,
        is_colored="color_shading" in named,
        shaded=None if stated is None else stated.mean,
    )


def predicted_of(
    captures: Sequence[Capture],
    statistics: ConstantStatistics,
    sensor: Sensor,
    white: float,
) -> NDArray[np.float64]:
    """Return (sites, G) DN above black that a profile predicts of flats; nan of darks,
    0 where the light is not known."""
    by_name = {capture.name: capture for capture in captures}
    letters = sites_of(sensor.cfa)
    found = np.full((len(letters), len(statistics.groups)), np.nan)
    for g, info in enumerate(statistics.groups):
        capture = by_name[info.frames[0]]
        if info.kind == "flat" and capture.scene is None:
            found[:, g] = 0.0
        if info.kind != "flat" or capture.scene is None:
            continue
        rgb = np.asarray(capture.scene(), np.float32).reshape(1, 1, 3)
        light = sensor.illuminant(capture.illuminant, capture.as_shot)
        camera = sensor.to_camera(rgb, illuminant=light, highlights=False)[0, 0]
        each = dict(zip("RGB", camera, strict=True))
        found[:, g] = [each.get(letter, camera[1]) * white for letter in letters]
    return found
