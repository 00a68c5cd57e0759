# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Terms of lens_shading that a round lens does without, in complex numbers."""

# Powers of the radius, and how often its term goes up and down around the centre.
IRREGULAR = (
    (2, 2), (3, 3), (4, 2), (4, 4), (5, 1), (5, 3), (5, 5), (6, 2), (6, 4), (6, 6),
)  # fmt: skip


def irregular_terms(u, v):
    """Return {parameter: its term} at places in half diagonals from the centre."""
    place = u + 1j * v
    terms = {}
    for power, angles in IRREGULAR:
        turned = abs(place) ** (power - angles) * place**angles
        terms[f"r{power}_cos{angles}"] = turned.real
        terms[f"r{power}_sin{angles}"] = turned.imag
    return terms
