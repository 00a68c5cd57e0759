# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The check of captures: each frame by itself, then the repeats of a series."""

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import Capture
from cg2raw.diagnose.captures.manifest import Frame
from cg2raw.diagnose.captures.phase_correlation import misplaced_words
from cg2raw.diagnose.captures.quality import (
    Integrity,
    beside_render,
    integrity,
    of_means,
    step_of,
    with_noise_remarks,
)
from cg2raw.diagnose.captures.repeats import (
    FALSE_ALARM,
    Repeats,
    repeats_of,
    series_of,
)
from cg2raw.diagnose.captures.residual_image import Blocks, residual_images
from cg2raw.sensor import Sensor
from cg2raw.statistics import GroupInfo, codes, frame_statistics


@dataclass(frozen=True)
class Check:
    """captures : frames and their masked borders, in the manifest's order, with what
    the pixels of each say. complaints, remarks : sentences on series of repeats."""

    captures: Sequence[Capture]
    integrities: Sequence[Integrity]
    complaints: Sequence[str]
    remarks: Sequence[str]

    @property
    def is_right(self) -> bool:
        """Whether nothing is wrong."""
        return not self.complaints and not any(i.complaints for i in self.integrities)


def check(
    frames: Sequence[Frame],
    sensor: Sensor,
    nuisances: Collection[str] = (),
    progress: Callable[[float], None] = lambda share: None,
) -> Check:
    """Return what all frames' pixels say, one series of repeats after the other.

    progress : called with the share of the frames that are done, 0 to 1."""
    captures = [c for frame in frames for c in (frame.capture, *frame.borders)]
    borders = [[border] for frame in frames for border in frame.borders]
    found: dict[str, Integrity] = {}
    complaints: list[str] = []
    remarks: list[str] = []
    blocks = Blocks(sensor)
    for series in [*series_of(frames), *borders]:
        done, ours = len(found), [blocks.watched(capture) for capture in series]

        def tell(share: float, done: int = done, count: int = len(ours)) -> None:
            progress((done + share * count) / len(captures))

        look = of_pictures if ours[0].shows.image else of_uniform
        integrities, repeats = look(ours, sensor, tell)
        found |= {one.name: one for one in integrities}
        if isinstance(repeats, str):
            remarks.append(repeats)
            continue
        complaints += [words] if (words := repeats.first_is_off()) else []
        remarks += remarks_on(repeats, ours[0].shows.light, sensor, nuisances)
    every, least = [frame.capture for frame in frames], -math.log(FALSE_ALARM)
    darks = [c for c in every if c.name in blocks.means and not c.shows.light]
    complaints += [
        f"{one}: leave it out; take darks before other frames, or wait after these"
        for one in residual_images(every, darks, blocks, least)
    ]
    for frame in frames:
        if frame.capture.means is not None:
            found[frame.capture.name] = of_means(frame.capture, sensor)
    shifts = [i.shift for i in found.values() if i.shift is not None]
    shifts = [one for one in shifts if one.is_told]
    if "registration" not in nuisances and (words := misplaced_words(shifts)):
        complaints.append(words)
    uniform = [i for i in found.values() if i.kind in ("dark", "flat")]
    words = codes.companded([(i.name, i.mean, i.spacing) for i in uniform])
    complaints += [words] if words else []
    return Check(captures, [found[c.name] for c in captures], complaints, remarks)


def of_pictures(
    series: Sequence[Capture], sensor: Sensor, tell: Callable[[float], None]
) -> tuple[list[Integrity], Repeats]:
    """Return what scenes or charts say; their contrast counts as noise."""
    found = []
    for number, capture in enumerate(series):
        raw = capture.raw()
        counts = _core.code_counts(raw, 1, excluded_of(capture))
        render = None
        if (
            capture.shows.render
            and capture.scene
            and (scene := capture.scene()).ndim == 3
        ):
            render = beside_render(raw, scene, capture, sensor)
        found.append(integrity(capture, sensor, counts, render))
        tell((number + 1) / len(series))
    levels, errors = np.array([(one.mean, one.error) for one in found]).T
    names = [capture.name for capture in series]
    return found, Repeats(names, levels, float(errors.mean()))


def of_uniform(
    series: Sequence[Capture], sensor: Sensor, tell: Callable[[float], None]
) -> tuple[list[Integrity], Repeats | str]:
    """Return what darks or flats say, or why they say nothing of each other."""
    found: list[Integrity] = []
    first, step = series[0], step_of(sensor)
    side = repeat_of(sensor.cfa)

    def looked(number: int, counts: NDArray[np.uint32]) -> None:
        found.append(integrity(series[number], sensor, counts))

    names = tuple(capture.name for capture in series)
    info = GroupInfo("flat" if first.shows.light else "dark", names)
    try:
        statistics = frame_statistics(
            [(info, [capture.raw for capture in series])],
            side if min(first.shape) >= side else 1,
            sensor.white_level,
            step=step,
            excluded=excluded_of(first),
            progress=tell,
            looked=looked,
        )
    except ValueError as error:
        if len(found) < len(series):  # a frame cannot be read
            raise
        return found, f"{first.name} and its {len(series) - 1} repeats: {error}"
    if not first.shows.light:
        variance = float(statistics.variance(0).mean())
        found = [with_noise_remarks(one, variance, sensor) for one in found]
    return found, repeats_of(statistics, step)


def excluded_of(capture: Capture) -> NDArray[np.bool_] | None:
    """Return (H, W) bool, samples that do not count; None where all do."""
    return ~capture.mask() if capture.mask else None


def remarks_on(
    repeats: Repeats, is_lit: bool, sensor: Sensor, nuisances: Collection[str]
) -> list[str]:
    """Return what is no fault of the frames but worth a word."""
    if not is_lit:
        return [words] if (words := repeats.cosmic_rays()) else []
    drift = repeats.lamp_drift(float(np.mean(sensor.black_level)))
    if not drift:
        return []
    is_free = "light" in nuisances
    remedy = "covers it" if is_free else "would cover it: add it, or effects may"
    tail = "" if is_free else " be named for the lamp's sake"
    return [f"{drift}, a lamp that drifts; nuisance: [light] {remedy}{tail}"]
