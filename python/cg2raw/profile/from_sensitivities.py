# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Colour from measured spectral sensitivities, in place of that of a camera's files."""

import os
from collections.abc import Sequence
from typing import Any

from cg2raw.profile.from_files import Made

SENSOR = ("cfa", "width", "height", "bits", "black_level", "white_level")
COLOUR = (
    "calibration_illuminant",
    "color_matrix",
    "forward_matrix",
    "illuminants",
    "lamps",
    "spectral_sensitivities",
)


def made_of_sensitivities(
    path: str, lights: Sequence[str] = (), unit: str = "energy", **known: Any
) -> Made:
    """Return the Made profile of a file of spectral sensitivities alone.

    lights : under which neutrals are computed, and a matrix for each; none: neutrals
        of those that cameras meet. unit : of the file's numbers, "energy" or "photon".
    known : id, make, model and SENSOR; None or empty where not given.
    Raises ValueError that lists what is missing."""
    from cg2raw.profile.spectral import profile_from_ssf

    given = {name: value or None for name, value in known.items()}
    # A black level of 0 is a level, not a gap.
    given["black_level"] = known.get("black_level")
    fields = profile_from_ssf(
        path, lights=list(lights) or None, lamps=lights, unit=unit, **given
    )
    return Made(fields, "file of spectral sensitivities", 1)


def with_sensitivities(
    made: Made, path: str, lights: Sequence[str] = (), unit: str = "energy"
) -> Made:
    """Return @made with matrices and neutrals of a file of spectral sensitivities."""
    names = ("id", "make", "model", *SENSOR)
    known = {name: made.fields[name] for name in names}
    measured = made_of_sensitivities(path, lights, unit, **known).fields
    fields = {k: v for k, v in made.fields.items() if not k.startswith(COLOUR)}
    colour = {k: v for k, v in measured.items() if k.startswith(COLOUR)}
    sources = {
        **{k: v for k, v in fields["sources"].items() if not k.startswith(COLOUR)},
        **{k: v for k, v in measured["sources"].items() if k.startswith(COLOUR)},
    }
    made.fields = {**fields, **colour, "sources": sources}
    made.notes = [note for note in made.notes if not on_colour(note)]
    made.notes.append(f"matrices and neutrals are those of {os.path.basename(path)}")
    return made


def on_colour(note: str) -> bool:
    """Return whether a note on a camera's file is about its matrices or neutrals."""
    words = ("matri", "neutral", "white balance", "calibrationilluminant")
    return any(word in note.lower() for word in words)
