# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What frames of darks and flats say, after one pass over their pixels."""
