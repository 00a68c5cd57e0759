# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sources of training data: each makes camera RGB and neutrals of a camera."""
