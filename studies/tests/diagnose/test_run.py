# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The bench of the diagnosis: how it counts, and a sample of what it shows."""

import json
from collections import Counter
from types import SimpleNamespace

import pytest

import cg2raw.diagnose
from cg2raw import Sensor
from cg2raw.synthetic.strengths import KINDS, UNKNOWN_KINDS
from studies.diagnose import frozen, gates
from studies.diagnose import run as command
from studies.diagnose.dense import dense_names
from studies.diagnose.real_frames import VARIABLE
from studies.diagnose.run import bench
from studies.diagnose.scores import (
    Z95,
    bounds,
    errors,
    half_points,
    line,
    of_limits,
    score,
    table,
)
from studies.diagnose.suites import FEW, SUITES, Case, cases


def verdict_of(names, verdict="explained", before=0.1, after=0.001):
    """Return what the scores read of a Diagnosis; the first name gains most."""
    effects = [
        SimpleNamespace(
            name=name,
            gain_nats=100.0 - n,
            parameters={},
            ambiguous_with=["exposure"] if verdict == "ambiguous" else [],
            provisional=False,
        )
        for n, name in enumerate(names)
    ]
    gap = SimpleNamespace(before=before, after=after, chi2_after=1.0)
    return SimpleNamespace(
        verdict=verdict,
        effects=effects[::-1],
        gap=gap,
        unexplained=[],
        detection_limits=[],
        seconds=1.0,
        time_limit_reached=False,
    )


@pytest.mark.parametrize(
    ("hidden", "names", "verdict", "outcome", "exact", "extra"),
    [
        (["prnu"], ["prnu"], "explained", "right", True, 0),
        (["prnu"], ["prnu", "blur"], "explained", "right", False, 1),
        (["prnu"], ["blur", "prnu"], "explained", "wrong", False, 1),
        (["prnu"], ["blur"], "ambiguous", "unsure", False, 1),
        (["prnu"], ["blur"], "partially_explained", "unsure", False, 1),
        (["prnu"], [], "consistent", "missed", False, 0),
        (["prnu"], [], "unexplained", "unsure", False, 0),
        ([], [], "consistent", "right", True, 0),
        ([], ["blur"], "explained", "wrong", False, 1),
        (["blur", "prnu"], ["prnu", "blur"], "explained", "right", True, 0),
    ],
)
def test_outcomes(hidden, names, verdict, outcome, exact, extra):
    one = score(hidden, verdict_of(names, verdict))
    assert (one["outcome"], one["exact"], one["extra"]) == (outcome, exact, extra)
    assert one["closed"] == pytest.approx(0.99)


@pytest.mark.parametrize("suite", [s for s in SUITES if not s.startswith("real")])
def test_cases_depend_on_seed_and_number_alone(suite):
    some, more = cases(suite, 3, 2), cases(suite, 3, 4)
    assert all(case in more for case in some)
    assert [case.seed for case in some] != [case.seed for case in cases(suite, 4, 2)]
    names = {name for case in some for name in case.strengths}
    known = dense_names() if suite.startswith("dense") else KINDS
    assert names <= set(UNKNOWN_KINDS if suite == "unknown" else known)
    assert len({case.seed for case in some}) == len(some)


def test_single_goes_through_all_effects():
    hidden = [name for case in cases("single", 0, 2) for name in case.strengths]
    assert sorted(hidden) == sorted([*KINDS, *KINDS])
    with pytest.raises(ValueError, match="effect 'fog' of suite single must be one of"):
        cases("single", 0, 1, ["fog"])


def test_a_bench_goes_on_where_it_stopped(tmp_path, monkeypatch):
    seen = []

    def diagnose(captures, **_):
        seen.append(captures.sensor.id)
        if len(seen) == 2:
            raise ValueError("a bad case")
        return verdict_of(["exposure"])

    monkeypatch.setattr(cg2raw.diagnose, "diagnose", diagnose, raising=False)
    monkeypatch.setattr(Case, "evidence", lambda *_: {})
    path = tmp_path / "records.jsonl"
    wanted = {"count": 1, "effects": ["exposure", "prnu", "blur"], "path": path}
    wanted["seed"] = 0
    records = bench("single", **wanted)
    assert len(seen) == 3
    assert records[1]["error"] == "ValueError: a bad case"
    path.write_text("".join(path.read_text().splitlines(True)[:2]) + '{"cut')
    again = bench("single", **wanted)
    assert [one["number"] for one in again if "error" not in one] == [0, 1, 2]
    assert len(seen) == 5  # the one that failed, and the one that was cut
    records[0]["strengths"] = {"exposure": 0.5}
    path.write_text("".join(json.dumps(one) + "\n" for one in records))
    bench("single", **wanted)
    assert len(seen) == 7  # the one that failed, and the one of another strength
    text = table("single", records)
    assert "failed: 1" in text and "named first: 50.00 % (asked: >= 96 %)" in text


def test_command_prints_the_table(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(
        cg2raw.diagnose,
        "diagnose",
        lambda *_, **__: verdict_of([], "consistent", 0.0, 0.0),
        raising=False,
    )
    path = tmp_path / "none.jsonl"
    argv = ["none", "--count", "2", "--jobs", "1", "--json", str(path)]
    assert command.main(argv) == 0
    assert "false names: 0.00 % (asked: <= 0.5 %)" in capsys.readouterr().out
    assert [json.loads(line)["number"] for line in path.open()] == [0, 1]
    assert command.main(argv) == 1
    assert f"{path}: has 2 sets of none: go on with" in capsys.readouterr().err
    assert command.main([*argv, "--resume"]) == 0
    assert len(path.read_text().splitlines()) == 2


def test_gates_are_a_row_of_each_suite(tmp_path, monkeypatch, capsys):
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(Case, "evidence", lambda *_: {})
    suites = {*frozen.SIZES, *gates.OF_REAL_FRAMES}
    monkeypatch.setattr(command, "COUNTS", dict.fromkeys(sorted(suites), 1))
    monkeypatch.setattr(
        cg2raw.diagnose, "diagnose", lambda *_, **__: verdict_of(["blur"])
    )
    argv = ["gates", "--count", "4", "--jobs", "1", "--quiet"]
    assert command.main([*argv, "--json", str(tmp_path / "records.jsonl")]) == 0
    out, err = capsys.readouterr()
    assert err == "diagnose: real, cameras: skipped, no folder of real frames\n"
    head, *rows = out.splitlines()
    rows = {row[:32].strip(): row[32:].split() for row in rows}
    assert set(rows) == {
        *("low-none", "nine", "none", "nuisance-none", "pairs", "triples", "unknown"),
        *("single, by darks and flats", "single, by scenes"),
    }
    columns = head.split()[1:]
    unknown = dict(zip(columns, rows["unknown"], strict=True))
    assert (unknown["names"], unknown["missed"], unknown["false"]) == ("0", "0", "4")
    by_scenes = dict(zip(columns, rows["single, by scenes"], strict=True))
    assert by_scenes["right"] == by_scenes["exact"] == "1"  # of color_matrix and blur


def test_limits_reach_the_diagnosis_and_are_counted(monkeypatch):
    given = []

    def diagnose(captures, **options):
        given.append(options)
        found = verdict_of(["prnu"])
        found.time_limit_reached = True
        return found

    monkeypatch.setattr(cg2raw.diagnose, "diagnose", diagnose, raising=False)
    limits = {"time_limit": 5.0, "pixels": None}
    records = bench("single", count=1, seed=0, effects=["prnu"], limits=limits)
    assert given[0]["time_limit"] == 5.0 and "pixels" not in given[0]
    assert "ended by the time limit: 1" in table("single", records)


def test_half_points_lie_between_what_is_seen_and_what_is_not():
    records = [
        {"hidden": ["prnu"], "strength": s, "outcome": "right" if s > 3 else "missed"}
        for s in (1.0, 2.0, 3.0, 4.0, 5.0)
    ]
    assert half_points(records) == {"prnu": pytest.approx(12**0.5)}


@pytest.mark.parametrize(
    ("truth", "off"), [(1.0, 2 * Z95), (3.0, -Z95 / 2), (2.0, 0.0), (0.5, 3 * Z95)]
)
def test_errors_are_in_standard_errors_of_the_side_of_the_truth(truth, off):
    """2, in an interval of 1.5 to 4: half of it is 0.5 below, 2 above."""
    value = SimpleNamespace(value=2.0, ci95=(1.5, 4.0))
    exact = SimpleNamespace(value=2.0, ci95=(2.0, 2.0))
    parameters = {"sigma": value, "other": value, "exact": exact}
    found = errors(
        {"prnu": {"sigma": truth, "exact": 1.0, "absent": 1.0}, "blur": {"sigma": 9.0}},
        SimpleNamespace(effects=[SimpleNamespace(name="prnu", parameters=parameters)]),
    )
    assert found == {"prnu.sigma": pytest.approx(off), "prnu.exact": 0.0}


def test_missed_names_are_compared_with_their_detection_limits():
    """Of steps of -3 and 2 DN with limits of 2 and 4 the larger counts; without a
    limit, or of unknown truth, there is none."""
    limits = [
        SimpleNamespace(name=name, parameter=parameter, strength=strength)
        for name, parameter, strength in (
            ("prnu", "sigma", 2.0),
            ("amplifier_mismatch", "horizontal_offset", 2.0),
            ("amplifier_mismatch", "vertical_offset", 4.0),
            ("dust", "density", None),
            ("dsnu", "sigma", 1.0),
        )
    ]
    expected = {
        "prnu": {"sigma": 1.0},
        "amplifier_mismatch": {"horizontal_offset": -3.0, "vertical_offset": 2.0},
        "dust": {"density": 1.0},
        "row_noise": {"sigma": 1.0},
    }
    diagnosis = SimpleNamespace(detection_limits=limits)
    missed = [*expected, "hot_pixels"]
    assert of_limits(missed, expected, diagnosis, Sensor("canon-70d")) == {
        "prnu": 0.5,
        "amplifier_mismatch": 1.5,
    }


def record(hidden, names, verdict="explained", before=0.1, after=0.001, **more):
    return {
        **score(hidden, verdict_of(names, verdict, before, after)),
        "hidden": hidden,
        "seconds": 2.0,
        **more,
    }


def test_a_line_counts_names_and_sets():
    group = [
        record(["prnu", "blur"], ["prnu", "dsnu"], errors={"prnu.sigma": 3.0}),
        record(["prnu"], ["prnu"], errors={"prnu.sigma": -4.0}, seconds=5.0),
        record(["prnu"], [], "unexplained", after=0.02, seconds=9.0),
        record(["prnu"], [], "consistent", before=1e-4, after=1e-4),  # not visible
    ]
    rms, closed = 12.5**0.5, 0.99
    cells = [4, 5, 2, 3, 1, 1, 2, 1, f"{rms:.2f}", f"{closed:.4f}", "3.5"]
    assert line("prnu", group).split() == ["prnu", *map(str, cells)]


def dense(names, offs, **more):
    """Return a record of two hidden effects, of which blur was worth 6 of 5 nats."""
    evidence = {"blur": 6.0, "prnu": 4.0}
    missed = {name: evidence[name] for name in evidence if name not in names}
    errors = {f"{number}": off for number, off in enumerate(offs)}
    return record(
        ["prnu", "blur"], names, errors=errors, evidence=missed, nats_needed=5.0, **more
    )


@pytest.mark.parametrize(
    ("suite", "records", "expected"),
    [
        (
            "dense-3",
            [
                dense(["blur"], [0.5, 1.9], after=0.0),  # what it missed is not visible
                dense(["prnu"], [2.0], after=0.02),
                dense(["blur", "prnu"], [-1.0], after=0.04),
                dense(["blur", "prnu", "dsnu"], [-2.5], after=0.1),
                dense(["prnu"], [], after=0.02),
            ],
            [2 / 5, 1 / 5, 1 / 8, 3 / 5, 0.8, 0.12],
        ),
        (
            "nine",  # of the names missed, one is below its limit, one has none
            [
                record(["prnu", "blur"], ["prnu"], of_limits={"blur": 0.9}),
                record(["prnu", "blur"], ["blur"], of_limits={"prnu": 1.1}),
                record(["prnu", "blur"], ["blur"]),
                record(["prnu", "blur"], ["prnu", "blur"]),
            ],
            [1 / 4, 1.0, 5 / 8, 5 / 7, 0.99, 0.99],
        ),
        (
            "single",
            [
                record(["prnu"], ["prnu"]),
                record(["prnu"], ["blur"], after=0.03),
                record(["prnu"], [], "consistent", 1e-4, 1e-4),
            ],
            [1 / 3, 1 / 2, 1 / 3, 0.845, 0.7145],
        ),
        (
            "unknown",
            [
                record(["prnu"], [], "unexplained"),
                record(["prnu"], ["blur"]),
                record(["prnu"], [], "consistent", 1e-4, 1e-4),
            ],
            [1 / 2, 1 / 2],
        ),
        ("none", [record([], ["blur"]), record([], [], "unexplained")], [1 / 2, 1 / 2]),
        ("nuisance", [record([], ["blur"]), record([], [])], [1 / 2, 1 / 2]),
        ("real", [record(["prnu"], ["prnu", "blur"])], [1.0, 1.0]),
        (
            "few",  # what is missed, and what is false and not sure, does not count
            [
                record(["prnu"], ["prnu", "blur"]),
                record(["prnu"], ["blur"], "ambiguous"),
                record(["prnu"], [], "consistent"),
                record(["prnu"], ["prnu"]),
            ],
            [1 / 4],
        ),
    ],
)
def test_what_a_suite_measures(suite, records, expected):
    """Shares of cases, then the median and the 5th percentile of the gaps closed."""
    found = [value for _, value, _ in bounds(suite, records)]
    assert found == pytest.approx(expected)


@pytest.mark.parametrize("number", range(len(FEW)))
def test_few_captures_are_those_of_a_plan(number):
    """By the seed; in each split as many."""
    case = Case("few", 0, len(FEW) + number, {})
    kinds = Counter((c.kind, c.group) for c in case.captures()[0].captures)
    expected = {
        (kind, group): levels * frames
        for kind, (levels, frames) in FEW[number].items()
        for group in ("fit", "select", "report")
    }
    assert kinds == expected


SAMPLE = {"single": 1, "none": 12, "pairs": 4, "unknown": 1, "nuisance-none": 4}


@pytest.mark.slow
@pytest.mark.parametrize("suite", SAMPLE)
def test_a_sample_of_the_bench(suite):
    records = bench(suite, count=SAMPLE[suite], seed=606, jobs=2)
    print(table(suite, records))
    assert [one["error"] for one in records if "error" in one] == []
    values = {what.split(",")[0]: value for what, value, _ in bounds(suite, records)}
    if suite.endswith("none"):
        assert values["false names"] == 0
    elif suite == "single":
        assert values["named first"] >= 0.85
        assert values["gap closed"] >= 0.9  # the 5th percentile
    elif suite == "pairs":
        assert values["exact set"] >= 0.5
    else:
        assert values["confidently misnamed"] == 0


def test_evidence_is_what_the_frames_tell_of_an_effect():
    """A tenth of the light is seen by anybody, row noise of a hundredth by nobody."""
    case = Case("pairs", 0, 3, {"exposure": 0.1, "row_noise": 0.01})
    found = case.evidence(["exposure", "row_noise"])
    assert found["exposure"] > 1e4
    assert abs(found["row_noise"]) < 5


def test_the_table_says_what_was_missed_and_how_faint_it_was():
    record = {
        **score(["row_noise"], verdict_of([], "consistent")),
        "hidden": ["row_noise"],
        "number": 7,
        "seconds": 1.0,
        "evidence": {"row_noise": 3.21},
        "of_limits": {"row_noise": 0.612},
    }
    assert table("single", [record]).endswith(
        "case 7: missed row_noise, 3.2 nats in what decides, 0.61 of its limit"
    )
