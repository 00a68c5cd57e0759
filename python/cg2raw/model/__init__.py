# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What darks and flats say of a sensor, by one likelihood of their statistics."""
