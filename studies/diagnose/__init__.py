# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Benchmark of the diagnosis: hidden effects, drawn by seed; how many it names."""
