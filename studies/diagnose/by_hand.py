# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""By hand: what plain formulas say of the 36 frames of a CCD, with standard errors.

    ./studies/run ccd-by-hand --data FOLDER

prints a table and writes it to studies/diagnose/frozen/by_hand.json, the reference of
docs/diagnose-real.md. FOLDER (or CG2RAW_REAL_FRAMES) has real/ccd; its frames may not
be passed on. Noise is that of differences of two frames of disjoint pairs, in which all
that is fixed cancels; patterns are products of two means of other frames, in which
noise does."""

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dctn, idctn

from studies.diagnose.real_frames import Shot, add_data, ccd, folder_of

Plane = NDArray[np.float64]

FILE = Path(__file__).with_name("frozen") / "by_hand.json"
CUT = 64  # half waves per frame: patterns with at least as many, down a column or along
# a row, are high-pass; of 1024 px those with waves of 32 px and shorter
HOT = 8.0  # read noises above the median of the mean 60-s dark
SLOW = 12  # half waves down a column: what drifts more slowly within a frame is not the
# row's own. It falls as 1/f: row noise is 0.20 DN of all waves, 0.10 DN from CUT on
ODD = 8.0  # robust sd of the high-pass response, beyond which a pixel is dust or dead
NEAR = 16  # cosines along a row, next to the mean, that have its pixels' noise
BLOCK = 32  # px, of which differences of flats lose the mean: the lamp's shape changes


class Value(NamedTuple):
    """A figure and its standard error."""

    value: float
    error: float


def mean_of(values: list[float] | Plane) -> Value:
    """Return a mean and its standard error by the scatter."""
    found = np.asarray(values, float)
    return Value(float(found.mean()), float(found.std(ddof=1) / np.sqrt(found.size)))


def product(first: Plane, second: Plane) -> Value:
    """Return the sd of what two sets of coefficients share, as the root of their mean
    product; its error is that of the product of two normals."""
    shared = float((first * second).mean())
    spread = np.sqrt(((first**2).mean() * (second**2).mean() + shared**2) / first.size)
    sd = np.sqrt(max(shared, 0.0))
    return Value(float(sd), float(spread / 2 / sd) if sd else float(spread**0.5))


def cosines(plane: Plane) -> Plane:
    """Return the orthonormal cosine transform, whose mean square is the plane's."""
    found: Plane = dctn(plane, norm="ortho")
    return found


@dataclass(frozen=True)
class Frames:
    """The frames, each (H, W) uint16 DN, in the order in which they were taken."""

    shots: list[Shot]

    def of(self, kind: str, seconds: float | None = None) -> list[Plane]:
        return [
            shot.frame.astype(float)
            for shot in self.shots
            if shot.kind == kind and seconds in (None, shot.seconds)
        ]

    @cached_property
    def pairs(self) -> list[Plane]:
        """Differences of the biases' disjoint pairs over the root of 2, less their mean
        and with what is beyond 8 sigma at 0: cosmic rays."""
        biases = self.of("dark", 0.0)
        found = []
        for one, other in zip(biases[::2], biases[1::2], strict=True):
            d = (one - other) / np.sqrt(2)
            d -= np.median(d)
            d[np.abs(d) > 8 * d[np.abs(d) < 100].std()] = 0.0
            found.append(d - d.mean())
        return found

    def halves(self, kind: str, seconds: float) -> tuple[Plane, Plane]:
        """Means of every other frame."""
        frames = self.of(kind, seconds)
        return np.mean(frames[::2], axis=0), np.mean(frames[1::2], axis=0)

    @cached_property
    def hot(self) -> NDArray[np.bool_]:
        """Pixels that are hot in the mean dark of 60 s."""
        rise = np.mean(self.of("dark", 60.0), axis=0)
        rise = rise - np.mean(self.of("dark", 0.0), axis=0)
        return np.asarray(rise - np.median(rise) > HOT * read_noise(self).value)

    @cached_property
    def levels(self) -> tuple[Plane, Plane]:
        """(exposure times, mean levels of pixels that are not hot) of all darks."""
        darks = [shot for shot in self.shots if shot.kind == "dark"]
        means = [float(shot.frame[~self.hot].mean()) for shot in darks]
        return np.array([shot.seconds for shot in darks]), np.array(means)


def black_level(f: Frames) -> Value:
    """Mean of the biases, DN; the error is that of ten levels that drift."""
    return mean_of([frame.mean() for frame in f.of("dark", 0.0)])


def drift(f: Frames) -> Value:
    """Sd of the levels of ten biases, DN; its error is sd / sqrt(2 (n - 1))."""
    levels = np.array([frame.mean() for frame in f.of("dark", 0.0)])
    sd = float(levels.std(ddof=1))
    return Value(sd, sd / np.sqrt(2 * (len(levels) - 1)))


def read_noise(f: Frames) -> Value:
    """Temporal sd of a pixel in biases, DN: root of the mean variance of the pairs.
    With row noise and rounding (1/12 DN^2), without the drift of the level."""
    variance = mean_of([float((d**2).mean()) for d in f.pairs])
    drawn = variance.value * np.sqrt(2 / (len(f.pairs) * f.pairs[0].size))
    sd = float(np.sqrt(variance.value))
    return Value(sd, float(max(variance.error, drawn) / 2 / sd))


def row_noise(f: Frames) -> Value:
    """Sd of a row's own offset in one frame, DN, of the SLOW and faster waves down the
    column: the power of row means less that of the NEAR next cosines along the row,
    which have the pixels' noise with its correlation."""
    own, pixels = [], []
    for d in f.pairs:
        power = cosines(d)[SLOW:] ** 2
        own.append(power[:, 0])
        pixels.append(power[:, 1 : 1 + NEAR])
    width = f.pairs[0].shape[1]
    above, below = float(np.mean(own)), float(np.mean(pixels))
    variance = (above - below) / width
    counts = np.size(own), np.size(pixels)
    error = np.hypot(above * np.sqrt(2 / counts[0]), below * np.sqrt(2 / counts[1]))
    sd = np.sqrt(max(variance, 0.0))
    return Value(float(sd), float(error / width / 2 / sd))


def correlation(f: Frames) -> Value:
    """Correlation of read noise with the next pixel of its row, with row means taken
    off; that of noise without any, -1 / (W - 1), is taken off as well."""
    found = []
    for d in f.pairs:
        d = d - d.mean(axis=1, keepdims=True)
        lag = (d[:, 1:] * d[:, :-1]).mean() / (d**2).mean()
        found.append(float(lag) + 1 / (d.shape[1] - 1))
    value = mean_of(found)
    drawn = 1 / np.sqrt(len(f.pairs) * f.pairs[0].size)
    return Value(value.value, float(max(value.error, drawn)))


def dark_current(f: Frames) -> Value:
    """Slope, DN/s, of the levels of all darks against exposure time by least squares:
    the mean of pixels that are not hot (HOT). The error is White's, for levels that
    scatter more at long times, as the cooler's temperature makes them."""
    seconds, levels = f.levels
    off = seconds - seconds.mean()
    slope = (off * levels).sum() / (off**2).sum()
    rest = levels - levels.mean() - slope * off
    count = len(levels) / (len(levels) - 2)
    return Value(
        float(slope), float(np.sqrt(count * ((off * rest) ** 2).sum()) / (off**2).sum())
    )


def hot_pixels(f: Frames) -> Value:
    """Share of the pixels that are hot: more than HOT read noises above the median in
    the mean dark of 60 s."""
    share = float(f.hot.mean())
    return Value(share, float(np.sqrt(share * (1 - share) / f.hot.size)))


def gain(f: Frames) -> Value:
    """Electrons per DN: light and dark charge of the flats over their variance beyond
    the read noise. Flats are brought to one level and their differences lose means of
    BLOCK; hot pixels and those beyond 6 sigma are left out."""
    flats = f.of("flat")
    black = np.mean(f.of("dark", 0.0), axis=0)
    level = float(np.mean([(flat - black)[~f.hot].mean() for flat in flats]))
    found = []
    for one, other in zip(flats[::2], flats[1::2], strict=True):
        a, b = (flat - black for flat in (one, other))
        d = (a / a[~f.hot].mean() - b / b[~f.hot].mean()) * level / np.sqrt(2)
        d -= around(d)
        kept = ~f.hot & (np.abs(d) < 6 * d[~f.hot].std())
        d = blocks(np.where(kept, d, 0.0))
        count = blocks(kept).sum(axis=(1, 3), keepdims=True)
        rest = (d**2).sum() - (d.sum(axis=(1, 3), keepdims=True) ** 2 / count).sum()
        variance = float(rest / (kept.sum() - count.size))
        found.append(level / (variance - read_noise(f).value ** 2))
    value = mean_of(found)
    drawn = value.value * np.sqrt(2 / (len(found) * f.hot.size))
    return Value(value.value, float(max(value.error, drawn)))


def blocks(plane: NDArray[Any]) -> NDArray[Any]:
    """Return (H, W) as (H / BLOCK, BLOCK, W / BLOCK, BLOCK)."""
    height, width = plane.shape
    return plane.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK)


def around(plane: Plane) -> Plane:
    """Return the median of every pixel's block."""
    apart = blocks(plane)
    middle = np.median(apart, axis=(1, 3), keepdims=True)
    return np.broadcast_to(middle, apart.shape).reshape(plane.shape)


def _is_fast(shape: tuple[int, ...]) -> NDArray[np.bool_]:
    kept = np.ones(shape, bool)
    kept[:CUT, :CUT] = False
    return kept


def fast(plane: Plane) -> Plane:
    """Return the high-pass coefficients (CUT), but for those of columns and rows."""
    kept = _is_fast(plane.shape)
    kept[0] = kept[:, 0] = False
    return cosines(plane)[kept]


def prnu(f: Frames) -> Value:
    """Sd of the pixels' response relative to what is around them, high-pass (CUT), of
    flats less their dark. Hot pixels, and those beyond ODD robust sd of the high-pass
    response, are taken as those around them: with them it is 0.55 %."""
    halves = []
    for n in range(2):
        flat = f.halves("flat", 23.0)[n]
        bias, dark = f.halves("dark", 0.0)[n], f.halves("dark", 60.0)[n]
        light = flat - bias - (dark - bias) * 23.0 / 60.0
        light = np.where(f.hot, around(light), light)
        halves.append(light / around(light).mean())
    slow = cosines((halves[0] + halves[1]) / 2)
    slow = idctn(np.where(_is_fast(slow.shape), 0.0, slow), norm="ortho")
    response = [half / slow - 1 for half in halves]
    both = np.abs(response[0] + response[1]) / 2
    off = both > ODD * 1.4826 * float(np.median(both))
    first, second = (fast(np.where(off, 0.0, half)) for half in response)
    return product(first, second)


def _offsets(f: Frames) -> tuple[Plane, Plane]:
    """Two mean biases; hot pixels, which leak while they are read, as around them."""
    one, other = f.halves("dark", 0.0)
    return np.where(f.hot, around(one), one), np.where(f.hot, around(other), other)


def dsnu(f: Frames) -> Value:
    """Sd of the pixels' offsets in biases, DN, high-pass (CUT), without what columns or
    rows share and without hot pixels: with them it is 4.5 DN."""
    one, other = _offsets(f)
    return product(fast(one), fast(other))


def column_fixed_pattern(f: Frames) -> Value:
    """Sd of the columns' offsets in biases, DN, high-pass (CUT) along the row, without
    hot pixels; what pixels add to a column's mean is taken off."""
    one, other = (cosines(half) for half in _offsets(f))
    height = one.shape[0]
    whole = product(one[0, CUT:], other[0, CUT:])
    variance = (whole.value**2 - dsnu(f).value ** 2) / height
    sd = np.sqrt(max(variance, 0.0))
    return Value(float(sd), float(whole.value * whole.error / height / sd))


FIGURES: list[tuple[Callable[[Frames], Value], str]] = [
    (black_level, "DN"),
    (drift, "DN"),
    (read_noise, "DN"),
    (row_noise, "DN"),
    (correlation, "1"),
    (column_fixed_pattern, "DN"),
    (dsnu, "DN"),
    (dark_current, "DN/s"),
    (hot_pixels, "1"),
    (gain, "e-/DN"),
    (prnu, "1"),
]


def table(frames: Frames) -> dict[str, dict[str, float | str]]:
    """Return name -> value, its standard error, unit and definition."""
    return {
        figure.__name__: {
            **figure(frames)._asdict(),
            "unit": unit,
            "definition": " ".join((figure.__doc__ or "").split()),
        }
        for figure, unit in FIGURES
    }


def main() -> int:
    """Print the table and write it; 1 without the frames."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    add_data(parser)
    parser.add_argument("--output", type=Path, default=FILE)
    given = parser.parse_args()
    try:
        found = table(Frames(ccd(folder_of(given.data))))
    except (OSError, ValueError) as error:
        print(f"ccd-by-hand: {error}", file=sys.stderr)
        return 1
    for name, one in found.items():
        print(f"{name:22}{one['value']:12.5g} +- {one['error']:<10.2g}{one['unit']}")
    given.output.write_text(json.dumps(found, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
