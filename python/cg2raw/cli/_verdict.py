# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Diagnoses and checks of captures as text for a terminal."""

import os
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from cg2raw.diagnose.captures.quality import HOLES
from cg2raw.io.raw_checks import together
from cg2raw.short_messages import plural

if TYPE_CHECKING:  # only a diagnosis loads its modules
    from cg2raw.diagnose.captures.check import Check
    from cg2raw.diagnose.captures.phase_correlation import Shift
    from cg2raw.diagnose.captures.quality import Integrity
    from cg2raw.diagnose.diagnosis import Diagnosis, Gap
    from cg2raw.sensor import Sensor


WIDTH = 10  # columns of a line's first word
MOST_LEFT = 6  # tests that are listed, those that explain most first
SAID = (("note", "notes"), ("wrong", "wrong"))
CHECK_HEAD = (
    *("frame", "kind", "ISO", "time", "temperature", "low", "mean", "high", "at 0"),
    *("clipped", "codes", "registration"),
)


def line(word: str, text: str) -> str:
    """Return one line: what it is, and the text."""
    return f"{word:<{WIDTH}}{text}"


def verdict_text(
    found: "Diagnosis", notes: Sequence[str], folder: str, names: Sequence[str]
) -> str:
    """Return the lines that say what a Diagnosis found and where its report is."""
    effects = ", ".join(effect.name for effect in found.effects)
    lines = [line("verdict", found.verdict + (f": {effects}" if effects else ""))]
    if found.interrupted:
        lines.append(line("", "interrupted: what stands here is partial"))
    if found.time_limit_reached:
        lines.append(
            line("", "the time limit ended the diagnosis: more may be missing")
        )
    for effect in found.effects:
        lines.append(line("", effect.sentence or effect.where))
        if effect.ambiguous_with:
            lines.append(line("", f"or it is {', '.join(effect.ambiguous_with)}"))
    gap = found.gap
    lines.append(
        line(
            "gap",
            f"{gap.before:.4g} -> {gap.after:.4g} nats/pixel, chi-square "
            f"{gap.chi2_before:.3f} -> {gap.chi2_after:.3f}, on {test_frames(gap)}",
        )
    )
    shown, more = found.unexplained[:MOST_LEFT], len(found.unexplained[MOST_LEFT:])
    lines += [line("left", f"{test.name}: {test.where}") for test in shown]
    lines += [line("left", f"... and {more} more, in the report")] if more else []
    lines += [line("next", text) for text in found.next_captures]
    lines += [line("note", text) for text in dict.fromkeys([*notes, *found.notes])]
    page = "report.html" if "report.html" in names else names[0]
    lines.append(line("wrote", os.path.join(folder, page)))
    return "\n".join(lines)


def test_frames(gap: "Gap") -> str:
    """Return how many frames a gap was measured on."""
    return plural(len(gap.held_out), "test frame")


def reasons(found: "Diagnosis") -> list[str]:
    """Return the lines that say by how much each name was better than the next."""
    lines = []
    for effect in found.effects:
        text = f"{effect.name}: {effect.gain_nats:.1f} nats"
        for other in effect.alternatives[:1]:
            text += f"; {other.name} in its place: {other.gain_nats:.1f}"
        lines.append(line("why", text))
    return lines


def comparison_json(
    names: Sequence[str], found: Sequence["Diagnosis"], notes: Sequence[str]
) -> dict[str, Any]:
    """Return the gaps of sensors on the test frames in JSON's types."""
    return {
        "sensors": [
            {
                "sensor": name,
                "gap": one.gap.before,
                "chi_square": one.gap.chi2_before,
                "verdict": one.verdict,
            }
            for name, one in zip(names, found, strict=True)
        ],
        "gap_unit": "nats/pixel",
        "test_frames": list(found[0].gap.held_out),
        "notes": list(notes),
    }


def comparison_text(
    names: Sequence[str], found: Sequence["Diagnosis"], notes: Sequence[str]
) -> str:
    """Return a table of the gaps of sensors on the test frames, nothing fitted."""
    rows = [("sensor", "gap", "chi-square", "verdict")]
    for one in comparison_json(names, found, notes)["sensors"]:
        rows.append(
            (
                one["sensor"],
                f"{one['gap']:.4g}",
                f"{one['chi_square']:.3f}",
                one["verdict"],
            )
        )
    unit = "gap in nats/pixel, on "
    lines = [*columns(rows), unit + test_frames(found[-1].gap)]
    return "\n".join([*lines, *(line("note", text) for text in notes)])


def integrity_json(
    sensor: "Sensor", found: "Check", notes: Sequence[str]
) -> dict[str, Any]:
    """Return a check in JSON's types."""
    remarks = {one.name: one.remarks for one in found.integrities}
    complaints = {one.name: one.complaints for one in found.integrities}
    return {
        "sensor": sensor.id,
        "frames": [
            {
                **asdict(one),
                "iso": capture.iso,
                "exposure_time": capture.exposure_time,
                "temperature": capture.temperature,
            }
            for capture, one in zip(found.captures, found.integrities, strict=True)
        ],
        "notes": [*notes, *together(remarks.items()), *found.remarks],
        "wrong": [*together(complaints.items()), *found.complaints],
    }


def integrity_text(sensor: "Sensor", found: "Check", notes: Sequence[str]) -> str:
    """Return the table of a check, and what is wrong."""
    black = ", ".join(dict.fromkeys(f"{level:g}" for level in sensor.black_level))
    lines = [f"{sensor.id}: black {black} DN, white {sensor.white_level} DN"]
    rows = [CHECK_HEAD]
    for capture, item in zip(found.captures, found.integrities, strict=True):
        time, degrees = capture.exposure_time, capture.temperature
        rows.append(
            (
                item.name,
                item.kind,
                "-" if capture.iso is None else f"{capture.iso:g}",
                "-" if time is None else f"{time:g} s",
                "-" if degrees is None else f"{degrees:g} C",
                str(item.low),
                f"{item.mean:.1f}",
                str(item.high),
                f"{item.below:.2%}",
                f"{item.clipped:.2%}",
                code_words(item),
                shift_words(item.shift),
            )
        )
    lines += columns(rows)
    said = integrity_json(sensor, found, notes)
    lines += [line(word, t) for word, key in SAID for t in said[key]]
    if found.is_right:
        lines.append("nothing is wrong")
    return "\n".join(lines)


def code_words(item: "Integrity") -> str:
    """Return which codes occur."""
    every = "all" if item.step == 1 else f"one in {item.step}"
    return every if item.missing < HOLES else f"{every}, {item.missing:.0%} missing"


def shift_words(shift: "Shift | None") -> str:
    """Return how a render lies on its capture."""
    if shift is None:
        return "-"
    place = f"{shift.down:+.2f} {shift.right:+.2f} px, " if shift.is_told else ""
    return f"{place}corr. {shift.correlation:.2f}"


def columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return [
        "  ".join(
            cell.ljust(width) for cell, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    ]
