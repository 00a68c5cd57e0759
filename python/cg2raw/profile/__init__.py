# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Where sensor profiles come from: files of the camera, or its measurements.

A profile under construction is the dictionary of its JSON fields; parse_profile of the
core checks the finished one.
"""
