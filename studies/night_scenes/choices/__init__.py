# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What stands where in a scene at night: data, drawn from an index. No geometry."""
