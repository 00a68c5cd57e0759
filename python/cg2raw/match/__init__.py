# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What RAW captures and renders look like, and the exposure that is between them."""

from cg2raw.match.captures import Capture, captures_in, read_capture
from cg2raw.match.comparison import Comparison, check_counts, compare
from cg2raw.match.frame import Frame, look
from cg2raw.match.renders import Model, read_render, renders_in
from cg2raw.match.shift import Levels, Shift, shift_between, shift_of

__all__ = [
    "Capture",
    "Comparison",
    "Frame",
    "Levels",
    "Model",
    "Shift",
    "captures_in",
    "check_counts",
    "compare",
    "look",
    "read_capture",
    "read_render",
    "renders_in",
    "shift_between",
    "shift_of",
]
