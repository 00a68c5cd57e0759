# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The page docs/evidence.md: sections between marks that `evidence --docs` writes.

A section stands between the lines <!-- study: NAME --> and <!-- end: NAME -->; what is
around them is written by hand."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from studies.places import ROOT

PAGE = ROOT / "docs" / "evidence.md"
STUDIES = (
    "classical",
    "colour",
    "illuminant",
    "denoising",
    "isp",
    "exposures",
    "content",
)
FIGURES = {  # what a reader without pictures is told, by section
    "scenes": "Scenes as the camera sees them, developed, and as a renderer has them; "
    "the first two rows by day, the others by night",
    "gap": "How much worse than with the camera's own frames; bars of one standard "
    "error, a dotted line where other frames of the camera are",
    "translation": "Distance of translated renders from captures of the camera during "
    "training, of each translator; dotted that of the camera's own training frames",
    "illuminant": "Share of test frames below each angular error, one line a source",
    "night": "Test frames at ISO 1600, to the left, and 3200: the goal, what is not "
    "denoised, and what is denoised and developed as each source teaches",
    "isp": "The goal, the input, and pictures by neural ISPs; below them how far each "
    "pixel is from the goal",
}

OF = {  # studies, of any of which a figure is; the others are of the world
    "gap": ("illuminant", "denoising", "isp"),
    "illuminant": ("illuminant",),
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


def update_page(tables: Mapping[str, str], folder: Path, page: Path = PAGE) -> None:
    """Put tables, and the figures that a folder has, into a page and its images.

    A study's figure is left out without tables of it. Raises ValueError naming the page
    and what it lacks; then nothing is written."""
    drawn = [
        name
        for name in FIGURES
        if (folder / f"{name}.png").exists()
        and (name not in OF or set(OF[name]) & set(tables))
    ]
    try:
        text = write_docs(page.read_text(), sections(tables, drawn))
    except (OSError, ValueError) as error:
        raise ValueError(f"{page}: {error}") from None
    page.write_text(text)
    (page.parent / "images").mkdir(exist_ok=True)
    for name in drawn:
        png = (folder / f"{name}.png").read_bytes()
        (page.parent / "images" / image(name)).write_bytes(png)
