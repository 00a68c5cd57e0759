# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the tables of spectra that the core is built with.

plugins/core/illuminant_lamp_tables.h: power of the CIE's lamps, as colour-science has
it (CIE 015, tables 10 to 12).
plugins/core/illuminant_daylight_tables.h: components of daylight (table 6 there), and
what the eye sees of each wavelength (table 1).
plugins/core/transform_uplift_basis.h: spectra that reflectances are made of by RGB,
fitted to the Academy's 190 training reflectances.

    .venv/bin/python scripts/spectra_tables.py      # from the root, after scripts/setup
"""

import argparse
import subprocess
import sys
from pathlib import Path

import colour
import numpy as np
from colour.colorimetry import SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES

from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.matrix_fit import training_reflectances, xyz_under
from cg2raw.profile.spectral_file import WAVELENGTHS

ROOT = Path(__file__).resolve().parents[1]
HEAD = """// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file {what}
#pragma once

#include <array>

namespace cg2raw {{

"""
LAMPS = (
    *(f"FL{number}" for number in range(1, 13)),
    *(f"LED-B{number}" for number in range(1, 6)),
    *("LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"),
    *(f"HP{number}" for number in range(1, 6)),
)
DIGITS = 5
# sqrt(1/2): reflectances count by the root of their brightness. The exponent of the
# term of grey, too, is that of the least leave-one-out error of the training set.
WEIGHT, GREY_EXPONENT = -0.5, 8


def rec709_under_d65(reflectances):
    """Return linear Rec.709 (n, 3) of reflectances (n, 81) under D65, white 1, 1, 1."""
    d65 = illuminant_spectrum("D65")
    srgb_from_xyz = colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB
    white = srgb_from_xyz @ xyz_under(d65)
    return xyz_under(d65, reflectances) @ srgb_from_xyz.T / white


def terms(rgb):
    """Return the terms (n, 7) of RGB (n, 3): see transform_uplift.h."""
    red, green, blue = rgb.T
    r, g, b = np.maximum(rgb, 0.0).T
    mean = (r + g + b) / 3.0
    evenness = r * g * b / np.maximum(mean, 1e-30) ** 3
    grey = mean * evenness**GREY_EXPONENT
    roots = np.sqrt(r * g), np.sqrt(g * b), np.sqrt(r * b)
    return np.column_stack([red, green, blue, *roots, grey])


def uplift_basis(reflectances):
    """Return (7, 81): reflectance = terms(rgb) @ basis, with white exactly 1.

    Least squares over @reflectances (n, 81) under the condition that the columns sum
    to 1, by which green's row is one minus the others."""
    rgb = rec709_under_d65(reflectances)
    of_terms = terms(rgb)
    weight = rgb.sum(axis=1, keepdims=True) ** WEIGHT
    others = np.delete(of_terms, 1, axis=1) - of_terms[:, [1]]
    wanted = reflectances - of_terms[:, [1]]
    rows = np.linalg.lstsq(others * weight, wanted * weight, rcond=None)[0]
    return np.insert(rows, 1, 1.0 - rows.sum(axis=0), axis=0)


def table(name, rows, comment):
    """Return the C++ of rows (n, 81) as a constant."""
    numbers = "\n".join(
        "    {{ " + ", ".join(f"{value:.{DIGITS}g}" for value in row) + " }},"
        for row in rows
    )
    shape = f"std::array<std::array<double, {len(WAVELENGTHS)}>, {len(rows)}>"
    return f"/// {comment}\ninline constexpr {shape} {name} {{{{\n{numbers}\n}}}};\n\n"


def row(name, values, comment):
    """Return the C++ of values (81,) as a constant."""
    numbers = ", ".join(f"{value:.{DIGITS}g}" for value in values)
    shape = f"std::array<double, {len(WAVELENGTHS)}>"
    return f"/// {comment}\ninline constexpr {shape} {name} {{ {numbers} }};\n\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "plugins" / "core")
    out = parser.parse_args().out
    lamps = [illuminant_spectrum(lamp) for lamp in LAMPS]
    lamps = [power / power.max() for power in lamps]
    daylight = SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES
    components = [daylight[name][WAVELENGTHS] for name in ("S0", "S1", "S2")]
    names = ", ".join(f'"{lamp}"' for lamp in LAMPS)
    what = "Power of the CIE's lamps, 380 to 780 nm by 5."
    text = HEAD.format(what=what) + "/// Source: CIE 015, tables 10 to 12.\n"
    text += "inline constexpr std::array lamp_names {\n    " + names + "\n};\n"
    text += table("lamp_powers", lamps, "Of these lamps, peak 1.")
    write(out / "illuminant_lamp_tables.h", text)
    text = HEAD.format(what="Components of daylight, 380 to 780 nm by 5.")
    text += table("daylight_components", components, "S0, S1, S2: CIE 015, table 6.")
    text += row("luminous", observer(), "V of the CIE 1931 observer: CIE 015, table 1.")
    write(out / "illuminant_daylight_tables.h", text)
    what = "Spectra whose sum reflectances are, 380 to 780 nm by 5; see its cpp."
    text = HEAD.format(what=what)
    basis = uplift_basis(training_reflectances())
    comment = "Of the terms of transform_uplift.h; columns sum to 1."
    text += table("uplift_basis", basis, comment)
    write(out / "transform_uplift_basis.h", text)


def observer():
    """Return the luminous efficiency (81,) of the CIE 1931 observer."""
    table = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    return table[WAVELENGTHS][:, 1]


def write(path, text):
    """Write a header as clang-format has it."""
    path.write_text(text + "} // namespace cg2raw\n")
    style = f"--style=file:{ROOT / '.clang-format'}"
    formatter = Path(sys.executable).parent / "clang-format"
    subprocess.run([formatter, "-i", style, path], check=True)


if __name__ == "__main__":
    main()
