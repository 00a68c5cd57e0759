# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Families of effects that look alike, and what captures have to show of one."""

# Families of effects that may pass for each other.
GAIN = "gain"
RESPONSE = "response"
SPREAD = "spread"
TEMPORAL = "temporal"
PEDESTAL = "pedestal"

# What captures have to show.
LIGHT = frozenset({"light"})
IMAGE = frozenset({"light", "image"})
TIME = frozenset({"time"})
LEVEL = frozenset({"light", "level"})
LEVELS = frozenset({"light", "levels"})
LIGHT_AGAIN = frozenset({"light", "repeats"})
