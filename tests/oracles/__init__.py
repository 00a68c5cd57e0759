# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Independent float64 transcriptions of published formulas, to test the core against.

Written from DESIGN.md section 3, the DNG specification and the cited papers; they share
no code with the core."""
