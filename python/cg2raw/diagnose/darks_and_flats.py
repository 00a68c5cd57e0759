# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Darks and flats: what their statistics name by one model. The search of diagnose()
decides; this is compared with it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.frames import by_level
from cg2raw.cfa import repeat_of, sites_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.model.evaluation import Parameters
from cg2raw.model.fit import Fit, fit
from cg2raw.model.flat_levels import flat_levels, level_gains
from cg2raw.model.lags import lags_of
from cg2raw.model.profile_values import profile_values
from cg2raw.model.selection import Selection, selection
from cg2raw.model.shapes import shapes
from cg2raw.model.values import Value, effect_values
from cg2raw.sensor import Sensor
from cg2raw.statistics.constant import ConstantStatistics, GroupInfo, set_points
from cg2raw.statistics.frame_statistics import frame_statistics
from cg2raw.statistics.kept import Kept

TRAINING, VALIDATION, TEST = GROUPS
NAMES = 33  # that a diagnosis could give: each may be false


@dataclass(frozen=True)
class DarksAndFlats:
    """names : best first. unexplained : where structure is that no effect has. values :
    of all that the frames show, by training and validation frames together."""

    names: Sequence[str]
    unexplained: Sequence[str]
    selection: Selection
    values: Sequence[Value]


def darks_and_flats(captures: CaptureSet, alpha: float = 0.01) -> DarksAndFlats:
    """Return what darks and flats of a capture set name.

    alpha : chance of a false name. Raises ValueError where their noise is not known."""
    sensor = captures.sensor
    used = [c for c in captures.captures if c.kind in ("dark", "flat")]
    if not used:
        raise ValueError("captures: no darks or flats")
    iso = _usual([c.iso for c in used])
    used = [c for c in used if c.iso == iso]
    points = set_points([c.temperature for c in used])
    main = _usual(points)
    used = [c for c, point in zip(used, points, strict=True) if point == main]
    whole = statistics_by_split(used, sensor)
    splits = [
        whole.only([g for g, info in enumerate(whole.groups) if info.split == split])
        for split in (TRAINING, VALIDATION)
    ]
    both = whole.only([g for g, info in enumerate(whole.groups) if info.split != TEST])
    profile = profile_values(sensor, float(iso or 0), Parameters(len(whole.planes)))
    fits = [fit(statistics, profile) for statistics in splits]
    least = math.log(NAMES / alpha)
    lags = [
        lags_of(one, found, profile) for one, found in zip(splits, fits, strict=True)
    ]
    first, second = lags
    found = selection(
        fits[0],
        fits[1],
        profile,
        least,
        (first, second) if first is not None and second is not None else None,
        shapes(whole, (TRAINING, VALIDATION), (fits[0], fits[1])),
    )
    gains = {**found.gains, **_of_levels(captures, used, splits, fits, found, least)}
    found = replace(found, gains=gains)
    white = sensor.white_level - float(np.mean(sensor.black_level))
    values = tuple(effect_values(both, fit(both, profile), profile, white))
    return DarksAndFlats(found.kept(least), found.unexplained(least), found, values)


def _usual(keys: Sequence[Any]) -> Any:
    """Return the most frequent."""
    return max(dict.fromkeys(keys), key=list(keys).count)


def statistics_by_split(
    captures: Sequence[Capture], sensor: Sensor
) -> ConstantStatistics:
    """Return the statistics of darks and flats, all splits under one mask. Flats of
    unknown light repeat each other if their levels are alike."""
    keys: dict[tuple[object, ...], list[Capture]] = {}
    for capture in captures:
        light: tuple[float, ...] = ()
        if capture.shows.light and capture.scene is not None:
            light = tuple(np.ravel(capture.scene()).tolist())
        key = (capture.group, capture.kind, capture.exposure_time, light)
        keys.setdefault(key, []).append(capture)
    kept = Kept()
    read = {id(capture): kept.reader(capture.raw) for capture in captures}
    groups = []
    for members in keys.values():
        parts = [members]
        if members[0].scene is None:
            levels = [float(read[id(c)]()[::8, ::8].mean()) for c in members]
            parts = by_level(members, levels)
        for part in parts:
            info = GroupInfo(
                "flat" if part[0].shows.light else "dark",
                tuple(capture.name for capture in part),
                part[0].exposure_time,
                part[0].temperature,
                part[0].group,
            )
            groups.append((info, [read[id(capture)] for capture in part]))
    masks = [capture.mask() for capture in captures if capture.mask is not None]
    excluded: NDArray[np.bool_] | None = ~masks[0] if masks else None
    return frame_statistics(
        groups, repeat_of(sensor.cfa), sensor.white_level, excluded=excluded
    )


def _of_levels(
    captures: CaptureSet,
    used: Sequence[Capture],
    splits: Sequence[ConstantStatistics],
    fits: Sequence[Fit],
    found: Selection,
    least: float,
) -> dict[str, float]:
    sensor = captures.sensor
    white = sensor.white_level - float(np.mean(sensor.black_level))
    named = found.kept(least)
    levels = [
        flat_levels(
            one,
            predicted_of(used, statistics, sensor, white),
            sites_of(sensor.cfa),
            white=white,
            light=captures.uncertainty.get("light", 0.0),
            nuisances=captures.nuisances,
            is_shaded="lens_shading" in named,
            is_colored="color_shading" in named,
        )
        for one, statistics in zip(fits, splits, strict=True)
    ]
    first, second = levels
    if first is None or second is None:
        return {}
    return level_gains(first, second, least)


def predicted_of(
    captures: Sequence[Capture],
    statistics: ConstantStatistics,
    sensor: Sensor,
    white: float,
) -> NDArray[np.float64]:
    """Return (sites, G) DN above black that a profile predicts of flats; nan of darks
    and of unknown light."""
    by_name = {capture.name: capture for capture in captures}
    letters = sites_of(sensor.cfa)
    found = np.full((len(letters), len(statistics.groups)), np.nan)
    for g, info in enumerate(statistics.groups):
        capture = by_name[info.frames[0]]
        if info.kind != "flat" or capture.scene is None:
            continue
        rgb = np.asarray(capture.scene(), np.float32).reshape(1, 1, 3)
        light = sensor.illuminant(capture.illuminant, capture.as_shot)
        camera = sensor.to_camera(rgb, illuminant=light, highlights=False)[0, 0]
        each = dict(zip("RGB", camera, strict=True))
        found[:, g] = [each.get(letter, camera[1]) * white for letter in letters]
    return found
