# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Draw the picture of docs/exposure.md: one render by night, exposed in six ways.

    ./studies/run exposure-picture [OUT.jpg]

Each part is the DNG that cg2raw convert writes, developed by cg2raw render. Without
OUT.jpg: docs/images/exposure.jpg. Needs OpenImageIO and pillow.
"""

import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw

from cg2raw.cli import main as cg2raw
from studies.pictures.readme import font
from studies.places import ROOT

RENDER = ROOT / "tests/data/night_street.exr"
OPTIONS = "--sensor sony-a7s-ii --illuminant 3000K --tone-curve linear".split()
SETTINGS = "--scene-luminance 12 --f-number 2 --iso 3200".split()
PARTS = (
    ("exposure -2", ["--exposure=-2"]),
    ("exposure 0: the render as it is", []),
    ("exposure +2", ["--exposure=2"]),
    ("exposure auto", ["--exposure=auto"]),
    (
        "1/60 s, f/2, ISO 3200, value 1 at 12 cd/m\u00b2",
        [*SETTINGS, "--exposure-time=1/60"],
    ),
    ("f/2, ISO 3200, exposure auto finds 1/10 s", [*SETTINGS, "--exposure=auto"]),
)
WIDTH, GAP, LABEL = 800, 8, 34  # px


def part(folder, words):
    """Return one DNG of the render, developed, as an image."""
    dng, developed = folder / "shot.dng", folder / "shot.png"
    for command in (
        ["convert", RENDER, "-o", dng, *OPTIONS, *words, "--quiet"],
        ["render", dng, "-o", developed, "--quiet"],
    ):
        if cg2raw([str(word) for word in command]) != 0:
            raise SystemExit(f"cg2raw {command[0]} failed")
    image = Image.open(developed).convert("RGB")
    return image.resize((WIDTH, round(WIDTH * image.height / image.width)))


def main(words):
    """Write the picture; return 0."""
    out = Path(words[0]) if words else ROOT / "docs/images/exposure.jpg"
    with tempfile.TemporaryDirectory() as name:
        images = [part(Path(name), options) for _, options in PARTS]
    height = images[0].height + LABEL
    rows = (len(PARTS) + 1) // 2
    size = (2 * WIDTH + GAP, rows * height + (rows - 1) * GAP)
    picture = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(picture)
    for n, ((label, _), image) in enumerate(zip(PARTS, images, strict=True)):
        left, top = n % 2 * (WIDTH + GAP), n // 2 * (height + GAP)
        picture.paste(image, (left, top + LABEL))
        draw.text((left, top + LABEL / 2), label, "black", font(22), anchor="lm")
    picture.save(out, quality=88, optimize=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
