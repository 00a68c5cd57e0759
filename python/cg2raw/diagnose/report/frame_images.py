# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pictures of report frames: measured, simulated before and after, and residuals."""

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.diagnosis import Picture
from cg2raw.diagnose.report.text import is_known, number, rough_percent

SIGMAS = 4.0  # a residual map saturates there
COLOR_STEPS = (
    41  # colours of a residual map: as many as the eye tells apart, so it packs well
)
MASKED = (128, 128, 128)
WHITE_AT = 0.9  # of the display, for the brightest percentile
BRIGHTEST_PERCENTILE = 99.0  # percentile
LARGEST_GAIN = 64.0  # six stops: a dark stays dark
BUDGET = 1_900_000  # bytes of all frames' PNGs
REDUCTIONS = (1, 2, 3, 4, 6, 8)

Pixels = NDArray[np.floating]


@dataclass(frozen=True)
class Image:
    """A PNG, its size in pixels, and what it shows, in words with numbers."""

    name: str  # of its file
    png: bytes
    width: int
    height: int
    alt: str
    caption: str


@dataclass(frozen=True)
class Frame:
    """A report frame's five images, and how they were made to be seen."""

    name: str
    kind: str
    images: Sequence[Image]  # measured, before, after
    maps: Sequence[Image]  # before, after
    gain: float


def frames(pictures: Sequence[Picture]) -> list[Frame]:
    """Return the frames' images, reduced until all of them fit the budget."""
    for reduction in REDUCTIONS:
        made = [frame(p, n, reduction) for n, p in enumerate(pictures, 1)]
        size = sum(len(i.png) for f in made for i in (*f.images, *f.maps))
        if size <= BUDGET:
            break
    return made


def frame(picture: Picture, index: int, reduction: int) -> Frame:
    """Return the images of one frame; @index names their files."""
    balance = display_balance(picture)
    gain = display_gain(np.asarray(picture.measured) * balance)
    signals = (
        ("measured", "Measured", picture.measured),
        ("before", "Simulated mean before, without noise", picture.before),
        ("after", "Simulated mean after, without noise", picture.after),
    )
    residuals = (
        ("z_before", "Residual before", picture.z_before),
        ("z_after", "Residual after", picture.z_after),
    )
    stem = f"frame_{index:02}"
    return Frame(
        picture.name,
        picture.kind,
        [
            signal_image(f"{stem}_{key}.png", f"{caption}", picture.name, signal,
                         balance * gain, reduction)
            for key, caption, signal in signals
        ],
        [
            residual_image(f"{stem}_{key}.png", caption, picture.name, z, reduction)
            for key, caption, z in residuals
        ],
        gain,
    )  # fmt: skip


def signal_image(
    file: str, caption: str, name: str, signal: Pixels, scale: Pixels, reduction: int
) -> Image:
    """Return (h, w, 3) camera RGB times @scale as an sRGB picture."""
    signal = np.asarray(signal, np.float64)
    encoded = srgb(reduced_mean(signal, reduction) * scale)
    means = [number(mean_of(signal[..., c])) for c in range(3)]
    alt = (
        f"{caption}: {name}, mean signal of red, green and blue "
        f"{', '.join(means)} of white"
    )
    return image(file, encoded, None, caption, alt)


def residual_image(
    file: str, caption: str, name: str, z: Pixels, reduction: int
) -> Image:
    """Return (h, w) standard deviations as a map: red where measured is brighter."""
    z = np.asarray(z, np.float64)
    known = z[np.isfinite(z)]
    index, palette = map_colors(reduced_sum(z, reduction))
    rms = number(float(np.sqrt(np.mean(known**2))) if known.size else None)
    beyond = rough_percent(
        float(np.mean(np.abs(known) > SIGMAS)) if known.size else None
    )
    low, high = (known.min(), known.max()) if known.size else (None, None)
    alt = (
        f"{caption}: {name}, measured minus simulated, root mean square {rms} standard "
        f"deviations, from {number(low)} to {number(high)}, {beyond} of the cells "
        f"beyond {SIGMAS:g}"
    )
    shown = f"{caption}: rms {rms}, {beyond} beyond {SIGMAS:g}"
    return image(file, index, palette, shown, alt)


def image(
    file: str, pixels: NDArray[np.uint8], palette: bytes | None, caption: str, alt: str
) -> Image:
    """Return (h, w, 3) pixels, or (h, w) indices into @palette, as a PNG."""
    from PIL import Image as Pillow

    picture = Pillow.fromarray(pixels)
    if palette is not None:
        picture = picture.convert("P")
        picture.putpalette(palette)
    png = io.BytesIO()
    picture.save(png, "PNG")
    height, width = pixels.shape[:2]
    return Image(file, png.getvalue(), width, height, alt, caption)


def display_balance(picture: Picture) -> Pixels:
    """Return factors of camera RGB, G = 1: by the light's neutral, else the mean's."""
    neutral = picture.neutral
    if neutral is None:
        means = [mean_of(np.asarray(picture.measured)[..., c]) for c in range(3)]
        neutral = [x if is_known(x) else 1.0 for x in means]
    green = neutral[1]
    if not all(is_known(x) and x > 0 for x in neutral):
        return np.ones(3)
    return np.clip([green / x for x in neutral], 0.25, 4.0)


def display_gain(balanced: Pixels) -> float:
    """Return the gain that brings the brightest percentile near white, at least 1/4."""
    known = balanced[np.isfinite(balanced)]
    if not known.size:
        return 1.0
    bright = float(np.percentile(known, BRIGHTEST_PERCENTILE))
    return float(np.clip(WHITE_AT / max(bright, 1e-9), 0.25, LARGEST_GAIN))


def srgb(linear: Pixels) -> NDArray[np.uint8]:
    """Return linear values, 0..1, as sRGB codes. Source: IEC 61966-2-1."""
    x = np.clip(np.nan_to_num(linear), 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    codes: Pixels = np.rint(255 * encoded)
    return codes.astype(np.uint8)


def map_colors(z: Pixels) -> tuple[NDArray[np.uint8], bytes]:
    """Return indices of colours, and the palette; what is not known is grey."""
    from matplotlib import colormaps

    colors = colormaps["RdBu_r"](np.linspace(0, 1, COLOR_STEPS))[:, :3]
    palette = [*np.rint(255 * colors).astype(np.uint8).ravel().tolist(), *MASKED]
    known = np.isfinite(z)
    share = (np.clip(np.where(known, z, 0), -SIGMAS, SIGMAS) + SIGMAS) / (2 * SIGMAS)
    index = np.where(known, np.rint(share * (COLOR_STEPS - 1)), COLOR_STEPS).astype(
        np.uint8
    )
    return index, bytes(palette)


def mean_of(values: Pixels) -> float | None:
    """Return the mean of what is known, or None."""
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else None


def cells(values: Pixels, side: int) -> Pixels:
    """Return (h, w, ...) as (h', w', side^2, ...) cells; a rest at the edge is NaN."""
    height, width = (-(-n // side) for n in values.shape[:2])
    whole = np.full((height * side, width * side, *values.shape[2:]), np.nan)
    whole[: values.shape[0], : values.shape[1]] = values
    split = whole.reshape(height, side, width, side, *values.shape[2:]).swapaxes(1, 2)
    return split.reshape(height, width, side * side, *values.shape[2:])


def reduced_mean(values: Pixels, side: int) -> Pixels:
    """Return the means of cells of what is known, NaN where nothing is."""
    within = cells(values, side)
    count = np.isfinite(within).sum(axis=2)
    mean: Pixels = np.nansum(within, axis=2) / np.where(count, count, np.nan)
    return mean


def reduced_sum(z: Pixels, side: int) -> Pixels:
    """Return standard deviations of cells: their sum over the root of their number."""
    within = cells(z, side)
    count = np.isfinite(within).sum(axis=2)
    root = np.sqrt(np.where(count, count, np.nan))
    summed: Pixels = np.nansum(within, axis=2) / root
    return summed
