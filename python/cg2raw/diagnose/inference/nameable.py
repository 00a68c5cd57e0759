# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Nameable: the effects that a set of captures can show."""

from collections.abc import Collection, Sequence

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Mask
from cg2raw.diagnose.inference.splits import Splits

DISTINCT = 1.2  # ratio of two flats' levels that show a curve


def nameable(
    capture_set: CaptureSet,
    splits: Splits,
    names: Collection[str],
) -> list[Effect]:
    """Return the effects of some names that frames show."""
    known = [e for e in candidates(capture_set.sensor.cfa) if e.name in names]
    fitted, selected = splits.fit.frames, splits.select.frames
    again = _shows_light_again([*fitted, *selected])
    groups = [_shown_by(frames, again) for frames in (fitted, selected)]
    held_out = splits.hold_out_frames

    def is_shown(effect: Effect) -> bool:
        if effect.shares_offset == "frame" and not held_out:
            return False  # what a frame shares is in all parts of its pixels
        if effect.estimator == "stated":
            return False
        return all(
            any(effect.needs <= shown and (pixels or effect.from_means)
                for shown, pixels in group)
            for group in groups
        )  # fmt: skip

    return [effect for effect in known if is_shown(effect)]


def _is_even(frame: Frame) -> bool:
    return frame.capture.shows.light and not frame.capture.shows.image


def _shows_light_again(frames: Sequence[Frame]) -> bool:
    """Return whether light fell on any pixel in two frames. Frames that are divided by
    their pixels have none in common."""
    seen: dict[tuple[int, ...], Mask] = {}
    for frame in frames:
        if frame.capture.shows.light and frame.samples is None:
            before = seen.get(frame.keep.shape)
            if before is not None and (before & frame.keep).any():
                return True
            seen[frame.keep.shape] = (
                frame.keep if before is None else before | frame.keep
            )
    return False


def _shown_by(frames: Sequence[Frame], again: bool) -> list[tuple[set[str], bool]]:
    """Return of each frame what it has of what effects need to be seen, and whether it
    has pixels.

    again : light fell on pixels in more than one frame."""
    times = [frame.capture.exposure_time for frame in frames]
    timed = all(time is not None for time in times) and any(times)
    levels = [frame.camera.mean() for frame in frames if _is_even(frame)]
    differ = bool(levels) and max(levels) > DISTINCT * min(levels)
    found = []
    for frame in frames:
        shown = {"time"} if timed else set()
        shown |= {"light"} if frame.capture.shows.light else set()
        shown |= {"image"} if frame.capture.shows.image else set()
        is_free = frame.level_free and frame.samples is None
        shown |= {"level"} if "light" in shown and not is_free else set()
        shown |= {"levels"} if differ or "image" in shown else set()
        shown |= {"repeats"} if again or "levels" in shown else set()
        found.append((shown, frame.samples is None))
    return found
