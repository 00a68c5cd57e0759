# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Frames: a CaptureSet becomes arrays in signal units, on tiles."""
