# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""report.html of a diagnosis: one file with its pictures, without network or scripts.

page            what it says, section by section
charts          SVG of measured, before and after
values          parameters in units that are measured
text            numbers and sentences
frame_images    measured and residual pictures
folder          all files of a report
"""

from cg2raw.diagnose.report.page import write_report

__all__ = ["write_report"]
