# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The HTML of a calibration's page: one file, without scripts."""

from itertools import chain, groupby

from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.report.curves import curves
from cg2raw.calibration.report.maps import maps
from cg2raw.calibration.table import Row, rows_of, told
from cg2raw.io.figures_page import filled


def page(found: Measurements) -> str:
    """Return the page. Raises ValueError if Jinja2 or Pillow is missing."""
    return filled(
        "cg2raw.calibration.report",
        "calibration.html.jinja",
        chain(curves(found), maps(found)),
        sensor=found.sensor.id,
        frames=f"{found.frames[0]} darks and {found.frames[1]} flats",
        size=f"{found.shape[1]} x {found.shape[0]}",
        iso="" if found.iso is None else f"ISO {found.iso:g}, ",
        sections=[
            (name, [cells(row) for row in rows])
            for name, rows in groupby(rows_of(found), lambda row: row.section)
        ],
        transients=found.transients,
        notes=found.notes,
    )


def cells(row: Row) -> tuple[str, str, str, str]:
    """Return name, value, electrons and what else is to be said of a number."""
    value = told(row.value) if row.value else "not shown by these frames"
    electrons = told(row.electrons) if row.electrons else ""
    return row.name, value, electrons, row.more
