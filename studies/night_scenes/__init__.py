# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""292 scenes at night for the evidence study, each drawn from its index.

choices/ says what stands where: pure Python, no Blender. parts/ builds it, and street,
square, waterfront and interior put it together; these need the module bpy. main runs
the workers, statistics measures how much the frames differ."""
