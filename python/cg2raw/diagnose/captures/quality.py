# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Checks that captures are what their manifest says, before they are diagnosed."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.cfa import repeat_of, sites_of
from cg2raw.diagnose.captures.capture import KINDS, Capture, Kind
from cg2raw.diagnose.captures.phase_correlation import (
    LEAST_ALIKE,
    Shift,
    edges,
    far_words,
    likeness,
    shared,
    shift_between,
    unlike_words,
)
from cg2raw.diagnose.diagnosis import LARGEST_SHIFT
from cg2raw.sensor import Sensor
from cg2raw.statistics import codes

MUCH_CLIPPING = 0.05  # of a frame's pixels; then its highlights say nothing
DARK_SIGMAS = 10.0  # that a dark's mean may be off black: a light leak is more
# Of the pixels, at 0: more than a normal dark leaves whose black is 2.3 sigma above 0.
MANY_ZEROS = 0.01
ZERO_WORDS = (
    f"more than {MANY_ZEROS:.0%} of the pixels are 0, where the ADC cuts off what is "
    "darker: they count as censored; mean and deviation of blacks are wrong"
)
MOST_ZEROS = 0.5  # of the pixels, at 0: the median is cut off, too
HOLES = 0.05  # share of missing codes that is worth a word; small frames have some
ALONE = 0.5  # share of pixels at codes without neighbours; noise leaves none
LIT = 1.0  # DN above black of a frame that holds light, if it has to be brighter


@dataclass(frozen=True)
class Beside:
    """A capture beside its render. shift : px of the sensor. alike : as of likeness,
    without a shift or with it. light : DN above black, mean of what is predicted."""

    shift: Shift
    alike: float
    light: float

    @property
    def complaints(self) -> list[str]:
        """What is wrong with the render."""
        if self.alike < LEAST_ALIKE:
            return [unlike_words(self.alike)]
        shift = self.shift
        is_far = max(abs(shift.down), abs(shift.right)) > LARGEST_SHIFT
        is_far &= shift.is_told
        return [far_words(shift.down, shift.right)] if is_far else []


@dataclass(frozen=True)
class Integrity:
    """What one frame's pixels say.

    low, high, mean : DN. error : DN, standard error of the mean, if all that differs is
    chance. below, clipped : share of pixels at 0 and at the white level or above.
    step : DN, of which all codes are multiples, from the lowest. missing : share of
    codes that no pixel has between frequent ones, at that step.
    spacing : DN, from one frequent code to the next, 0 where none are.
    shift : px, of a scene against its render. complaints : sentences on what is wrong.
    remarks : sentences on what the frame cannot show, though nothing is wrong."""

    name: str
    kind: Kind
    low: int
    high: int
    mean: float
    below: float
    clipped: float
    step: int = 1
    missing: float = 0.0
    shift: Shift | None = None
    error: float = 0.0
    spacing: int = 0
    complaints: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def integrity(
    capture: Capture,
    sensor: Sensor,
    by_plane: NDArray[np.uint32],
    render: Beside | None = None,
) -> Integrity:
    """Return what the pixels of a capture say.

    by_plane : (planes, codes) how many of those that count have each code. render : of
    a scene."""
    counts = by_plane.sum(axis=0, dtype=np.int64)
    present, total = np.flatnonzero(counts), int(counts.sum())
    mean = float(counts @ np.arange(len(counts))) / total
    variance = float(counts @ (np.arange(len(counts)) - mean) ** 2) / total
    known = step_of(sensor)
    below = counts[: sensor.white_level]  # codes above are cut off, not empty
    in_steps = np.add.reduceat(below, np.arange(0, len(below), known))
    step, number = codes.step_of(in_steps)
    if number < codes.LEAST_CODES or total < codes.FEW:
        step = 1
    found = Integrity(
        name=capture.name,
        kind=capture.kind,
        low=int(present[0]),
        high=int(present[-1]),
        mean=mean,
        error=float(np.sqrt(variance / total)),
        below=float(counts[0] / total),
        clipped=float(counts[sensor.white_level :].sum() / total),
        step=step * known,
        missing=codes.gaps(in_steps[int(in_steps.argmax()) % step :: step]),
        shift=None if render is None else render.shift,
        spacing=codes.spacing(below),
    )
    misfit = codes.misfit(counts, sensor.bits, sensor.white_level)
    words = [
        *level_complaints(found, variance**0.5, sensor, render),
        *([misfit] if misfit else code_complaints(found, in_steps, sensor)),
        *([] if render is None else render.complaints),
    ]
    remarks = [ZERO_WORDS] if found.below > MANY_ZEROS else []
    return replace(found, complaints=tuple(words), remarks=tuple(remarks))


def of_means(capture: Capture, sensor: Sensor) -> Integrity:
    """Return what a table of patch means says of itself."""
    means = capture.means
    assert means is not None
    values = means.mean[means.measured]
    words = []
    if not values.size:
        values = np.zeros(1)
        words.append("no patch has a mean: nothing was measured")
    if values.max() >= sensor.white_level:
        words.append(
            f"a mean of {values.max():.0f} DN is at white ({sensor.white_level} DN): "
            "clipped patches belong into no mean; leave them empty, with cut high"
        )
    return Integrity(
        name=capture.name,
        kind=capture.kind,
        low=int(values.min()),
        high=int(values.max()),
        mean=float(values.mean()),
        below=float((means.side < 0).mean()),
        clipped=float((means.side > 0).mean()),
        complaints=tuple(words),
    )


def level_complaints(
    found: Integrity, spread: float, sensor: Sensor, render: Beside | None
) -> list[str]:
    """Return what is wrong with a frame's levels. spread : DN, standard deviation."""
    words = []
    if found.low == found.high:
        words.append(f"all pixels are {found.low} DN: holds no picture")
    if found.clipped > MUCH_CLIPPING:
        words.append(f"{found.clipped:.0%} of the pixels are clipped: expose less")
    black = float(np.mean(sensor.black_level))
    is_lit = KINDS[found.kind].light
    if not is_lit and found.mean - black > max(DARK_SIGMAS * spread, 1.0):
        words.append(
            f"its mean is {found.mean - black:.0f} DN above black: is it dark?"
        )
    light = np.inf if render is None else render.light
    if is_lit and found.mean - black < min(LIT, light / 2):
        words.append("holds no light: is it a dark?")
    return words


def step_of(sensor: Sensor) -> int:
    """Return the DN from one code to the next that a profile states, else 1."""
    for effect in sensor.effects or ():
        if effect["name"] == "quantisation":
            step = float(effect["parameters"]["step"]) * sensor.signal_range
            return max(round(step), 1)
    return 1


def code_complaints(
    found: Integrity, counts: codes.Counts, sensor: Sensor
) -> list[str]:
    """Return what codes say of a frame that was scaled or copied.

    counts : of codes in the steps that the profile states."""
    if found.step > step_of(sensor):
        return [
            f"only one in {found.step} codes occurs: scaled from fewer bits; if this "
            "is the camera's own RAW, cg2raw calibrate puts that into its profile"
        ]
    if codes.isolated(counts) > ALONE and found.low < found.high:
        return [
            f"only {np.count_nonzero(counts)} codes occur, most of them without a "
            "neighbour: a copy of fewer bits; give the camera's own file"
        ]
    if found.missing > HOLES:
        return [
            f"{found.missing:.0%} of the codes between frequent ones are missing: the "
            "camera or a program has scaled its values; noise of a few DN cannot be "
            "judged"
        ]
    return []


def with_noise_remarks(found: Integrity, variance: float, sensor: Sensor) -> Integrity:
    """Return a dark's Integrity with what its noise cannot show, if it is right.

    variance : of its pixels, DN^2, nan where it is not known."""
    step = step_of(sensor)
    if found.complaints:
        return found
    if found.below > MOST_ZEROS:
        words = "most pixels are 0: its read noise cannot be judged at all"
    elif found.below <= MANY_ZEROS and variance < codes.COARSE * step**2:
        words = (
            f"its read noise is below {codes.hidden(step):.2g} DN: its size and tails "
            "(a Tukey lambda, heavy tails) are those of the rounding, and cannot be "
            "judged"
        )
    else:
        return found
    return replace(found, remarks=(*found.remarks, words))


def beside_render(
    raw: RawImage, scene: NDArray[np.float32], capture: Capture, sensor: Sensor
) -> Beside:
    """Return what a capture and its render, which are of one size, have in common."""
    light = sensor.illuminant(capture.illuminant, capture.as_shot)
    camera = sensor.to_camera(scene, illuminant=light, highlights=False)
    repeat = repeat_of(sensor.cfa)
    model = green_cells(sensor.mosaic(np.clip(camera, 0, 1)), sensor.cfa)
    measured = green_cells(np.minimum(sensor.signal_from_raw(raw), 1), sensor.cfa)
    shift = shift_between(np.maximum(measured, 0), model)
    # Of noise, neighbours have nothing in common.
    noise = float(np.sqrt(np.mean(np.diff(measured, axis=1) ** 2) / 2))
    every = np.ones(model.shape, bool)
    alike = 0.0
    for first, second in (
        (measured, model),
        (edges(measured, every), edges(model, every)),
    ):
        for moved in ((0, 0), (round(shift.down), round(shift.right))):
            alike = max(alike, likeness(*shared(first, second, *moved), noise))
    return Beside(
        Shift(shift.down * repeat, shift.right * repeat, shift.correlation),
        alike,
        float(model.mean()) * sensor.signal_range,
    )


def green_cells(mosaic: NDArray[np.float32], cfa: str) -> NDArray[np.float64]:
    """Return the mean of the green sites of each repeat of the CFA; without filters,
    the pixels."""
    letters, repeat = sites_of(cfa), repeat_of(cfa)
    height, width = (side // repeat for side in mosaic.shape)
    total = np.zeros((height, width))
    for index in (index for index, letter in enumerate(letters) if letter == "G"):
        row, col = divmod(index, repeat)
        total += mosaic[row::repeat, col::repeat][:height, :width]
    return total / letters.count("G")
