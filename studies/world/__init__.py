# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The spectral world: scenes of measured spectra, coloured by them or by RGB."""
