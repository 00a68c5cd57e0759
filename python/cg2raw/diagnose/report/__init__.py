# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""report.html of a diagnosis: one file with its pictures, without network or scripts.

page        the file: sections put into the template
sections    what the template shows, row by row
words       numbers and sentences
frames      measured, simulated and residual pictures
plots       drawings
figures     all pictures of a report, with words for those who cannot see them
"""

from cg2raw.diagnose.report.page import write_report

__all__ = ["write_report"]
