# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectral sensitivities in words, and as curves of one line each."""

from collections.abc import Mapping
from typing import Any

import numpy as np

STEP = 10.0  # nm, of a character
LEVELS = (
    "\u2581\u2582\u2583\u2584\u2585\u2586\u2587\u2588"  # an eighth to a whole block
)
PLAIN_LEVELS = "_.:-=+*#"  # where a terminal has no blocks


def sensitivity_fields(
    sensitivities: Mapping[str, Any] | None, encoding: str
) -> list[tuple[str, str]]:
    """Return [(field, text), ...]: range, unit, and a curve of each channel.

    sensitivities : as summary() has them; None: nothing is returned.
    encoding : of the terminal."""
    if sensitivities is None:
        return []
    name = "spectral_sensitivities"
    wavelengths = np.array(sensitivities["wavelengths"])
    curves = np.array(sensitivities["rgb"])
    channels = "RGB" if np.ptp(curves, axis=1).any() else ["mono"]
    unit = {"energy": "radiant energy", "photon": "photons"}[sensitivities["unit"]]
    scale = sensitivities["scale"]
    fields = [
        (
            name,
            f"{wavelengths[0]:g} to {wavelengths[-1]:g} nm, {len(wavelengths)} rows, "
            f"response to {unit}" + (f", 1 is {scale:.4g} as measured" * (scale != 1)),
        )
    ]
    for channel, curve in zip(channels, curves.T, strict=False):
        peak = wavelengths[np.argmax(curve)]
        line = curve_line(wavelengths, curve / curves.max(), encoding)
        fields.append((f"{name} {channel}", f"{line} peak {peak:g} nm"))
    return fields


def curve_line(wavelengths: Any, values: Any, encoding: str) -> str:
    """Return a character for every 10 nm; values (n,) of 0 to 1."""
    levels = LEVELS if can_show(encoding) else PLAIN_LEVELS
    at = np.arange(wavelengths[0], wavelengths[-1] + STEP / 2, STEP)
    heights = np.clip(np.interp(at, wavelengths, values), 0.0, 1.0)
    return "".join(levels[i] for i in np.rint(heights * (len(levels) - 1)).astype(int))


def can_show(encoding: str) -> bool:
    """Return whether text of an encoding may have blocks."""
    try:
        LEVELS.encode(encoding)
    except (UnicodeEncodeError, LookupError):
        return False
    return True
