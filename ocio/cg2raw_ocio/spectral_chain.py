# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convention spectral as a chain of OCIO transforms, around one table.

The core's function is homogeneous: twice the scene is twice the camera RGB. The chain
divides by n^2 (spectral_table.py), looks up what is left, and multiplies by n^2, so
that dark and bright pixels are as exact as others, and black is black. The products are
those of chain.product()."""

from typing import TYPE_CHECKING

import numpy as np
import PyOpenColorIO as ocio

from . import spectral_table
from .chain import (
    LARGEST_RADIANCE,
    LEAK,
    Array,
    Form,
    Op,
    clip,
    forms,
    legal,
    matrix,
    product,
)

if TYPE_CHECKING:
    from cg2raw._core import CameraTransform

# Of n, so that n^2 is at most 1 and what a product carries along keeps its digits.
DOWN = 2.0**-12
# A table of roots themselves ends here: at 4, two stops above white.
CLF_LIMIT = 2.0
UNIT = np.eye(4)


def camera_from_scene(
    transform: "CameraTransform", color_effects: Array | None = None
) -> list[Op]:
    """Linear Rec.709 -> camera RGB, nothing clipped but negative light.

    transform : of convention spectral, with its uplift.
    A pixel with NaN in any channel becomes black; +inf as bright as can be."""
    ops = roots(ocio.NEGATIVE_MIRROR) + chromaticity()
    ops += spectral_table.ops(np.asarray(transform.uplift)) + times_exposure()
    return ops + camera_from_balanced(transform, color_effects)


def of_roots(
    transform: "CameraTransform", color_effects: Array | None = None
) -> list[Op]:
    """The same without a product of channels, for a CLF: one table of square roots,
    which takes negative components for 0 and ends at CLF_LIMIT^2.

    The root of camera RGB is nearly linear in that of the scene: linear in the grey
    ones, for which tetrahedral interpolation is exact, and in r, g, b alone."""
    squares = ocio.ExponentTransform()
    squares.setValue([2.0, 2.0, 2.0, 1.0])
    return [
        *roots(ocio.NEGATIVE_CLAMP),
        matrix(np.eye(3) / CLF_LIMIT),
        spectral_table.table_of_roots(np.asarray(transform.uplift), CLF_LIMIT),
        squares,
        *camera_from_balanced(transform, color_effects),
    ]


def roots(style: ocio.NegativeStyle) -> list[Op]:
    """Scene -> square roots of finite pixels."""
    exponent = ocio.ExponentTransform()
    exponent.setValue([0.5, 0.5, 0.5, 1.0])
    exponent.setNegativeStyle(style)
    # Without what legal() adds of each channel to the others: a root shows it.
    return [*legal(), matrix(np.eye(3) - LEAK), exponent]


def camera_from_balanced(
    transform: "CameraTransform", color_effects: Array | None
) -> list[Op]:
    """White balance undone, then the colour effects."""
    ops = [matrix(np.diag(transform.gains)), clip(0.0, LARGEST_RADIANCE)]
    return ops + ([] if color_effects is None else [matrix(color_effects)])


def chromaticity() -> list[Op]:
    """Roots -> p, q, t as the table takes them, and (DOWN n)^2 in A; it is 0 for an n
    that is not above 0."""
    rows = np.diag([*spectral_table.WEIGHTS, 0.0])
    rows[3, :3] = spectral_table.WEIGHTS
    p, n = (UNIT[0], 0.0), (DOWN * UNIT[3], 0.0)
    t_and_1 = (-UNIT[0] - UNIT[1], 2.0)
    first, *others = product(n, t_and_1, n, p)
    p, t = (UNIT[3], 0.0), (UNIT[0] + UNIT[1] + UNIT[2], -1.0)
    q = (-t[0] - p[0], 2.0)
    slope = spectral_table.position(1.0) - spectral_table.position(0.0)
    start = spectral_table.position(0.0)
    places = [(slope * row, slope * shift + start) for row, shift in (p, q, t)]
    return [
        matrix(rows),
        ocio.FixedFunctionTransform(ocio.FIXED_FUNCTION_XYZ_TO_xyY),
        first,
        clip(0.0, 2.0 * spectral_table.LIMIT),
        *others,
        forms(*places, (UNIT[0], 0.0)),
    ]


def times_exposure() -> list[Op]:
    """What the table gives, times n^2 / SCALE; alpha 1."""
    red, green, blue, scale = _unit()
    ops = [clip(0.0, LARGEST_RADIANCE)]
    ops += product(red, _plus(green, 1.0), scale, blue)
    red, scale, green, blue = _after(1.0)
    ops += product(green, _plus(blue, 1.0), scale, red)
    green, scale, blue, red = _after(1.0)
    ops += product(blue, (green[0] + scale[0], 0.0), scale, red)
    blue, scale, _, red = _after(0.0)
    green = (UNIT[0] + UNIT[2], 0.0)
    up = 1.0 / (DOWN**2 * spectral_table.SCALE)
    result = [(up * form[0], 0.0) for form in (red, green, blue)]
    return [*ops, forms(*result, (np.zeros(4), 1.0))]


def _unit() -> list[Form]:
    return [(row, 0.0) for row in UNIT]


def _plus(form: Form, offset: float) -> Form:
    return form[0], form[1] + offset


def _after(carried: float) -> list[Form]:
    """Return x z, z, y - carried and aside after a product."""
    product, z, _, aside = _unit()
    return [product, z, (UNIT[0] + UNIT[1] + UNIT[2], -carried), aside]
