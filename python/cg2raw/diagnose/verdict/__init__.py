# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What a fit of darks and flats says, as a Diagnosis."""
