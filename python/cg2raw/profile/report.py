# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What went into a new profile, what it lacks, and what that costs."""

from collections.abc import Mapping, Sequence
from typing import Any

from cg2raw import _core
from cg2raw.cfa import is_mono
from cg2raw.profile.from_files import Made
from cg2raw.profile.summary import cfa_word, neutral_words, summary


def report(made: Made, profile: _core.SensorProfile) -> dict[str, Any]:
    """Return the report on a Made profile in JSON's types."""
    facts = summary(profile)
    return {
        "kind": made.kind,
        "files": made.files,
        "skipped": made.skipped,
        **facts,
        "missing": missing(facts),
        "notes": made.notes,
    }


def missing(facts: Mapping[str, Any]) -> list[str]:
    """Return one line on each thing that the profile lacks: what, and its cost."""
    isos = facts["noise"]["iso"]
    lines = [] if is_mono(facts["cfa"]) else missing_colors(facts)
    if not isos:
        lines.append(
            "noise: frames are clean, an ISO is an error; give --iso-noise, or measure "
            "it from darks and flats by cg2raw calibrate"
        )
    elif isos[0] == isos[1]:
        lines.append(
            f"noise at a second ISO: only ISO {isos[0]:g} can be simulated; give files "
            "of other ISOs, or --iso-noise"
        )
    if not any(effect["name"] == "lens_shading" for effect in facts["effects"]):
        lines.append("lens shading (GainMap): corners are as bright as the centre")
    return lines


def missing_colors(facts: Mapping[str, Any]) -> list[str]:
    """Return one line on each thing that the profile lacks of colours."""
    calibrations, lights = facts["calibrations"], facts["illuminants"]
    one = len(calibrations) == 1
    lines = []
    if one:
        light = calibrations[0]["light_source"]
        lines.append(
            f"second colour matrix: nothing is interpolated, every light gets the "
            f"matrix of {light}"
        )
    if not all(c["xyz_d50_from_camera"] for c in calibrations):
        lines.append(
            "forward matrix: colours are adapted to D50 by Bradford, as converters do"
        )
    if not lights["hull"]:
        draws = (
            "sample:n is an error"
            if one
            else "sample:n is drawn along the Planckian locus between the two matrices"
        )
        lines.append(
            f"3 neutrals that span an area (there are {lights['count']}): {draws}; "
            "give more files, or --neutrals"
        )
    return lines


def as_text(found: Mapping[str, Any]) -> str:
    """Return the report for people."""
    levels = sorted(set(found["black_level"]))
    black = f"{levels[0]:g}" + (f" to {levels[-1]:g}" if len(levels) > 1 else "")
    lines = [
        ("camera", f"{found['camera']}, id {found['id']}"),
        ("files", files_words(found)),
        *(("skipped", reason) for reason in found["skipped"]),
        ("CFA", f"{cfa_word(found['cfa'])}, {found['width']} x {found['height']}"),
        (
            "levels",
            f"{found['bits']} bits, black {black} DN, white {found['white_level']} DN",
        ),
        *color_lines(found),
        ("noise", noise_words(found["noise"]["rows"])),
        ("effects", ", ".join(e["name"] for e in found["effects"]) or "none"),
        *(("note", note) for note in found["notes"]),
        *(("missing", line) for line in found["missing"]),
    ]
    return "\n".join(f"{label:9} {words}" for label, words in lines)


def color_lines(found: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what the report says of colours: nothing of a monochrome sensor."""
    if is_mono(found["cfa"]):
        return []
    return [
        ("matrices", "; ".join(map(matrix_words, found["calibrations"]))),
        ("neutrals", neutral_words(found["illuminants"])),
    ]


def files_words(found: Mapping[str, Any]) -> str:
    """Return how many files of which kind went in."""
    skipped = f", {len(found['skipped'])} skipped" if found["skipped"] else ""
    return f"{found['files']} {found['kind']}{skipped}"


def matrix_words(calibration: Mapping[str, Any]) -> str:
    """Return the light of one calibration, and whether it has a forward matrix."""
    forward = " with forward matrix" if calibration["xyz_d50_from_camera"] else ""
    return f"{calibration['light_source']}{forward}"


def noise_words(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the ISOs, with beta1 and beta2 of the first CFA site."""
    each = [
        f"ISO {row['iso']:g} (beta1 {row['beta1'][0]:.3g}, beta2 {row['beta2'][0]:.3g})"
        for row in rows
    ]
    shown = each if len(each) <= 4 else [*each[:2], "...", each[-1]]
    return (
        f"{len(rows)} ISOs: {', '.join(shown)}"
        if len(rows) > 1
        else (each[0] if each else "none")
    )
