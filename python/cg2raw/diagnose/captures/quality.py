# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Checks that captures are what their manifest says, before they are diagnosed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.cfa import repeat_of, sites_of
from cg2raw.diagnose.captures.capture import KINDS, Capture, Kind
from cg2raw.diagnose.captures.phase_correlation import Shift, shift_between
from cg2raw.diagnose.diagnosis import LARGEST_SHIFT
from cg2raw.sensor import Sensor

MUCH_CLIPPING = 0.05  # of a frame's pixels; then its highlights say nothing
LEAST_CORRELATION = 0.3  # of a scene and its render; unrelated ones have below 0.1
DARK_SIGMAS = 10.0  # that a dark's mean may be off black: a light leak is more
FEW = 100  # pixels whose values are worth a look at their comb


@dataclass(frozen=True)
class Integrity:
    """What one frame's pixels say.

    low, high, mean : DN. below, clipped : share of pixels at 0 and at the white level
    or above. step : all codes are multiples of it, from the lowest. missing : share of
    codes that no pixel has where they are dense, of those at that step.
    shift : px, of a scene against its render. complaints : sentences."""

    name: str
    kind: Kind
    low: int
    high: int
    mean: float
    below: float
    clipped: float
    step: int
    missing: float
    shift: Shift | None
    complaints: tuple[str, ...]


def integrity(capture: Capture, sensor: Sensor) -> Integrity:
    """Return what the pixels of a capture say; all of it is read."""
    raw = capture.raw()
    mask = capture.mask() if capture.mask else None
    values = raw if mask is None else raw[mask]
    counts = np.bincount(values.ravel())
    codes = np.flatnonzero(counts)
    step, missing = comb(counts)
    scene = capture.scene() if capture.scene else None
    shift = None
    if scene is not None and scene.ndim == 3 and capture.shows.render:
        shift = registration(raw, scene, capture, sensor)
    found = Integrity(
        name=capture.name,
        kind=capture.kind,
        low=int(codes[0]),
        high=int(codes[-1]),
        mean=float(values.mean()),
        below=float(counts[0] / values.size),
        clipped=float(counts[sensor.white_level :].sum() / values.size),
        step=step,
        missing=missing,
        shift=shift,
        complaints=(),
    )
    words = [*level_complaints(found, values, sensor), *scene_complaints(shift)]
    return Integrity(**{**vars(found), "complaints": tuple(words)})


def comb(counts: NDArray[np.int64]) -> tuple[int, float]:
    """Return (step of the codes that occur, share of missing ones at that step).

    counts : how many pixels have each DN. Codes are looked for between the quartiles,
    where none is missing by chance."""
    total = np.cumsum(counts)
    first, last = np.searchsorted(total, [total[-1] / 4, total[-1] * 3 / 4])
    codes = np.flatnonzero(counts[first : last + 1])
    if len(codes) < 2 or total[-1] < FEW:
        return 1, 0.0
    step = int(np.gcd.reduce(np.diff(codes)))
    return step, 1 - len(codes) / ((codes[-1] - codes[0]) // step + 1)


def level_complaints(found: Integrity, values: RawImage, sensor: Sensor) -> list[str]:
    """Return what is wrong with a frame's levels."""
    words = []
    most = 2**sensor.bits - 1
    if found.high > most:
        words.append(f"{found.high} DN does not fit into {sensor.bits} bits ({most})")
    if found.low == found.high:
        words.append(f"all pixels are {found.low} DN: holds no picture")
    if found.clipped > MUCH_CLIPPING:
        words.append(f"{found.clipped:.0%} of the pixels are clipped: expose less")
    black = float(np.mean(sensor.black_level))
    spread = float(np.std(values))
    is_lit = KINDS[found.kind].light
    if not is_lit and found.mean - black > max(DARK_SIGMAS * spread, 1.0):
        words.append(
            f"its mean is {found.mean - black:.0f} DN above black: is it dark?"
        )
    if is_lit and found.mean - black < 1.0:
        words.append("holds no light: is it a dark?")
    if found.step > 1:
        words.append(f"only every {found.step}th code occurs: scaled from fewer bits")
    return words


def scene_complaints(shift: Shift | None) -> list[str]:
    """Return what is wrong with a render."""
    if shift is None:
        return []
    if shift.correlation < LEAST_CORRELATION:
        return [
            f"the scene does not correspond: correlation {shift.correlation:.2f} with "
            "its render"
        ]
    if max(abs(shift.down), abs(shift.right)) > LARGEST_SHIFT:
        return [
            f"its render is {shift.down:+.1f} px down, {shift.right:+.1f} px right of "
            f"it; a diagnosis takes up {LARGEST_SHIFT:g} px"
        ]
    return []


def registration(
    raw: RawImage, scene: NDArray[np.float32], capture: Capture, sensor: Sensor
) -> Shift:
    """Return the shift of a render against its capture, px of the sensor."""
    light = sensor.illuminant(capture.illuminant, capture.as_shot)
    camera = sensor.to_camera(scene, illuminant=light, highlights=False)
    repeat = repeat_of(sensor.cfa)
    model = green_cells(sensor.mosaic(np.clip(camera, 0, 1)), sensor.cfa)
    measured = green_cells(sensor.signal_from_raw(raw), sensor.cfa)
    shift = shift_between(np.clip(measured, 0, 1), model)
    return Shift(shift.down * repeat, shift.right * repeat, shift.correlation)


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
