# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""One diagnosis of two: what darks and flats decide, then what images do beside it.

Darks and flats show noise, patterns and offsets. With these in the profile, images show
what happens to light."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.diagnosis import DetectionLimit, Diagnosis, Gap
from cg2raw.diagnose.effects.catalogue import of_images
from cg2raw.diagnose.scenes.decide import BLUR, RAMP
from cg2raw.diagnose.verdict.findings import deciding_captures, verdict_of
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.lags import FILTER
from cg2raw.model.selection import OF_LENS
from cg2raw.sensor import Sensor


def with_images_alone(
    captures: CaptureSet,
    decided: Diagnosis,
    masked: NDArray[np.bool_],
    used: Collection[Capture],
) -> CaptureSet:
    """Return the captures of known light, of a sensor that has what darks and flats
    decided, and those darks and flats that had no part in it.

    masked : (H, W) pixels that darks and flats show to be none of a pattern: hot, or
    in a line that is. used : darks and flats that decided."""
    sensor = captures.sensor
    if decided.profile_json:
        sensor = Sensor.from_json(decided.profile_json, f"{sensor.id} as decided")
    lit = [
        _without(capture, masked)
        for capture in captures.captures
        if capture.has_known_light
        if capture.shows.light or capture not in used
    ]
    return replace(captures, sensor=sensor, captures=lit)


def _without(capture: Capture, masked: NDArray[np.bool_]) -> Capture:
    """Return a capture of whose pixels some do not count."""
    if not masked.any() or capture.shape != masked.shape:
        return capture
    own = capture.mask
    return replace(capture, mask=lambda: ~masked if own is None else own() & ~masked)


def together(
    first: Diagnosis, second: Diagnosis, of_one_kind: bool = False
) -> Diagnosis:
    """Return the diagnosis of darks and flats, and of images by the profile that it
    makes, as one. of_one_kind : darks or flats alone."""
    doubts = {}
    if any(FILTER in one.ambiguous_with for one in first.effects):
        doubts[BLUR] = FILTER  # what softens images may be the filter, too
    if of_one_kind and any(one.name == MISMATCH for one in first.effects):
        # They tell its offset or its response, and images have the other as well.
        doubts |= dict.fromkeys((*OF_LENS, RAMP), MISMATCH)
    effects = [
        replace(one, ambiguous_with=[*one.ambiguous_with, doubts[one.name]])
        if one.name in doubts
        else one
        for one in (*first.effects, *second.effects)
    ]
    left = [*first.unexplained, *second.unexplained]
    if left:
        effects = [replace(one, provisional=True) for one in effects]
    return replace(
        second,
        verdict="incomplete"
        if second.verdict == "incomplete"
        else verdict_of(effects, bool(left)),
        sensor_id=first.sensor_id,
        effects=effects,
        gap=_gap(first.gap, second.gap),
        tests_before=[*first.tests_before, *second.tests_before],
        tests_after=[*first.tests_after, *second.tests_after],
        unexplained=left,
        detection_limits=_limits(first, second),
        next_captures=deciding_captures(effects),
        notes=list(dict.fromkeys([*first.notes, *second.notes])),
        groups={
            split: list(dict.fromkeys([*names, *second.groups[split]]))
            for split, names in first.groups.items()
        },
        charts=[*first.charts, *second.charts],
        profile_json=second.profile_json or first.profile_json,
    )


def _gap(first: Gap, second: Gap) -> Gap:
    """Return the gap of both, each frame counted alike."""
    counts = len(first.held_out), len(second.held_out)

    def mean(one: float, other: float) -> float:
        return (one * counts[0] + other * counts[1]) / sum(counts)

    return Gap(
        mean(first.before, second.before),
        mean(first.after, second.after),
        mean(first.chi2_before, second.chi2_before),
        mean(first.chi2_after, second.chi2_after),
        sorted({*first.held_out, *second.held_out}),
    )


def _limits(first: Diagnosis, second: Diagnosis) -> list[DetectionLimit]:
    """Return the limits of both, of each effect by the frames that show it."""
    named = {one.name for one in (*first.effects, *second.effects)}
    shown = {one.name for one in second.detection_limits if one.strength is not None}
    kept = [
        one
        for one in first.detection_limits
        if one.name not in shown and one.name not in of_images()
    ]
    every = [*kept, *second.detection_limits]
    return [one for one in every if one.name not in named]
