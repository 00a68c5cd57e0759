# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Characteristics: photon transfer and dark current, measured and by two models.

Source: EMVA Standard 1288, release 4.0: temporal variance by the difference of two
frames of the same light, in which all that is fixed cancels."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from cg2raw.calibration.robust import clipped_moments, middle_of
from cg2raw.diagnose.diagnosis import Characteristics, FixedPattern, Trend
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict

POINTS = 8  # points of a pair of frames with light
FEWEST_OF_POINT = 200  # pixels; its variance is then known to 10 %
SAME_LIGHT = 0.05  # relative; flats that differ more are no repeats

Pair = tuple[Frame, Frame]


def characteristics_of(
    base: Model, model: Model, splits: Splits, patterns: Sequence[FixedPattern]
) -> Characteristics | None:
    """Return what darks and flats show; None where there is none of them.

    base, model : before and after. patterns : of the report frames."""
    pixels = [frame for frame in splits.frames if frame.samples is None]
    if all(frame.capture.shows.image for frame in pixels):
        return None
    transfer = transfer_of(base, model, splits.report)
    levels = dark_levels_of(base, model, pixels, splits)
    gain = electrons_per_dn(model, pixels)
    missing = [*_missing(transfer, levels, pixels, gain)]
    return Characteristics(transfer, levels, list(patterns), gain, missing)


def transfer_of(base: Model, model: Model, report: Likelihood) -> Trend | None:
    """Return variance against level of pairs of repeats; None if there are none.

    Pixels of a pair with light are parted by what is predicted of them."""
    models = _temporal(base), _temporal(model)
    work = partial(_points, models)
    points = [p for found in report.workers.map(work, pairs_of(report.frames))
              for p in found]  # fmt: skip
    return _trend([(*point, True) for point in sorted(points)])


def pairs_of(frames: Sequence[Frame]) -> list[Pair]:
    """Return frames that differ by noise alone, two by two, each in one pair."""
    alike: dict[object, list[Frame]] = {}
    for frame in frames:
        if frame.samples is not None:
            continue
        c = frame.capture
        place = c.set if c.shows.image else None
        key = (c.kind, c.iso, c.exposure_time, c.shape, place)
        alike.setdefault(key, []).append(frame)
    pairs = []
    for members in alike.values():
        if members[0].capture.shows.light:
            members = sorted(members, key=_middle)
        rest = list(members)
        while len(rest) > 1:
            first = rest.pop(0)
            if _is_same_light(first, rest[0]):
                pairs.append((first, rest.pop(0)))
    return pairs


def _is_same_light(first: Frame, second: Frame) -> bool:
    if not first.capture.shows.light:
        return True
    low, high = sorted((_middle(first), _middle(second)))
    return high - low <= SAME_LIGHT * high


def _middle(frame: Frame) -> float:
    used = frame.signal[frame.keep]
    return float(np.median(used)) if used.size else 0.0


def _temporal(model: Model) -> Model:
    """Return a model without maps: what they add is the same in both frames."""
    return replace(model, terms=tuple(t for t in model.terms if t.sensor_map is None))


def _variance(model: Model, frame: Frame) -> tuple[Array, Array]:
    """Return (level, variance of a pixel from frame to frame), DN and DN^2."""
    p = predict(model, frame)
    variance = p.variance - p.light_variance
    for effect in every().values():
        if isinstance(effect, SharedOffset) and effect.shares_offset == "row":
            values = model.values_of(effect, frame)
            if values is not None:
                variance = variance + effect.offset_variance(values, frame)
    return p.mean * frame.range, variance * frame.range**2


def _points(models: tuple[Model, Model], pair: Pair) -> list[tuple[float, ...]]:
    """Return (level, measured, before, after) of parts of a pair of frames."""
    first, second = pair
    used = first.keep & second.keep & ~first.censored & ~second.censored
    if np.count_nonzero(used) < FEWEST_OF_POINT:
        return []
    predicted, after = (part[used] for part in _variance(models[1], first))
    before = _variance(models[0], first)[1][used]
    dn = [(frame.signal * frame.range)[used] for frame in pair]
    level = 0.5 * (dn[0] + dn[1])
    scale = level.sum() / dn[1].sum() if first.capture.shows.light else 1.0
    difference = dn[0] * (2 - scale) - dn[1] * scale
    count = POINTS if first.capture.shows.light else 1
    parts = np.array_split(np.argsort(predicted, kind="stable"), count)
    return [
        (
            clipped_moments(level[part])[0],
            0.5 * clipped_moments(difference[part])[1] ** 2,
            float(np.median(before[part])),
            float(np.median(after[part])),
        )
        for part in parts
        if len(part) >= FEWEST_OF_POINT
    ]


def dark_levels_of(
    base: Model, model: Model, frames: Sequence[Frame], splits: Splits
) -> Trend | None:
    """Return the level of darks against exposure time; None without darks of a known
    exposure time. Of all splits: a time may have one frame."""

    def point(frame: Frame) -> tuple[float, ...]:
        used = frame.keep & ~frame.censored
        middle = middle_of((frame.signal * frame.range)[used])
        predicted = [
            # Not the middle of what is predicted: noise hides how skewed that is.
            middle - middle_of(((frame.signal - p.mean) * frame.range)[used])
            for p in (predict(base, frame), predict(model, frame))
        ]
        time = frame.capture.exposure_time
        assert time is not None
        return (time, middle, *predicted, frame.capture.group == "report")

    darks = [
        frame
        for frame in frames
        if not frame.capture.shows.light
        and frame.capture.exposure_time is not None
        and (frame.keep & ~frame.censored).any()
    ]
    return _trend(sorted(splits.workers.map(point, darks)))


def _trend(points: Sequence[tuple[float, ...]]) -> Trend | None:
    if not points:
        return None
    x, measured, before, after, held_out = np.array(points, float).T
    return Trend(x, measured, before, after, held_out > 0)


def electrons_per_dn(model: Model, frames: Sequence[Frame]) -> float | None:
    """Return the gain by a model's noise; None if it has no photon noise, or frames of
    several ISOs."""
    if len({frame.capture.iso for frame in frames}) != 1:
        return None
    frame = frames[0]
    dn_per_electron = model.noise_gain("beta1") * float(
        np.mean(frame.beta1 * frame.range)
    )
    return 1 / dn_per_electron if dn_per_electron > 0 else None


def _missing(
    transfer: Trend | None,
    levels: Trend | None,
    frames: Sequence[Frame],
    gain: float | None,
) -> list[str]:
    """Return what these frames do not show, a sentence each."""
    kinds = {frame.capture.kind for frame in frames}
    found = []
    if transfer is None:
        found.append(
            "No photon-transfer curve: two held-out frames of the same light or of the "
            "same exposure time in the dark are needed; take repeats."
        )
    if levels is None or len(np.unique(levels.x)) < 2:
        found.append(
            "No dark-current line: darks at two exposure times or more are needed."
        )
    for kind in ("dark", "flat"):
        if kind not in kinds:
            found.append(f"No fixed pattern of {kind}s: there are no {kind}s.")
    if gain is None:
        found.append(
            "No electrons: the profile has no photon noise, or the frames several ISOs."
        )
    return found
