# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The figures of the studies: of what results.json has, and pictures of the world."""
