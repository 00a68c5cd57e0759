# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""CIEDE2000 of linear sRGB colours.

Source: CIE 142-2001, as G. Sharma, W. Wu and E. N. Dalal, Color Research & Application
30(1), 2005, print it."""

import numpy as np

from . import adobe


def lab_from_linear_srgb(rgb):
    """CIE L*a*b* relative to D65 of linear sRGB (..., 3)."""
    ratio = np.asarray(rgb, float) @ adobe.xyz_d65_from_srgb().T / adobe.xyz(adobe.D65)
    small = ratio * 841.0 / 108.0 + 4.0 / 29.0
    f = np.where(ratio > (6.0 / 29.0) ** 3, np.cbrt(ratio), small)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _hue(a, b):
    return np.where((a == 0) & (b == 0), 0.0, np.degrees(np.arctan2(b, a)) % 360.0)


def _mean_hue(h1, h2, product):
    """Mean of two hues on the circle; their sum if one colour has none."""
    mean = (h1 + h2) / 2.0
    far = np.abs(h1 - h2) > 180.0
    mean = np.where(far, np.where(h1 + h2 < 360.0, mean + 180.0, mean - 180.0), mean)
    return np.where(product == 0.0, h1 + h2, mean)


def de2000(lab1, lab2):
    """Colour difference of L*a*b* (..., 3), with kL = kC = kH = 1."""
    L1, a1, b1 = np.moveaxis(np.asarray(lab1, float), -1, 0)
    L2, a2, b2 = np.moveaxis(np.asarray(lab2, float), -1, 0)
    c_bar = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2.0
    g = 0.5 * (1.0 - np.sqrt(c_bar**7 / (c_bar**7 + 25.0**7)))
    a1, a2 = (1.0 + g) * a1, (1.0 + g) * a2
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = _hue(a1, b1), _hue(a2, b2)
    turn = (h2 - h1 + 180.0) % 360.0 - 180.0
    turn = np.where(h2 - h1 == 180.0, 180.0, turn)
    dH = 2.0 * np.sqrt(c1 * c2) * np.sin(np.radians(turn) / 2.0)
    L, c, h = (L1 + L2) / 2.0, (c1 + c2) / 2.0, np.radians(_mean_hue(h1, h2, c1 * c2))
    t = (
        1.0
        - 0.17 * np.cos(h - np.radians(30.0))
        + 0.24 * np.cos(2.0 * h)
        + 0.32 * np.cos(3.0 * h + np.radians(6.0))
        - 0.20 * np.cos(4.0 * h - np.radians(63.0))
    )
    s_l = 1.0 + 0.015 * (L - 50.0) ** 2 / np.sqrt(20.0 + (L - 50.0) ** 2)
    s_c, s_h = 1.0 + 0.045 * c, 1.0 + 0.015 * c * t
    angle = 60.0 * np.exp(-(((np.degrees(h) - 275.0) / 25.0) ** 2))
    r_t = -2.0 * np.sqrt(c**7 / (c**7 + 25.0**7)) * np.sin(np.radians(angle))
    dL, dC, dH = (L2 - L1) / s_l, (c2 - c1) / s_c, dH / s_h
    return np.sqrt(dL**2 + dC**2 + dH**2 + r_t * dC * dH)


def between_linear_srgb(rgb1, rgb2):
    return de2000(lab_from_linear_srgb(rgb1), lab_from_linear_srgb(rgb2))
