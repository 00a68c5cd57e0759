# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""One likelihood of darks and flats: fit(statistics), and figures_of what it found."""

from cg2raw.model.figures import Figure, figures_of
from cg2raw.model.fit import Fit, fit

__all__ = ["Figure", "Fit", "figures_of", "fit"]
