# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The page docs/evidence.md: sections between marks, by scripts/evidence --docs.

A section stands between the lines <!-- study: NAME --> and <!-- end: NAME -->; what is
around them is written by hand."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from textwrap import fill
from typing import Any

from studies.draws import RENDERS
from studies.figures.files import figures_of_results
from studies.places import ROOT
from studies.protocol import PROTOCOL
from studies.summaries import (
    COMMITTED,
    Summaries,
    committed_text,
    joined,
    read_committed,
)
from studies.tables_of_results import tables_by_study
from studies.tables_paired import REAL
from studies.tasks.isp import CAMERA
from studies.tasks.paired import difference

PAGE, README = ROOT / "docs" / "evidence.md", ROOT / "README.md"
WIDTH = 110  # columns of README.md
STUDIES = (
    "classical",
    "colour",
    "illuminant",
    "light_draws",
    "denoising",
    "files",
    "photographs",
    "denoising_unet",
    "isp",
    "isp_unet",
    "content",
)
BY_LIGHT = (
    "Mean error by the colour temperature of the main light and under LED lamps, a "
    "line a source, with standard errors"
)
FIGURES = {  # what a reader without pictures is told, by section
    "scenes": "Scenes as the camera sees them, developed, and as a renderer has them; "
    "the first two rows by day, the others by night",
    "gap": "How much worse than with the camera's own frames; bars of one standard "
    "error, a dotted line where other frames of the camera are",
    "translation": "Distance of translated renders from captures of the camera during "
    "training, of each translator; dotted that of the camera's own training frames",
    "illuminant": BY_LIGHT,
    "light": f"{BY_LIGHT}; hollow: no LEDs in training",
    "night": "Test frames at ISO 1600, to the left, and 3200: the goal, what is not "
    "denoised, and what is denoised and developed as each source teaches",
    "isp": "The goal, the input, and pictures by neural ISPs; below them how far each "
    "pixel is from the goal",
}

OURS, UPI, WORLD = "ours, match", "upi, match", "ours, match, world's scenes"
OF = {  # studies, of any of which a figure is; the others are of the world
    "gap": ("illuminant", "light_draws", "denoising", "isp", "photographs"),
    "illuminant": ("illuminant",),
    "light": ("light_draws",),
    "isp": ("isp",),
}


def marks(name: str) -> tuple[str, str]:
    """Return the lines between which a section stands."""
    return f"<!-- study: {name} -->", f"<!-- end: {name} -->"


def write_docs(page: str, sections: Mapping[str, str]) -> str:
    """Return a page whose sections of these names are replaced.

    Raises ValueError for one whose marks the page does not have once each, in order."""
    for name, text in sections.items():
        start, end = marks(name)
        before, _, rest = page.partition(start)
        _, _, after = rest.partition(end)
        if page.count(start) != 1 or page.count(end) != 1 or end not in rest:
            raise ValueError(f"must have one line {start} and, below it, one {end}")
        page = f"{before}{start}\n\n{text.strip()}\n\n{end}{after}"
    return page


def readme_text(found: Mapping[str, Any]) -> str:
    """Return the sentence of README.md: how far behind real ours and UPI are by night.

    found : Summaries with the neural ISP and the denoiser of renders at night."""

    def gaps(study: str, measure: str, sign: int, source: str) -> list[float]:
        cameras = found[f"{study}, {RENDERS}"]["cameras"].values()
        return [
            sign * difference(goal[source][measure], goal[REAL][measure]).mean
            for camera in cameras
            for name, goal in camera.items()
            if name != CAMERA
        ]

    def behind(study: str, measure: str, sign: int, source: str) -> str:
        values = gaps(study, measure, sign, source)
        return f"{min(values):.2f} to {max(values):.2f}"

    def count(study: str) -> str:
        cameras = len(found[f"{study}, {RENDERS}"]["cameras"])
        return "1 camera" if cameras == 1 else f"{cameras} cameras"

    colour, noise = ("isp", "difference", 1), ("denoising", "psnr", -1)
    isos = " and ".join(f"{iso:g}" for iso in PROTOCOL.denoising.isos)
    text = (
        "Trained on renders of night scenes that `cg2raw match` exposed, a small "
        f"neural ISP is {behind(*colour, OURS)} CIEDE2000 behind one that is trained "
        f"on the camera's own frames, on {count('isp')} (UPI at the same exposures: "
        f"{behind(*colour, UPI)}), and a denoiser {behind(*noise, OURS)} dB, on "
        f"{count('denoising')} at ISO {isos} (UPI: {behind(*noise, UPI)}). Trained on "
        "renders of scenes like the camera's own, the ISP is within "
        f"{max(map(abs, gaps(*colour, WORLD))):.2f} of it."
    )
    return fill(text, WIDTH, break_on_hyphens=False)


def sections(tables: Mapping[str, str], figures: Iterable[str]) -> dict[str, str]:
    """Return the text of each section: a study's tables, a figure, or both."""
    found = {name: [text] for name, text in tables.items()}
    for name in figures:
        found.setdefault(name, []).append(link(name))
    return {name: "\n\n".join(parts) for name, parts in found.items()}


def link(figure: str) -> str:
    """Return the Markdown that shows a figure."""
    return f"![{FIGURES[figure]}](images/{image(figure)})"


def image(figure: str) -> str:
    """Return the name of a figure's file among the images of docs."""
    return f"evidence_{figure}.png"


def write_page(
    made: Summaries,
    folder: Path,
    page: Path = PAGE,
    committed: Path = COMMITTED,
    readme: Path = README,
) -> None:
    """Put summaries into the committed file, and all tables of that into the page, with
    the figures that a folder has, and a sentence into the README.

    A study's figure is left out without tables of it; one that is not drawn anew stays,
    and one of several studies has those that were committed before. Raises ValueError
    naming the page and what it lacks; then nothing is written."""
    found = joined(read_committed(committed), made)
    tables = tables_by_study(found, PROTOCOL.classical.within)
    own = tables_by_study(made, PROTOCOL.classical.within)
    pngs = {
        name: (folder / f"{name}.png").read_bytes()
        for name in FIGURES
        if (folder / f"{name}.png").exists()
    } | figures_of_results(found)
    drawn = [n for n in FIGURES if n in pngs and (n not in OF or {*OF[n]} & {*own})]
    try:
        before = page.read_text()
        shown = [n for n in FIGURES if n in drawn or n in tables and link(n) in before]
        text = write_docs(before, sections(tables, shown))
    except (OSError, ValueError) as error:
        raise ValueError(f"{page}: {error}") from None
    try:
        front = readme.read_text()
        if {f"isp, {RENDERS}", f"denoising, {RENDERS}"} <= set(found):
            front = write_docs(front, {"readme": readme_text(found)})
    except (OSError, ValueError) as error:
        raise ValueError(f"{readme}: {error}") from None
    committed.write_text(committed_text(found))
    page.write_text(text)
    readme.write_text(front)
    (page.parent / "images").mkdir(exist_ok=True)
    for name in drawn:
        (page.parent / "images" / image(name)).write_bytes(pngs[name])
