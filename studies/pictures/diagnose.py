# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make the picture of docs/diagnose.md: the top of the report of its example.

    ./studies/run diagnose-pictures [FOLDER]

Needs Chromium. FOLDER is docs/images if it is not given.
"""

import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageChops

from cg2raw.cli import main as cg2raw
from studies.places import ROOT

CAPTURES = (
    "synthesize --effects lens_shading=0.3,row_noise=0.2 -s canon-5d-mark-iv --seed 1"
)
COLORS = 256  # of a picture's palette
WIDTH, HEIGHT = 1240, 1600
HIDDEN = "footer, details, .boxes"  # a CSS selector of what is not shown


def report(folder):
    """Diagnose the captures of the example; return the folder of the report."""
    for words in (
        ["diagnose", *CAPTURES.split(), "-o", f"{folder}/blind"],
        ["diagnose", f"{folder}/blind/captures.yaml", "-o", f"{folder}/report"],
    ):
        if cg2raw(words) != 0:
            raise SystemExit(f"cg2raw {' '.join(words)} failed")
    return Path(folder) / "report"


def picture_of(page, hidden):
    """Return what Chromium shows of a page without some of its parts, trimmed."""
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        raise SystemExit("no Chromium: apt-get install chromium")
    part, shot = page.with_name("part.html"), page.with_name("shot.png")
    part.write_text(f"{page.read_text()}<style>{hidden} {{display: none}}</style>")
    command = [
        chromium, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
        f"--user-data-dir={page.parent / 'chromium'}", f"--screenshot={shot}",
        f"--window-size={WIDTH},{HEIGHT}", part.as_uri(),
    ]  # fmt: skip
    subprocess.run(command, check=True, capture_output=True)
    image = Image.open(shot).convert("RGB")
    border = Image.new("RGB", image.size, image.getpixel((0, image.height - 1)))
    _, _, _, bottom = ImageChops.difference(image, border).getbbox()
    return image.crop((0, 0, image.width, min(bottom + 16, image.height)))


def save(image, path):
    """Write a small PNG."""
    data = io.BytesIO()
    image.quantize(COLORS).save(data, "PNG", optimize=True)
    path.write_bytes(data.getvalue())
    print(f"{path}: {path.stat().st_size} bytes")


def main():
    """Write the picture."""
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs/images"
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        page = report(folder) / "report.html"
        save(picture_of(page, HIDDEN), target / "diagnose_verdict.png")


if __name__ == "__main__":
    main()
