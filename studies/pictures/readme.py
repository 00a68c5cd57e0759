# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Draw the picture at the top of the README: a render, its RAW mosaic, that developed.

    ./studies/run readme-picture [OUT.png]

All parts show one band of the README's first RAW file, pixel for pixel: the render as
sRGB, the DN of the DNG in the colours of their filters, and `cg2raw render` of it. The
squares are the same pixels, enlarged. Without OUT.png: docs/images/hero.png.
Needs OpenImageIO and pillow.
"""

import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
import rawpy
from PIL import Image, ImageDraw, ImageFont

from cg2raw.cli import main as cg2raw
from cg2raw.io.image_file import read_image
from studies.places import ROOT

RENDER = ROOT / "tests/data/interior.exr"
OPTIONS = "--sensor samsung-s20fe --illuminant 2856K --iso 3200".split()
LEFT, TOP, WIDTH, HEIGHT = 64, 552, 1600, 400  # px of the band in the render
SEAMS = (592, 1058)  # px in the band, between the three pictures
LEAN = 46  # px by which a seam leans
PATCH = (854, 680, 24)  # px: left and top in the render, and side, of what is enlarged
ZOOM = 6  # of the pixels in the squares
MOSAIC_GAIN = 2.0  # of the mosaic alone: each of its pixels is dark in two channels
LABELS = (
    ("Render", "scene-linear EXR"),
    ("RAW mosaic", "DNG, 2856 K lamp"),
    ("Developed", "LibRaw, ISO 3200"),
)


def srgb8(linear):
    """Return linear values 0..1 as 8-bit sRGB. Source: IEC 61966-2-1."""
    x = np.clip(linear, 0.0, 1.0)
    curve = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return (curve * 255.0 + 0.5).astype(np.uint8)


def mosaic_of(dng):
    """Return the DN of a DNG, each in the colour of its filter, as 8-bit sRGB."""
    with rawpy.imread(str(dng)) as raw:
        black, white = raw.black_level_per_channel[0], raw.white_level
        signal = (raw.raw_image_visible.astype(np.float32) - black) / (white - black)
        channel = np.array([0, 1, 2, 1])[raw.raw_colors_visible]
    return srgb8(MOSAIC_GAIN * signal[..., None] * (channel[..., None] == np.arange(3)))


def pictures(folder):
    """Return the render, its mosaic and the developed DNG, as images."""
    dng, developed = folder / "shot.dng", folder / "shot.png"
    for words in (
        ["convert", RENDER, "-o", dng, *OPTIONS, "--quiet"],
        ["render", dng, "-o", developed, "--quiet"],
    ):
        if cg2raw([str(word) for word in words]) != 0:
            raise SystemExit(f"cg2raw {words[0]} failed")
    render = srgb8(read_image(RENDER).pixels)
    return [
        Image.fromarray(render),
        Image.fromarray(mosaic_of(dng)),
        Image.open(developed).convert("RGB"),
    ]


def font(size, bold=False):
    """Return the font of the labels, which comes with matplotlib."""
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(Path(matplotlib.get_data_path(), "fonts/ttf", name), size)


def right_of(seam, scale=4):
    """Return the mask of what lies right of a leaning seam, antialiased."""
    mask = Image.new("L", (WIDTH * scale, HEIGHT * scale), 0)
    top, bottom = (seam + LEAN / 2) * scale, (seam - LEAN / 2) * scale
    corners = [(top, 0), (WIDTH * scale, 0), (WIDTH * scale, HEIGHT * scale)]
    ImageDraw.Draw(mask).polygon([*corners, (bottom, HEIGHT * scale)], fill=255)
    return mask.resize((WIDTH, HEIGHT), Image.Resampling.BOX)


def shade():
    """Return the mask of what darkens the band behind its labels."""
    down = np.clip((np.arange(HEIGHT) / HEIGHT - 0.62) / 0.38, 0.0, 1.0)
    column = (205 * down**0.8).astype(np.uint8)[:, None]
    return Image.fromarray(np.repeat(column, WIDTH, axis=1))


def draw_label(band, left, picture, texts):
    """Draw the enlarged patch of a picture, and its name beside that."""
    x, y, side = PATCH
    square = picture.crop((x, y, x + side, y + side))
    square = square.resize((side * ZOOM, side * ZOOM), Image.Resampling.NEAREST)
    top = HEIGHT - 20 - square.height
    band.paste(square, (left, top))
    draw = ImageDraw.Draw(band)
    box = (left - 2, top - 2, left + square.width + 1, HEIGHT - 19)
    draw.rectangle(box, outline="white", width=2)
    text = left + square.width + 18
    draw.text((text, HEIGHT - 94), texts[0], "white", font(34, bold=True))
    draw.text((text, HEIGHT - 48), texts[1], (226, 226, 226), font(23))


def main():
    """Write the picture."""
    target = sys.argv[1] if len(sys.argv) > 1 else ROOT / "docs/images/hero.png"
    with tempfile.TemporaryDirectory() as folder:
        shown = pictures(Path(folder))
    bands = [each.crop((LEFT, TOP, LEFT + WIDTH, TOP + HEIGHT)) for each in shown]
    strip = bands[0]
    for seam, band in zip(SEAMS, bands[1:], strict=True):
        strip.paste("white", (0, 0), right_of(seam - 1))
        strip.paste(band, (0, 0), right_of(seam + 1))
    strip.paste("black", (0, 0), shade())
    x, y, side = PATCH[0] - LEFT, PATCH[1] - TOP, PATCH[2]
    box = (x - 2, y - 2, x + side + 1, y + side + 1)
    ImageDraw.Draw(strip).rectangle(box, outline="white", width=2)
    for start, picture, texts in zip((0, *SEAMS), shown, LABELS, strict=True):
        draw_label(strip, start + 24, picture, texts)
    palette = strip.quantize(256, method=Image.Quantize.MEDIANCUT, kmeans=3)
    strip = strip.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
    strip.save(target, optimize=True)


if __name__ == "__main__":
    main()
