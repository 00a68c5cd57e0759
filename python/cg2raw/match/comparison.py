# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Captures and renders side by side: the exposure between them, and what else differs.

The level of a frame is its median luminance, which a tone curve leaves where it is if
it keeps the middle of the frame; so the exposure is what moves the middles of renders
to those of captures, and contrast is what differs around it."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cg2raw import __version__
from cg2raw.match.frame import PROBABILITIES, Frame
from cg2raw.match.scenes import pairs
from cg2raw.match.shift import (
    LEVEL,
    Array,
    Levels,
    Shift,
    empirical_quantiles,
    shift_between,
    shift_of,
)
from cg2raw.short_messages import plural

LEAST = 10  # captures, and renders, from which an exposure is inferred
HALF = 0.5
Pair = tuple[int, int]  # places of a capture and of a render
COLOURS = ("red", "blue")  # over green
GREY = math.log2(0.18)  # stops; the other pivot that tone curves have
METERED = 0.8  # ratio of the spreads of levels, below which exposures follow scenes
ALIKE = 1.1  # ratio of contrasts from which on tone is said to differ


@dataclass(frozen=True)
class Comparison:
    """What a set of captures and a set of renders of one sensor look like.

    exposure : stops to be added to renders. white_balance : {"red", "blue"}, stops over
    green likewise; empty if it was not asked for. scenes : how many captures show the
    scene of a render; 0: the sets show different ones."""

    sensor: str
    captures: tuple[Frame, ...]
    renders: tuple[Frame, ...]
    exposure: Shift
    white_balance: dict[str, Shift]
    scenes: int
    notes: tuple[str, ...]

    def fields(self) -> dict[str, Any]:
        """Return what match.json holds."""
        found: dict[str, Any] = {
            "cg2raw_match": 1,
            "cg2raw": __version__,
            "sensor": self.sensor,
            "exposure": distribution(self.exposure),
            "levels": {
                "captures": level_quantiles(self.captures),
                "renders": level_quantiles(list(filter(is_seen, self.renders))),
            },
        }
        if self.white_balance:
            found["white_balance"] = {
                name: distribution(shift) for name, shift in self.white_balance.items()
            }
        shifts = {"exposure": self.exposure, **self.white_balance}
        return found | {
            "captures": len(self.captures),
            "renders": len(self.renders),
            "uncertainty": {
                "confidence": LEVEL,
                "scenes": self.scenes,
                **{name: interval(shift) for name, shift in shifts.items()},
            },
        }


def distribution(shift: Shift) -> dict[str, Any]:
    """Return a Shift in JSON's types."""
    return {
        "median": round(shift.median, 4),
        "spread": round(shift.spread, 4),
        "quantiles": [[p, round(stops, 4)] for p, stops in shift.quantiles],
    }


def level_quantiles(frames: Sequence[Frame]) -> list[list[float]]:
    """Return [probability, stops] of levels, in JSON's types."""
    found = empirical_quantiles(np.array([frame.level for frame in frames]))
    return [[p, round(stops, 4)] for p, stops in found]


def interval(shift: Shift) -> dict[str, list[float]]:
    """Return the intervals of a Shift in JSON's types."""
    return {
        "median": [round(end, 4) for end in shift.median_range],
        "spread": [round(end, 4) for end in shift.spread_range],
    }


def check_counts(captures: int, renders: int) -> None:
    """Raise ValueError for fewer frames than an exposure is inferred from."""
    for count, noun in ((captures, "capture"), (renders, "render")):
        if count < LEAST:
            raise ValueError(
                f"{plural(count, noun)}: an exposure is inferred from {LEAST} or more; "
                f"give more {noun}s, of scenes that differ"
            )


def compare(
    sensor: str,
    captures: Sequence[Frame],
    renders: Sequence[Frame],
    white_balance: bool = False,
    notes: Sequence[str] = (),
) -> Comparison:
    """Return the Comparison of Frames. Raises ValueError for too few, and for captures
    most of which are black or clipped."""
    check_counts(len(captures), len(renders))
    seen = [frame for frame in renders if is_seen(frame)]
    said = list(notes)
    if len(seen) < len(renders):
        black = plural(len(renders) - len(seen), "render")
        said.append(f"{black} without light: left out of the exposure")
    unseen = sum(not is_seen(frame) for frame in captures)
    if unseen > HALF * len(captures) or len(seen) < LEAST:
        which = "captures" if unseen > HALF * len(captures) else "renders"
        raise ValueError(
            f"the middle of most {which} is clipped or black: it tells no exposure; "
            "give frames that are exposed for their scenes"
        )
    if unseen:
        said.append(
            f"{plural(unseen, 'capture')} of which more than half is clipped or black: "
            "taken as a bound"
        )
    found = pairs(captures, seen)
    exposure = exposure_of(captures, seen, found)
    said += [*tone_note(captures, seen), *spread_note(captures, seen)]
    balance = {}
    if white_balance:
        balance = {name: cast(name, captures, seen, found) for name in COLOURS}
    return Comparison(
        sensor,
        tuple(captures),
        tuple(renders),
        exposure,
        balance,
        len(found),
        tuple(said),
    )


def is_seen(frame: Frame) -> bool:
    """Return whether the median luminance of a frame is known."""
    return max(frame.white_bins, frame.black_bins) < HALF


def exposure_of(
    captures: Sequence[Frame],
    renders: Sequence[Frame],
    found: Sequence[Pair],
) -> Shift:
    """Return the exposure, of pairs of one scene if there are any."""
    if found:
        return shift_of(
            levels_of(
                [captures[ours] for ours, _ in found],
                [renders[theirs].level for _, theirs in found],
            )
        )
    ours = levels_of(captures, [0.0] * len(captures))
    return shift_between(np.array([frame.level for frame in renders]), ours)


def levels_of(frames: Sequence[Frame], below: Sequence[float]) -> Levels:
    """Return the Levels of frames, less a number of stops each."""

    def chosen(which: Callable[[Frame], bool]) -> Array:
        pairs = zip(frames, below, strict=True)
        return np.array([f.level - stops for f, stops in pairs if which(f)])

    return Levels(
        known=chosen(is_seen),
        above=chosen(lambda frame: frame.white_bins >= HALF),
        below=chosen(lambda frame: frame.black_bins >= HALF),
    )


def cast(
    name: str,
    captures: Sequence[Frame],
    renders: Sequence[Frame],
    found: Sequence[Pair],
) -> Shift:
    """Return the shift of a colour over green after white balance, stops."""
    none = np.empty(0)
    if found:
        values = np.array(
            [getattr(captures[a], name) - getattr(renders[b], name) for a, b in found]
        )
        return shift_of(Levels(values[np.isfinite(values)], none, none))
    ours, theirs = (
        np.array([getattr(frame, name) for frame in frames])
        for frames in (captures, renders)
    )
    ours, theirs = (values[np.isfinite(values)] for values in (ours, theirs))
    if min(len(ours), len(theirs)) < LEAST:
        raise ValueError(
            "--white-balance: too few frames show colours that are lit; leave it out"
        )
    return shift_between(theirs, Levels(ours, none, none))


def tone_note(captures: Sequence[Frame], renders: Sequence[Frame]) -> list[str]:
    """Return a sentence on a tone that differs, and what it would be about grey."""
    ours, theirs = (
        middle(frame.contrast for frame in frames) for frames in (captures, renders)
    )
    if not (ours > 0 and theirs > 0):
        return []
    ratio = ours / theirs
    if 1 / ALIKE < ratio < ALIKE:
        return []
    away = (ratio - 1) * (middle(frame.level for frame in renders) - GREY)
    return [
        f"contrast of captures is {ratio:.2f} times that of renders: the exposure is "
        "that of the middle of each frame; if that comes from a tone curve that keeps "
        f"18 % grey, {-away:+.2f} stops more"
    ]


def spread_note(captures: Sequence[Frame], renders: Sequence[Frame]) -> list[str]:
    """Return a sentence on levels of captures that differ less than those of renders,
    as a meter's do."""
    ours, theirs = (
        float(np.std([frame.level for frame in frames]))
        for frames in (captures, renders)
    )
    if ours > METERED * theirs:
        return []
    return [
        f"levels of captures differ by {ours:.2f} stops, those of renders by "
        f"{theirs:.2f}: no drawn exposure brings them together, as match:FILE does"
    ]


def middle(values: Any) -> float:
    """Return the median of what is known, NaN of nothing."""
    known = np.array([value for value in values if np.isfinite(value)])
    return float(np.median(known)) if known.size else math.nan


@dataclass(frozen=True)
class Row:
    """A line of the table: a quantity of captures and of renders, and in words."""

    name: str
    unit: str
    captures: float
    renders: float
    sentence: str


def rows_of(found: Comparison, noise: bool = True) -> list[Row]:
    """Return the table. noise : whether the renders have any."""
    rows = [
        luminance_row(found, "The shadows", 0.05),
        luminance_row(found, "The middles", 0.5),
        luminance_row(found, "The lights", 0.95),
        share_row(found, "clipped", "clip"),
        share_row(found, "black", "blacken"),
        ratio_row(found, "saturation", "stops", "as saturated as captures"),
        ratio_row(found, "contrast", "stops", "as rich in contrast"),
        ratio_row(found, "sharpness", "1", "as sharp"),
        ratio_row(found, "noise", "1", "as noisy where they are flat"),
    ]
    if not noise:
        rows[-1] = replace(rows[-1], sentence="They are without noise")
    return rows + [cast_row(found, name) for name in COLOURS]


def luminance_row(found: Comparison, what: str, share: float) -> Row:
    """Return the row on a quantile of luminance: medians over frames."""
    index = PROBABILITIES.index(share)
    ours, theirs = of_both(found, lambda frame: -float(frame.quantiles[index]))
    sentence = f"{what} of your renders {stops_words(ours - theirs)}"
    name = f"luminance that {share:.0%} of a frame is below"
    return Row(name, "stops below white", ours, theirs, sentence)


def ratio_row(found: Comparison, name: str, unit: str, words: str) -> Row:
    """Return the row on a field of Frame of which the ratio counts."""
    ours, theirs = of_both(found, lambda frame: float(getattr(frame, name)))
    ratio = theirs / ours if ours else math.nan
    sentence = f"They are {times_words(ratio)} {words}"
    if not math.isfinite(ratio):
        sentence = f"The frames do not show their {name}"
    return Row(name, unit, ours, theirs, sentence)


def cast_row(found: Comparison, name: str) -> Row:
    """Return the row on a colour over green."""
    ours, theirs = of_both(found, lambda frame: float(getattr(frame, name)))
    more = theirs - ours
    sentence = (
        f"After white balance they are {abs(more):.2f} stops "
        f"{'more' if more > 0 else 'less'} {name}"
    )
    if not math.isfinite(more):
        sentence = f"The frames do not show how {name} they are"
    return Row(f"{name} over green", "stops", ours, theirs, sentence)


def of_both(
    found: Comparison, quantity: Callable[[Frame], float]
) -> tuple[float, float]:
    """Return the median of a quantity over captures, and over renders."""
    ours, theirs = (
        middle(quantity(frame) for frame in frames)
        for frames in (found.captures, found.renders)
    )
    return ours, theirs


def share_row(found: Comparison, name: str, verb: str) -> Row:
    """Return the row on a share of samples: means over all frames, per cent."""
    ours, theirs = (
        100 * float(np.mean([getattr(frame, name) for frame in frames]))
        for frames in (found.captures, found.renders)
    )
    sentence = (
        f"They {verb} {theirs:.2g} % of samples where captures {verb} {ours:.2g} %"
    )
    return Row(f"{name} samples", "%", ours, theirs, sentence)


def stops_words(brighter: float) -> str:
    """Return how a number of stops is said of renders."""
    if abs(brighter) < 0.05:
        return "are as bright as those of captures"
    return f"are {abs(brighter):.1f} stops {'brighter' if brighter > 0 else 'darker'}"


def times_words(ratio: float) -> str:
    """Return how a ratio is said."""
    for word, number in (("half", 0.5), ("twice", 2.0)):
        if abs(ratio / number - 1) < 0.06:
            return word
    return "just" if abs(ratio - 1) < 0.05 else f"{ratio:.2g} times"


def exposure_words(shift: Shift) -> str:
    """Return the sentence on the exposure, and how sure it is."""
    low, high = shift.median_range
    least, most = shift.spread_range
    return (
        f"Add {shift.median:+.2f} stops to your renders ({low:+.2f} to {high:+.2f}), "
        f"with a standard deviation of {shift.spread:.2f} ({least:.2f} to {most:.2f}); "
        f"the intervals hold with {LEVEL:.0%} confidence"
    )
