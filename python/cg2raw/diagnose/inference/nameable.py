# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Nameable: the effects that a set of captures can show."""

from collections.abc import Collection, Sequence

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.splits import Splits


def nameable(
    capture_set: CaptureSet,
    splits: Splits,
    without: Collection[str],
    only: Collection[str],
) -> tuple[list[Effect], list[Effect]]:
    """Return (what may be named, what no frames show), but for what is free as a
    nuisance. Raises ValueError for unknown names."""
    known = candidates(capture_set.sensor.cfa, without)
    if only:
        candidates(capture_set.sensor.cfa, only)  # refuses unknown names
        known = [effect for effect in known if effect.name in only]
    known = [effect for effect in known if effect.name not in capture_set.nuisances]
    shown = _shown_by(splits.fit.frames) & _shown_by(splits.select.frames)
    return (
        [effect for effect in known if effect.needs <= shown],
        [effect for effect in known if not effect.needs <= shown],
    )


def _shown_by(frames: Sequence[Frame]) -> set[str]:
    """Return what frames have of what effects need to be seen."""
    shown = set()
    if any(frame.capture.shows.light for frame in frames):
        shown.add("light")
    if any(frame.capture.shows.image for frame in frames):
        shown.add("image")
    times = [frame.capture.exposure_time for frame in frames]
    if all(time is not None for time in times) and any(times):
        shown.add("time")
    return shown
