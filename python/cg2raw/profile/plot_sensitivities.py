# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The picture of a sensor's spectral sensitivities."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:  # matplotlib takes its time
    from matplotlib.axes import Axes

# Distinct for all common colour vision. Source: Okabe and Ito, Color Universal
# Design, 2008.
CURVES = {"R": "#d55e00", "G": "#009e73", "B": "#0072b2"}
OF = {"energy": "radiant energy", "photon": "a photon"}


def draw_sensitivities(axes: "Axes", sensitivities: Mapping[str, Any]) -> None:
    """Draw the curves of R, G and B, or the one of a monochrome sensor.

    sensitivities : SensorProfile.spectral_sensitivities."""
    rgb = np.array(sensitivities["rgb"])
    wavelengths = sensitivities["wavelengths"]
    if np.ptp(rgb, axis=1).any():
        for (name, color), curve in zip(CURVES.items(), rgb.T, strict=True):
            axes.plot(wavelengths, curve, color=color, linewidth=1.6, label=name)
        axes.legend(loc="upper right", fontsize=9, framealpha=0.9)
    else:
        axes.plot(wavelengths, rgb[:, 0], color="black", linewidth=1.6)
    axes.axhline(0.0, color="0.6", linewidth=0.6)
    axes.set(
        xlabel="wavelength, nm",
        ylabel=f"response to {OF[sensitivities['unit']]}",
        xlim=(wavelengths[0], wavelengths[-1]),
    )
    axes.set_title("spectral sensitivities", fontsize=11)
    axes.grid(color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
