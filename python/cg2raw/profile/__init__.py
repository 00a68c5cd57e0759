# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensor profiles: made of a camera's files, summed up, drawn.

A profile under construction is the dictionary of its JSON fields; parse_profile of the
core checks the finished one.
"""
