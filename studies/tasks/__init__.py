# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The studies: each measures over cameras and returns numbers for tables."""
