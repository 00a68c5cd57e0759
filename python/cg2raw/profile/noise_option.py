# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise given by hand: ISO:S,O as the DNG tag NoiseProfile has it."""

import math
from collections.abc import Sequence
from typing import Any

from cg2raw.cfa import is_mono, sites_of

FORM = "ISO:S,O or ISO:S,O,S,O,S,O (of R, G, B), as in 100:2.1e-4,3e-7"
PAIR = 2  # numbers for all sites, which is what a monochrome sensor has
HIGHEST_ISO = 1e7
SOURCE = "given by hand (cg2raw profile --iso-noise)"


def noise_row(word: str, cfa: str) -> dict[str, Any]:
    """Return {"iso", "beta1", "beta2"}, one value per CFA site, of one option's value.

    variance(x) = S x + O with x in 0..1 above black: beta1 = S, beta2 = O.
    cfa : as of a profile; of "mono" there is one pair. Raises ValueError."""
    iso_word, _, pairs = word.partition(":")
    iso, values = number(iso_word, word), [number(v, word) for v in pairs.split(",")]
    if len(values) not in (2, 6):
        raise ValueError(
            f"--iso-noise {word}: has {len(values)} numbers after the ISO, not 2 or "
            f"6; it must be {FORM}"
        )
    if is_mono(cfa) and len(values) != PAIR:
        raise ValueError(f"--iso-noise {word}: a monochrome sensor has one pair S,O")
    if not 0 < iso <= HIGHEST_ISO:
        raise ValueError(
            f"--iso-noise {word}: iso {iso:g} must be above 0, up to {HIGHEST_ISO:g}"
        )
    for value in values:
        if not 0 <= value <= 1:
            raise ValueError(f"--iso-noise {word}: {value:g} must be within 0 to 1")
    values = values if len(values) == 6 else values * 3
    planes = ["RGB".index(letter) for letter in sites_of(cfa)]
    return {
        "iso": iso,
        "beta1": [values[2 * plane] for plane in planes],
        "beta2": [values[2 * plane + 1] for plane in planes],
    }


def number(text: str, word: str) -> float:
    """Return the finite number that @text is."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(
            f"--iso-noise {word}: {text!r} is no number; it must be {FORM}"
        )
    return value


def with_noise(fields: dict[str, Any], words: Sequence[str]) -> dict[str, Any]:
    """Return the profile's @fields with the rows of @words in place of those ISOs."""
    if not words:
        return fields
    rows = {float(row["iso"]): row for row in fields.get("noise", [])}
    given = [noise_row(word, fields["cfa"]) for word in words]
    isos = [row["iso"] for row in given]
    for iso in isos:
        if isos.count(iso) > 1:
            raise ValueError(f"--iso-noise: ISO {iso:g} is given twice")
    rows |= {row["iso"]: row for row in given}
    sources = {
        **fields["sources"],
        **{f"noise at ISO {iso:g}": SOURCE for iso in isos},
    }
    if len(rows) == len(given):
        sources.pop("noise", None)
    return {**fields, "sources": sources, "noise": [rows[iso] for iso in sorted(rows)]}
