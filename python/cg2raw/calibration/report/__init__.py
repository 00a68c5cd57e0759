# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The page of a calibration: its curves, maps and numbers, in one file."""

import os

from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.report.page import page_of
from cg2raw.io.atomic_file import write_with_folder
from cg2raw.io.report_page import html_of

PAGE = "calibration.html"

__all__ = ["write_report"]


def write_report(found: Measurements, folder: str) -> str:
    """Write calibration.html into a folder, which is made if it is not there; return
    the page's path. Raises ValueError if Jinja2 or Pillow is missing, OSError; a folder
    that was not there is not there then."""
    path = os.path.join(folder, PAGE)
    write_with_folder(path, html_of(page_of(found)).encode())
    return path
