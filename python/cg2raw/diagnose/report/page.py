# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""report.html: a card for each finding, the gap, the limits, and what is folded."""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

from cg2raw.diagnose.diagnosis import Diagnosis, Finding, ResidualTest
from cg2raw.diagnose.effects.catalogue import heading, title
from cg2raw.diagnose.effects.discriminating_captures import discriminating_captures
from cg2raw.diagnose.report import text as words
from cg2raw.diagnose.report.charts import charts_of, overview
from cg2raw.diagnose.report.frame_images import frames
from cg2raw.diagnose.report.values import (
    Shown,
    limit_words,
    powers,
    shown,
    stage_of,
)
from cg2raw.io.atomic_file import write_atomically
from cg2raw.io.report_page import Box, Card, Page, Table, html_of
from cg2raw.short_messages import plural

PAGE = "report.html"
TONES = {
    "consistent": "good",
    "explained": "good",
    "unexplained": "bad",
}  # else "doubt"
MOST_SHOWN = 3  # parameters on a card; all are in a table
SPLITS = {
    "fit": "training",
    "select": "validation",
    "report": "test",
}  # in Diagnosis.groups
USES = {
    "fit": "parameters are fitted",
    "select": "effects are accepted or refused",
    "report": "all other numbers of this page",
}


def write_report(diagnosis: Diagnosis, folder: Path) -> None:
    """Write report.html into @folder, which is made if need be.

    The page needs no other file, network or script. Same diagnosis, same bytes. Raises
    ValueError if a library is missing, OSError."""
    html = html_of(page_of(diagnosis))
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / PAGE, html.encode())


def page_of(diagnosis: Diagnosis) -> Page:
    """Return what the page says. Raises ValueError if Pillow is missing."""
    count = len({name for names in diagnosis.groups.values() for name in names})
    eyebrow = f"cg2raw diagnose \N{MIDDLE DOT} {diagnosis.sensor_id}"
    if count:
        eyebrow += f" \N{MIDDLE DOT} {plural(count, 'frame')}"
    return Page(
        title=f"{diagnosis.sensor_id}: {diagnosis.verdict}",
        eyebrow=eyebrow,
        badge=(
            diagnosis.verdict.replace("_", " "),
            TONES.get(diagnosis.verdict, "doubt"),
        ),
        headline=words.headline(diagnosis),
        text=words.summary(diagnosis),
        numbers=list(numbers(diagnosis)),
        warnings=list(warnings(diagnosis)),
        cards=[card(one, diagnosis) for one in diagnosis.effects],
        boxes=list(boxes(diagnosis)),
        folds=list(folds(diagnosis)),
        footer=footer(diagnosis),
    )


def warnings(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield what must be read first."""
    if diagnosis.interrupted:
        yield (
            "Interrupted: the diagnosis was stopped before its end. This page shows "
            "what was found until then; more may be missing."
        )
    if diagnosis.time_limit_reached:
        yield (
            "Time limit: the diagnosis was ended with what it had found until then; "
            "more may be missing. --time-limit gives it longer."
        )


def numbers(diagnosis: Diagnosis) -> Iterator[tuple[str, str, str]]:
    """Yield the gap of test frames, before and after."""
    gap = diagnosis.gap
    yield (
        "gap, nats per pixel",
        words.number(gap.before, 3),
        words.number(gap.after, 2),
    )
    bounds = [
        "" if ends is None else words.interval(ends, 2)
        for ends in (gap.interval_before, gap.interval_after)
    ]
    if any(bounds):
        yield "95 % interval", bounds[0], bounds[1] or words.NOT_KNOWN
    yield (
        "chi-square, ideal 1",
        words.number(gap.chi2_before, 4),
        words.number(gap.chi2_after, 4),
    )


def card(finding: Finding, diagnosis: Diagnosis) -> Card:
    """Return one finding."""
    each = shown(finding, diagnosis)
    value, interval = value_of(finding, each)
    where = finding.where[:1].upper() + finding.where[1:]
    evidence = f"{where}."
    if words.is_known(finding.gain_nats):
        times = powers(finding.gain_nats)
        evidence = f"{where}; with it, the validation frames are {times} as likely."
    return Card(
        heading(finding.name),
        stage_of(finding.name),
        value,
        interval,
        evidence,
        list(more_of(finding, diagnosis)),
        charts_of(finding, diagnosis),
        list(side(finding, diagnosis)),
    )


def value_of(finding: Finding, each: Sequence[Shown]) -> tuple[str, str]:
    """Return how strong an effect is, and the interval of that."""
    size = finding.sentence.partition(": ")[2].rstrip(".") or finding.sentence
    if len(each) == 1:
        return each[0].words, f"95 %: {each[0].interval}"
    if not each:
        return size or "without a value", ""
    if size.startswith(f"{next(iter(finding.parameters))} "):  # no words of its own
        size = ", ".join(one.words for one in each[:2])
    some = "; ".join(f"{one.name} {one.interval}".strip() for one in each[:MOST_SHOWN])
    rest = len(each) - MOST_SHOWN
    return (
        size[:1].upper() + size[1:],
        f"95 %: {some}" + (f"; {rest} more in the table" if rest > 0 else ""),
    )


def more_of(finding: Finding, diagnosis: Diagnosis) -> Iterator[str]:
    """Yield what else would explain it, and what speaks for this name."""
    for name in finding.ambiguous_with:
        yield (
            f"Or it is {title(name)}: these frames cannot tell. "
            f"{discriminating_captures(finding.name, name)}"
        )
    taken = {one.name for one in diagnosis.effects} | {*finding.ambiguous_with}
    others = [
        one
        for one in finding.alternatives
        if one.name not in taken and words.is_known(one.gain_nats)
    ]
    if others:
        best = max(others, key=lambda one: one.gain_nats)
        behind = finding.gain_nats - best.gain_nats
        side = "behind" if behind >= 0 else "ahead"
        yield (
            f"Next best explanation: {title(best.name)}, {words.nats(abs(behind))} "
            f"nats {side}."
        )
    if finding.provisional:
        yield "Provisional: something is left that no effect explains."


def side(
    finding: Finding, diagnosis: Diagnosis
) -> Iterator[tuple[str, str, float | None]]:
    """Yield what the finding gains, beside the others, on a logarithmic bar."""
    most = max((one.gain_nats for one in diagnosis.effects), default=0.0)
    share = None
    if words.is_known(finding.gain_nats) and words.is_known(most) and most > 0:
        gain = max(finding.gain_nats, 0.0)
        share = 100 * math.log1p(gain) / math.log1p(most)
    yield "gain, nats (bar: log)", words.nats(finding.gain_nats), share


def boxes(diagnosis: Diagnosis) -> Iterator[Box]:
    """Yield what is left, what could not be seen, what was compared."""
    yield Box(
        "What no effect explains",
        sentences=[
            f"{heading(one.name)}: {one.where} ({words.number(one.nats_per_pixel, 2)} "
            "nats per pixel)"
            for one in diagnosis.unexplained
        ],
    )
    yield limits(diagnosis)
    rows = [
        (SPLITS.get(split, split), str(len(names)), USES.get(split, ""))
        for split, names in diagnosis.groups.items()
    ]
    tables = [Table(("split", "frames", "for"), rows, 3)] if rows else []
    yield Box("What was compared", sentences=diagnosis.notes, tables=tables)
    yield Box("What to capture next", sentences=diagnosis.next_captures)


def limits(diagnosis: Diagnosis) -> Box:
    """Return how strong an effect that was not found would have had to be."""
    pairs, unseen = [], []
    for name, every in groupby(diagnosis.detection_limits, lambda one: one.name):
        each = [
            limit_words(name, one.parameter, one.strength, one.unit, diagnosis)
            for one in every
            if one.strength is not None
        ]
        if not each:
            unseen.append(title(name))
            continue
        more = f" and {len(each) - 2} more" if len(each) > 2 else ""
        pairs.append((heading(name), ", ".join(each[:2]) + more))
    sentences = []
    if unseen:
        sentences.append(f"These frames cannot show: {', '.join(unseen)}.")
    return Box(
        "Not found, and how strong it would have had to be",
        "more than the profile has of it, to be named in 95 of 100 such sets of frames",
        pairs,
        sentences,
    )


def folds(diagnosis: Diagnosis) -> Iterator[Box]:
    """Yield what is opened by a click."""
    yield Box(
        "Curves", "of the sensor and of the residuals", charts=overview(diagnosis)
    )
    note = "blue: darker than predicted, red: brighter, white: as predicted"
    yield Box("Frames and residual maps", note, images=frames(diagnosis.pictures))
    rows = [
        (heading(one.name), each.name or "size", each.value, each.unit, each.interval)
        for one in diagnosis.effects
        for each in shown(one, diagnosis)
    ]
    head = ("effect", "parameter", "value", "unit", "95 % interval")
    note = plural(len(rows), "value")
    yield Box("All parameters", note, tables=[Table(head, rows, 2)] if rows else [])
    yield tests(diagnosis)
    names = [
        (SPLITS.get(split, split), ", ".join(every))
        for split, every in diagnosis.groups.items()
    ]
    held_out = list(diagnosis.gap.held_out)
    yield Box(
        "Names of frames",
        f"the gap is of {plural(len(held_out), 'test frame')}",
        tables=[Table(("split", "frames"), names, 2)] if names else [],
    )


def tests(diagnosis: Diagnosis) -> Box:
    """Return the residual tests, those that leave most first."""
    each: dict[str, list[ResidualTest | None]] = {}
    for n, some in enumerate((diagnosis.tests_before, diagnosis.tests_after)):
        for one in some:
            each.setdefault(one.name, [None, None])[n] = one
    nats = [
        [one.nats_per_pixel if one else math.nan for one in pair]
        for pair in each.values()
    ]
    order = sorted(
        zip(each.items(), nats, strict=True),
        key=lambda one: [-x if words.is_known(x) else 0.0 for x in one[1][::-1]],
    )
    rows = []
    for (name, (before, after)), _ in order:
        cells = [
            words.number(one.nats_per_pixel, 2) if one else "\N{EN DASH}"
            for one in (before, after)
        ]
        chance = words.number(after.p_value, 2) if after else "\N{EN DASH}"
        where = (after or before).where if (after or before) else ""  # type: ignore[union-attr]
        rows.append((title(name), where, *cells, chance))
    most = max((x[1] for x in nats if words.is_known(x[1])), default=None)
    note = f"after, none leaves more than {words.number(most, 2)} nats per pixel"
    head = ("test", "where", "before, nats/pixel", "after", "p-value after")
    tables = [Table(head, rows, 2)] if rows else []
    return Box(
        f"{plural(len(rows), 'residual test')}, before and after", note, tables=tables
    )


def footer(diagnosis: Diagnosis) -> str:
    """Return what the words mean, and what is done next."""
    text = (
        "Gap: how much less likely test frames are than by their own noise. One nat is "
        "a factor e of probability; intervals hold with 95 %. "
        f"Took {words.duration(diagnosis.seconds)}."
    )
    if diagnosis.profile_json:
        text += (
            " profile.json has what was found; try it on other frames: cg2raw diagnose "
            "compare captures.yaml profile.json"
        )
    return text
