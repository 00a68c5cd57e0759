# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Colours of lamps and of neon, linear Rec.709."""

import colorsys

# CIE 1931 xy to linear Rec.709 of luminance 1, white at D65. Source: ITU-R BT.709.
RGB_FROM_XYZ = (
    (3.2409699, -1.5373832, -0.4986108),
    (-0.9692436, 1.8759675, 0.0415551),
    (0.0556301, -0.2039770, 1.0569715),
)


def planckian_xy(kelvin):
    """Return the chromaticity of a black body of 1667 to 25000 K.

    Source: cubic splines of Kim et al., US patent 7024034, 2006."""
    if not 1667 <= kelvin <= 25000:
        raise ValueError(f"kelvin {kelvin} must lie in 1667..25000")
    t = 1000.0 / kelvin
    if kelvin <= 4000:
        x = ((-0.2661239 * t - 0.2343589) * t + 0.8776956) * t + 0.179910
    else:
        x = ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.240390
    if kelvin <= 2222:
        y = ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
    elif kelvin <= 4000:
        y = ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
    else:
        y = ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483
    return x, y


def uv_from_xy(x, y):
    """Return CIE 1960 u, v."""
    scale = -2 * x + 12 * y + 3
    return 4 * x / scale, 6 * y / scale


def xy_from_uv(u, v):
    """Return CIE 1931 x, y."""
    scale = 2 * u - 8 * v + 4
    return 3 * u / scale, 2 * v / scale


def lamp_rgb(kelvin, duv=0.0):
    """Return a lamp's colour of luminance 1; duv > 0 is greener than the black body.

    What Rec.709 cannot show is cut off at 0."""
    u, v = uv_from_xy(*planckian_xy(kelvin))
    hotter_u, hotter_v = uv_from_xy(*planckian_xy(kelvin * 1.01))
    along_u, along_v = hotter_u - u, hotter_v - v
    length = (along_u**2 + along_v**2) ** 0.5
    # Hotter means less u: turned right by a quarter the locus points to green, more v.
    u, v = u + duv * along_v / length, v - duv * along_u / length
    x, y = xy_from_uv(u, v)
    xyz = (x / y, 1.0, (1 - x - y) / y)
    rgb = [
        max(0.0, sum(m * c for m, c in zip(row, xyz, strict=True)))
        for row in RGB_FROM_XYZ
    ]
    return tuple(rgb)


def neon_rgb(hue, saturation=1.0):
    """Return a saturated colour, its largest part 1; hue is 0..1 of the circle."""
    parts = colorsys.hsv_to_rgb(hue % 1.0, saturation, 1.0)
    return tuple(max(0.012, part**2.2) for part in parts)
