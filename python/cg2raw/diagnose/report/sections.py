# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What the template shows, row by row: numbers as words, nothing but text."""

from collections.abc import Sequence
from typing import Any

from cg2raw.diagnose.diagnosis import (
    Alternative,
    DetectionLimit,
    Diagnosis,
    Finding,
    Gap,
    ResidualTest,
    Rung,
)
from cg2raw.diagnose.effects.discriminating_captures import discriminating_captures
from cg2raw.diagnose.report import text as words
from cg2raw.diagnose.report.plots import SIGNIFICANT, paired

BADGES = {  # verdict -> class of the style sheet, sign that does not need colour
    "consistent": ("good", "\N{CHECK MARK}"),
    "explained": ("found", "\N{CHECK MARK}"),
    "partially_explained": ("doubt", "!"),
    "ambiguous": ("doubt", "?"),
    "unexplained": ("bad", "!"),
    "incomplete": ("doubt", "?"),
}
ACTIONS = {
    "added": "Added",
    "dropped": "Dropped",
    "swapped": "Swapped in",
    "contradicted": "Corrected",
}
LEAST_P = 1e-300

Row = dict[str, Any]


def summary(diagnosis: Diagnosis) -> Row:
    """Return the verdict, its badge and the numbers beside it."""
    tone, sign = BADGES.get(diagnosis.verdict, ("bad", "?"))
    gap = diagnosis.gap
    return {
        "verdict": diagnosis.verdict,
        "tone": tone,
        "sign": sign,
        "sentence": words.verdict_sentence(diagnosis),
        "sensor": diagnosis.sensor_id,
        "interrupted": diagnosis.interrupted,
        "time_limit_reached": diagnosis.time_limit_reached,
        "seconds": words.duration(diagnosis.seconds),
        "closed": words.percent(words.closed(gap)),
        "is_closed": words.closed(gap) is not None and bool(diagnosis.effects),
        "rows": gap_rows(gap),
        "has_intervals": bool(gap.interval_before or gap.interval_after),
        "held_out": list(gap.held_out),
    }


def gap_rows(gap: Gap) -> list[Row]:
    """Return name, before, after, intervals and ideal of each measure of the gap."""
    return [
        {
            "name": "Gap, nats/pixel",
            "before": words.number(gap.before, 2),
            "after": words.number(gap.after, 2),
            "interval_before": bounds(gap.interval_before),
            "interval_after": bounds(gap.interval_after),
            "ideal": "0",
        },
        {
            "name": "Reduced chi-square",
            "before": words.number(gap.chi2_before, 4),
            "after": words.number(gap.chi2_after, 4),
            "interval_before": "",
            "interval_after": "",
            "ideal": "1",
        },
        {
            "name": "Systematic error, noise variances",
            "before": words.number(gap.systematic_before, 2),
            "after": words.number(gap.systematic_after, 2),
            "interval_before": "",
            "interval_after": "",
            "ideal": "0",
        },
    ]


def bounds(interval: tuple[float, float] | None) -> str:
    """Return the words of an interval, or none where there is none."""
    return "" if interval is None else words.interval(interval, 2)


def findings(diagnosis: Diagnosis) -> list[Row]:
    """Return the accepted effects with their parameters."""
    return [finding(effect, diagnosis.effects) for effect in diagnosis.effects]


def finding(effect: Finding, accepted: Sequence[Finding]) -> Row:
    """Return one accepted effect; its runner-up is no other accepted one."""
    e_value, evidence = words.evidence(effect.e_value)
    taken = {other.name for other in accepted}
    rest = [other for other in effect.alternatives if other.name not in taken]
    ranking = ranked([*rest], effect.gain_nats)
    return {
        "name": effect.name,
        "title": words.plain(effect.name),
        "sentence": effect.sentence,
        "where": effect.where,
        "gain": words.nats(effect.gain_nats),
        "e_value": e_value,
        "evidence": evidence,
        "provisional": effect.provisional,
        "ambiguous_with": [
            {
                "title": words.plain(name),
                "discriminating": told_apart(effect, name),
            }
            for name in effect.ambiguous_with
        ],
        "parameters": parameters(effect),
        "alternatives": ranking,
        "runner_up": runner_up(
            effect.name, effect.gain_nats, rest, effect.rule, effect.ambiguous_with
        ),
    }


def losses(findings: Sequence[Finding]) -> list[Row]:
    """Return what is lost without each effect, and its share of the sum of all: those
    whose loss is known, largest first."""
    known = [f for f in findings if words.is_known(f.loss_nats)]
    lost = {f.name: max(f.loss_nats or 0.0, 0.0) for f in known}
    total = sum(lost.values())
    rows = sorted(known, key=lambda f: -lost[f.name])
    return [
        {
            "name": f.name,
            "title": words.plain(f.name),
            "loss": words.nats(f.loss_nats),
            "share": words.rough_percent(lost[f.name] / total if total else None),
            "bar": share_of(lost[f.name], total),
        }
        for f in rows
    ]


def told_apart(effect: Finding, name: str) -> str:
    """Return what would discriminate an effect from @name: its own words, or ours."""
    given = [a.discriminating_captures for a in effect.alternatives if a.name == name]
    return next(filter(None, given), discriminating_captures(effect.name, name))


def parameters(effect: Finding) -> list[Row]:
    """Return the rows of the parameters' table."""
    rows = []
    for name, parameter in effect.parameters.items():
        value, interval = words.estimate(parameter)
        rows.append(
            {
                "name": name,
                "value": value,
                "interval": interval,
                "unit": words.unit(parameter.unit) or "relative",
            }
        )
    return rows


def ranked(alternatives: Sequence[Alternative], gain: float | None = None) -> list[Row]:
    """Return candidates with the length of their bars, percent of the largest gain."""
    gains = [a.gain_nats for a in alternatives] + ([] if gain is None else [gain])
    top = max((g for g in gains if words.is_known(g)), default=0.0)
    return [
        {
            "name": a.name,
            "title": words.plain(a.name),
            "gain": words.nats(a.gain_nats),
            "share": share_of(a.gain_nats, top),
        }
        for a in alternatives
    ]


def share_of(value: float, top: float) -> str:
    """Return a bar's length in percent, 0 to 100."""
    if not words.is_known(value) or top <= 0:
        return "0"
    return f"{100 * min(max(value / top, 0.0), 1.0):.1f}"


def runner_up(
    name: str,
    gain: float,
    alternatives: Sequence[Alternative],
    rule: str,
    ambiguous: Sequence[str] = (),
) -> Row | None:
    """Return the best other name, how far it is from this one, by which rule this one
    was taken, and what discriminates the two."""
    known = [a for a in alternatives if words.is_known(a.gain_nats) and a.name != name]
    if not known:
        return None
    second = max(known, key=lambda other: other.gain_nats)
    behind = gain - second.gain_nats
    return {
        "title": words.plain(second.name),
        "distance": f"{words.nats(abs(behind))} nats "
        f"{'behind' if behind >= 0 else 'ahead'}",
        "is_close": second.name in ambiguous,
        "rule": rule,
        "discriminating": second.discriminating_captures
        or discriminating_captures(name, second.name),
    }


def ladder(diagnosis: Diagnosis) -> list[Row]:
    """Return the steps of the search, each with its ranking and the total so far."""
    rows, total = [], 0.0
    for rung in diagnosis.ladder:
        total += rung.gain_nats if words.is_known(rung.gain_nats) else 0.0
        rows.append(step(rung, total))
    return rows


def step(rung: Rung, total: float) -> Row:
    """Return one step; the bars of its ranking end at its best candidate."""
    return {
        "action": ACTIONS.get(rung.action, rung.action),
        "name": rung.name,
        "title": words.plain(rung.name),
        "gain": words.nats(rung.gain_nats),
        "total": words.nats(total),
        "ranking": ranked(rung.ranking),
        "runner_up": None
        if rung.action == "dropped"
        else runner_up(rung.name, rung.gain_nats, rung.ranking, rung.rule),
    }


def residual_tests(diagnosis: Diagnosis) -> list[Row]:
    """Return all tests, before beside after, largest first."""
    count = max(len(diagnosis.tests_before), len(diagnosis.tests_after), 1)
    return [
        {
            "name": words.plain(name),
            "before": answer(before, count),
            "after": answer(after, count),
            "where": next(test.where for test in (after, before) if test),
        }
        for name, before, after in paired(diagnosis.tests_before, diagnosis.tests_after)
    ]


def answer(test: ResidualTest | None, count: int) -> Row | None:
    """Return one test's numbers; significant among @count tests or not."""
    if test is None:
        return None
    significant = words.is_known(test.p_value) and test.p_value < SIGNIFICANT / count
    return {
        "name": words.plain(test.name),
        "statistic": words.number(test.statistic),
        "p_value": p_words(test.p_value),
        "nats": words.number(test.nats_per_pixel, 2),
        "where": test.where,
        "significant": significant,
    }


def p_words(p_value: float) -> str:
    """Return a p-value; of the smallest ones a double does not keep the digits."""
    is_small = words.is_known(p_value) and p_value < LEAST_P
    return "< " + words.power_of_ten(-300) if is_small else words.number(p_value, 2)


def detection_limits(entries: Sequence[DetectionLimit]) -> list[Row]:
    """Return the effects with the smallest strengths that would have shown."""
    rows: dict[str, Row] = {}
    for entry in entries:
        row = rows.setdefault(
            entry.name,
            {"name": entry.name, "title": words.plain(entry.name), "strengths": []},
        )
        row["strengths"].append(
            {
                "parameter": entry.parameter,
                "strength": None
                if entry.strength is None
                else words.number(entry.strength, 2),
                "unit": words.unit(entry.unit),
            }
        )
    return list(rows.values())


def groups(diagnosis: Diagnosis) -> list[Row]:
    """Return the groups of frames."""
    uses = {
        "fit": "parameters were fitted on these",
        "select": "effects were accepted or refused on these",
        "report": "the gap, the residuals and the pictures are of these",
    }
    return [
        {"name": name, "use": uses.get(name, ""), "frames": list(names)}
        for name, names in diagnosis.groups.items()
    ]
