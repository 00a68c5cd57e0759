# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Scores: how well a diagnosis found the hidden effects, and the table of a suite."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.diagnose.diagnosis import Diagnosis
from cg2raw.diagnose.effects.registry import listed_parameters
from cg2raw.diagnose.verdict.profile import OF_SENSOR
from cg2raw.sensor import Sensor
from cg2raw.synthetic.strengths import KINDS

# Nats per pixel: less than this is not asked to be seen.
VISIBLE_GAP = 3e-4
Z95 = 1.959964  # standard errors on each side of an interval of 95 %
NOT_SURE = (
    "ambiguous",
    "unexplained",
    "partially_explained",
    "incomplete",
)

Record = Mapping[str, Any]


def score(hidden: Sequence[str], diagnosis: Diagnosis) -> dict[str, Any]:
    """Return what a diagnosis got right, as JSON.

    first : the name with the largest held-out gain. outcome : of one case: "right" if
    first is hidden, else "wrong"; "unsure" if it is not but the verdict says that it is
    not sure; "missed" for no name. Where nothing is hidden that can be named, "right"
    is no name."""
    found = sorted(diagnosis.effects, key=lambda one: -one.gain_nats)
    names = [one.name for one in found]
    gap = diagnosis.gap
    flagged = diagnosis.verdict in NOT_SURE
    if not names:
        outcome = "unsure" if flagged else "missed" if hidden else "right"
    elif names[0] in hidden:
        outcome = "right"
    else:
        outcome = "unsure" if flagged else "wrong"
    before = float(gap.before)
    return {
        "verdict": diagnosis.verdict,
        "named": names,
        "outcome": outcome,
        "exact": sorted(names) == sorted(hidden),
        "extra": len(set(names) - set(hidden)),
        "sure": [
            one.name for one in found if not (one.ambiguous_with or one.provisional)
        ],
        "flagged": flagged,
        "gap_before": before,
        "gap_after": float(gap.after),
        "closed": 1 - float(gap.after) / before if before > 0 else None,
        "chi2_after": float(gap.chi2_after),
        "unexplained": [one.name for one in diagnosis.unexplained],
        "engine_seconds": float(diagnosis.seconds),
        "time_limit_reached": bool(diagnosis.time_limit_reached),
    }


def errors(
    expected: Mapping[str, Mapping[str, float]], diagnosis: Diagnosis
) -> dict[str, float]:
    """Return what the values of right names are off, in standard errors, by
    "effect.parameter". A standard error is the interval's half on the truth's side,
    over the 1.96 of 95 %.

    expected : effect -> true value of each parameter of which it is known."""
    found = {}
    for one in diagnosis.effects:
        for key, truth in expected.get(one.name, {}).items():
            if key not in one.parameters:
                continue
            estimate = one.parameters[key]
            off = estimate.value - truth
            half = abs(estimate.ci95[0 if off > 0 else 1] - estimate.value)
            found[f"{one.name}.{key}"] = float(off / half * Z95) if half else 0.0
    return found


def of_limits(
    missed: Sequence[str],
    expected: Mapping[str, Mapping[str, float]],
    diagnosis: Diagnosis,
    sensor: Sensor,
) -> dict[str, float]:
    """Return how strong missed names are beyond the profile, over the detection limit
    that the report has for them: the largest of their parameters. Names without a
    limit, or whose true values are not known, are left out. expected : as of errors.
    sensor : the profile."""
    found: dict[str, float] = {}
    for limit in diagnosis.detection_limits:
        name, truth = limit.name, expected.get(limit.name, {}).get(limit.parameter)
        if name in missed and limit.strength and truth is not None:
            stated = listed_parameters(sensor, name) or {}
            before = stated.get(limit.parameter, 0.0) if name in OF_SENSOR else 0.0
            ratio = abs(truth - before) / limit.strength
            found[name] = max(found.get(name, 0.0), ratio)
    return found


def table(suite: str, records: Sequence[Record]) -> str:
    """Return the table of a suite: a line per effect, totals, what is asked of them."""
    good = [one for one in records if "error" not in one]
    lines = [HEAD]
    by_name: dict[str, list[Record]] = {}
    for one in good:
        by_name.setdefault("+".join(one["hidden"]) or "nothing", []).append(one)
    if len(by_name) <= 30:
        lines += [line(name, group) for name, group in by_name.items()]
    lines += [line("all", good)] if good else []
    lines += [f"failed: {len(records) - len(good)}"] if len(good) < len(records) else []
    late = sum(one.get("time_limit_reached", False) for one in good)
    lines += [f"ended by the time limit: {late}"] if late else []
    lines += [
        f"{what}: {_number(value)} (asked: {asked})"
        for what, value, asked in bounds(suite, good)
    ]
    lines += [words for one in good for words in _missed(one)]
    return "\n".join(lines)


def _missed(one: Record) -> Iterator[str]:
    """Yield how strong each name that was missed is."""
    nats, ratios = (one.get(key, {}) for key in ("evidence", "of_limits"))
    for name in dict.fromkeys([*nats, *ratios]):
        words = [f"case {one['number']}: missed {name}"]
        words += [f"{nats[name]:.1f} nats in what decides"] if name in nats else []
        words += [f"{ratios[name]:.2f} of its limit"] if name in ratios else []
        yield ", ".join(words)


# Columns after what is hidden, and the format of each.
COLUMNS = {
    "sets": "6",
    "names": "6",
    "right": "6",
    "missed": "7",
    "false": "6",
    "exact": "6",
    "first": "6",
    "unsure": "7",
    "error": "7.2f",
    "closed": "8.4f",
    "seconds": "8.1f",
}
HEAD = f"{'hidden':32}" + "".join(
    f"{name:>{wide.partition('.')[0]}}" for name, wide in COLUMNS.items()
)


def line(name: str, group: Sequence[Record]) -> str:
    """Return a line of a table: names of the vocabulary that are hidden, named right,
    missed, false; sets that are exact, that have the first name right, that are not
    sure; rms error in standard errors; median gap closed, of the visible, and seconds
    of a processor."""
    known = [set(one["hidden"]) & set(KINDS) for one in group]
    found = zip(known, group, strict=True)
    right = sum(len(names & set(one["named"])) for names, one in found)
    hidden = sum(map(len, known))
    off = [value for one in group for value in one.get("errors", {}).values()]
    closed = _closed(group)
    values = (
        len(group),
        hidden,
        right,
        hidden - right,
        sum(one["extra"] for one in group),
        sum(one["exact"] for one in group),
        sum(one["outcome"] == "right" for one in group),
        sum(one["flagged"] for one in group),
        np.sqrt(np.mean(np.square(off))) if off else np.nan,
        np.median(closed) if closed else np.nan,
        np.median([one["seconds"] for one in group]),
    )
    cells = zip(values, COLUMNS.values(), strict=True)
    return f"{name[:31]:32}" + "".join(f"{value:{wide}}" for value, wide in cells)


Bound = tuple[str, float, str]  # what, value, what is asked


def bounds(suite: str, good: Sequence[Record]) -> list[Bound]:
    """Return what a suite measured beside what is asked."""
    if suite.endswith("none"):
        return _of_none(suite, good)
    measured = {
        "pairs": _of_sets,
        "triples": _of_sets,
        "nine": _of_sets,
        "unknown": _of_unnamed,
        "leave-one-out": _of_unnamed,
        "power": _of_power,
        "closed-loop": _of_closed_loop,
        "nuisance": _of_nuisance,
        "dense-1": _of_dense,
        "dense-3": _of_dense,
        "dense-5": _of_dense,
        "real": _of_real,
        "few": _of_few,
    }
    return measured.get(suite, _of_single)(suite, good)


def _is(good: Sequence[Record], outcome: str) -> float:
    return _share([one["outcome"] == outcome for one in good])


def _of_none(suite: str, good: Sequence[Record]) -> list[Bound]:
    named = [bool(one["named"]) for one in good]
    return [
        ("false names", _share(named), "<= 1 %" if "-" in suite else "<= 0.5 %"),
        ("flagged unknown", _share([one["flagged"] for one in good]), "none"),
    ]


def _of_few(suite: str, good: Sequence[Record]) -> list[Bound]:
    """What few captures do not show is missed; a false name must not be sure."""
    sure = [bool(set(one["sure"]) - set(one["hidden"])) for one in good]
    return [("false names that are sure", _share(sure), "<= 1 %")]


def _of_sets(suite: str, good: Sequence[Record]) -> list[Bound]:
    seen = "92 %" if suite == "pairs" else "85 %"
    return [
        ("exact set", _share([one["exact"] for one in good]), f">= {seen}"),
        ("right first name", _is(good, "right"), "none"),
        *_of_names(good),
        *_closed_bounds(_closed(good)),
    ]


def _of_names(good: Sequence[Record]) -> list[Bound]:
    """A missed name is below its limit if its strength is; one of unknown limit is
    not."""
    hidden = sum(len(one["hidden"]) for one in good)
    missed = [
        one.get("of_limits", {}).get(name, math.inf)
        for one in good
        for name in one["hidden"]
        if name not in one["named"]
    ]
    found, above = hidden - len(missed), sum(ratio >= 1 for ratio in missed)
    return [
        (f"right of {hidden} names", found / hidden if hidden else np.nan, "97 %"),
        (
            f"right of {found + above} names above their detection limits",
            found / (found + above) if found + above else np.nan,
            "99 %",
        ),
    ]


ASKED_OF_DENSE = {"dense-1": 98, "dense-3": 92, "dense-5": 85}  # % of exact sets


def _of_dense(suite: str, good: Sequence[Record]) -> list[Bound]:
    """A hidden effect is visible if it is worth the nats that a name needs."""
    exact = [one["extra"] == 0 and not _visibly_missed(one) for one in good]
    named = sum(len(one["named"]) for one in good)
    wrong = sum(one["extra"] for one in good)
    holds = [abs(off) <= Z95 for one in good for off in one["errors"].values()]
    return [
        ("exact set of the visible", _share(exact), f">= {ASKED_OF_DENSE[suite]} %"),
        ("exact set", _share([one["exact"] for one in good]), "none"),
        (f"wrong of {named} names", wrong / named if named else np.nan, "<= 0.5 %"),
        (
            f"truth in its 95 % interval, of {len(holds)}",
            _share(holds),
            "93 to 97 %",
        ),
        *_closed_bounds([one["closed"] for one in good if one["closed"] is not None]),
    ]


def _visibly_missed(one: Record) -> list[str]:
    """Return the hidden effects that were worth a name, and have none."""
    needed = one["nats_needed"]
    return [name for name, nats in one.get("evidence", {}).items() if nats > needed]


def _of_real(suite: str, good: Sequence[Record]) -> list[Bound]:
    return [
        ("named first", _is(good, "right"), ">= 95 % of those above their limits"),
        ("cases with other names", _share([one["extra"] > 0 for one in good]), "none"),
    ]


def _of_unnamed(suite: str, good: Sequence[Record]) -> list[Bound]:
    visible, is_unknown = _visible(good), suite == "unknown"
    flagged = _share([one["flagged"] for one in visible])
    asked = ">= 95 %" if is_unknown else ">= 90 %"
    return [
        (f"flagged, of {len(visible)} visible", flagged, asked),
        ("confidently misnamed", _is(visible, "wrong"), "0 %" if is_unknown else ""),
    ]


def _of_power(suite: str, good: Sequence[Record]) -> list[Bound]:
    return [("named first", _is(good, "right"), "see the 50 % points")]


def _of_closed_loop(suite: str, good: Sequence[Record]) -> list[Bound]:
    again = [one["again_verdict"] == "consistent" for one in good]
    return [("no gap against the found profile", _share(again), ">= 95 %")]


def _of_nuisance(suite: str, good: Sequence[Record]) -> list[Bound]:
    return [
        ("named first", _is(good, "right"), ">= 93 %"),
        ("wrong", _is(good, "wrong"), "<= 1 %"),
    ]


def _of_single(suite: str, good: Sequence[Record]) -> list[Bound]:
    visible = _visible(good)
    return [
        ("named first", _is(good, "right"), ">= 96 %"),
        (
            f"named first, of {len(visible)} above {VISIBLE_GAP:g} nats/px",
            _is(visible, "right"),
            ">= 99.5 %",
        ),
        (
            "cases with extra names",
            _share([one["extra"] > 0 for one in good]),
            "<= 2 %",
        ),
        *_closed_bounds(_closed(good)),
    ]


def half_points(records: Sequence[Record]) -> dict[str, float]:
    """Return the strength of every effect at which half of its cases are named.

    By the maximum-likelihood step along the sorted strengths; NaN where all or none
    were named."""
    points = {}
    for name in dict.fromkeys(one["hidden"][0] for one in records if one["hidden"]):
        mine = [
            one for one in records if one["hidden"] == [name] and "error" not in one
        ]
        mine = sorted(
            (one for one in mine if one["strength"]), key=lambda r: r["strength"]
        )
        named = np.array([one["outcome"] == "right" for one in mine], int)
        if not len(named) or named.all() or not named.any():
            points[name] = float("nan")
            continue
        errors = [
            named[:k].sum() + (1 - named[k:]).sum() for k in range(len(named) + 1)
        ]
        k = int(np.clip(np.argmin(errors), 1, len(named) - 1))
        strengths = mine[k - 1]["strength"], mine[k]["strength"]
        points[name] = float(np.sqrt(strengths[0] * strengths[1]))
    return points


def _closed_bounds(closed: Sequence[float]) -> list[tuple[str, float, str]]:
    if not closed:
        return []
    median, low = np.quantile(closed, (0.5, 0.05))
    return [
        ("gap closed, median", float(median), ">= 99 %"),
        ("gap closed, 5th percentile", float(low), ">= 95 %"),
    ]


def _visible(group: Sequence[Record]) -> list[Record]:
    return [one for one in group if one["gap_before"] > VISIBLE_GAP]


def _closed(group: Sequence[Record]) -> list[float]:
    return [one["closed"] for one in _visible(group)]


def _share(flags: Sequence[bool]) -> float:
    return float(np.mean(flags)) if len(flags) else float("nan")


def _number(value: float) -> str:
    return f"{100 * value:.2f} %"
