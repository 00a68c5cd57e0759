# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Captures: files become a CaptureSet: what was measured, what was before the lens."""
