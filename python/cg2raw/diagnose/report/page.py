# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The page: the template filled with sections and pictures, written with its PNGs."""

import base64
import re
from pathlib import Path
from typing import Any

from cg2raw.diagnose.diagnosis import Diagnosis
from cg2raw.diagnose.report import sections
from cg2raw.diagnose.report.figures import MISSING, Figures, draw
from cg2raw.diagnose.report.frame_images import Image
from cg2raw.io.atomic_file import write_atomically

OURS = re.compile(
    r"(gap|residual_tests|histogram|scale|curve_\d{2,}|photon_transfer|dark_levels"
    r"|pattern_(dark|flat)_(before|after)|profiles_(dark|flat)"
    r"|frame_\d{2,}_(measured|before|after|z_before|z_after))\.png"
)


def write_report(diagnosis: Diagnosis, folder: Path) -> None:
    """Write report.html and its PNGs into @folder, which is made if need be.

    The page holds the pictures itself: it needs no other file, network or script. Same
    diagnosis, same bytes. PNGs that an earlier report left there and this one does not
    have are removed. Raises ValueError if a library is missing, OSError."""
    figures = draw(diagnosis)
    page = render(diagnosis, figures)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    images = figures.images()
    for image in images:
        write_atomically(folder / image.name, image.png)
    write_atomically(folder / "report.html", page.encode())
    names = {image.name for image in images}
    for file in folder.iterdir():
        if OURS.fullmatch(file.name) and file.name not in names:
            file.unlink()


def render(diagnosis: Diagnosis, figures: Figures) -> str:
    """Return the text of report.html. Raises ValueError if Jinja2 is missing."""
    try:
        import jinja2
    except ImportError:
        raise ValueError(MISSING) from None
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("cg2raw.diagnose.report"),
        autoescape=True,  # names of frames are anybody's
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["uri"] = data_uri
    return environment.get_template("report.html.jinja").render(
        **content(diagnosis), figures=figures
    )


def content(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return all that the template shows but the figures."""
    count = max(len(diagnosis.tests_before), len(diagnosis.tests_after), 1)
    return {
        "summary": sections.summary(diagnosis),
        "findings": sections.findings(diagnosis),
        "has_sensor": diagnosis.characteristics is not None,
        "not_shown": list(diagnosis.characteristics.missing)
        if diagnosis.characteristics is not None
        else [],
        "losses": sections.losses(diagnosis.effects),
        "ladder": sections.ladder(diagnosis),
        "residual_tests": sections.residual_tests(diagnosis),
        "unexplained": [sections.answer(t, count) for t in diagnosis.unexplained],
        "detection_limits": sections.detection_limits(diagnosis.detection_limits),
        "groups": sections.groups(diagnosis),
        "next_captures": diagnosis.next_captures,
        "notes": diagnosis.notes,
        "profile_json": diagnosis.profile_json,
        "curves": diagnosis.curves,
    }


def data_uri(image: Image) -> str:
    """Return an image as the address that holds it."""
    return "data:image/png;base64," + base64.b64encode(image.png).decode("ascii")
