# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Find where simulation and measurement disagree, name the effect, add it.

captures   what was measured, and what was in front of the lens
"""
