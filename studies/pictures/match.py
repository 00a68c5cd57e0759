# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Draw the picture of docs/match.md: two plots of a page of cg2raw match.

    ./studies/run match-picture RENDERS [OUT.png]

Every other render of a folder becomes a capture, at an exposure of median 1.8 and
standard deviation 0.7 stops, and is compared with the others. Without OUT.png:
docs/images/match.png. Needs OpenImageIO, matplotlib and pillow.
"""

import base64
import io
import re
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw

from cg2raw.cli import main as cg2raw
from studies.pictures.readme import font
from studies.places import ROOT

SENSOR = "sony-a7s-ii"
EXPOSURE = "--exposure=normal:1.8:0.7"
PLOTS = ("Levels", "Luminance")
LABEL, GAP = 34, 16  # px


def plots(renders, folder):
    """Return the images of PLOTS of a page about renders."""
    captured, kept = folder / "captures", folder / "renders"
    for place in (captured, kept):
        place.mkdir()
    for number, render in enumerate(renders):
        if number % 2:
            (kept / render.name).symlink_to(render)
            continue
        dng = captured / f"{number}.dng"
        options = ["--sensor", SENSOR, "--illuminant", "D65", "--iso", 3200, EXPOSURE]
        run("convert", render, "-o", dng, *options, "--frame", number, "--quiet")
    run("match", captured, kept, "-s", SENSOR, "--report", folder / "page", "--quiet")
    html = (folder / "page/match.html").read_text()
    found = re.findall(r'base64,([^"]*)" alt="(\w+)', html)
    pngs = {title: base64.b64decode(data) for data, title in found}
    return [Image.open(io.BytesIO(pngs[title])).convert("RGB") for title in PLOTS]


def run(*words):
    """Run a command of cg2raw. Raises SystemExit if it fails."""
    if cg2raw([str(word) for word in words]) != 0:
        raise SystemExit(f"cg2raw {words[0]} failed")


def main(words):
    """Write the picture; return 0."""
    if not words:
        raise SystemExit("give a folder of renders")
    renders = sorted(path.resolve() for path in Path(words[0]).glob("*.exr"))
    out = Path(words[1]) if words[1:] else ROOT / "docs/images/match.png"
    with tempfile.TemporaryDirectory() as name:
        images = plots(renders, Path(name))
    width = sum(image.width for image in images) + GAP * (len(images) - 1)
    picture = Image.new("RGB", (width, images[0].height + LABEL), "white")
    draw, left = ImageDraw.Draw(picture), 0
    for title, image in zip(PLOTS, images, strict=True):
        picture.paste(image, (left, LABEL))
        draw.text((left + GAP, LABEL / 2), title, "black", font(22), anchor="lm")
        left += image.width + GAP
    picture.save(out, optimize=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
