# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shapes, materials and lights of the scenes at night. Needs the module bpy."""
