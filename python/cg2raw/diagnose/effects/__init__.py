# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Effects: one file is all that the inference knows of one effect."""
