# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a terminal shows of a check of captures and of a diagnosis."""

import argparse
from types import SimpleNamespace

import pytest

from cg2raw.cli._verdict import (
    comparison_json,
    comparison_text,
    integrity_json,
    integrity_text,
    reasons,
    verdict_text,
)
from cg2raw.cli.diagnose import duration
from cg2raw.diagnose.captures.check import Check
from cg2raw.diagnose.captures.phase_correlation import Shift
from cg2raw.diagnose.captures.quality import Integrity

SENSOR = SimpleNamespace(
    id="acme", black_level=[64.0, 64.5, 64.5, 64.0], white_level=4095
)


def checked(complaints=()):
    captures = [
        SimpleNamespace(iso=None, exposure_time=None, temperature=None),
        SimpleNamespace(iso=800.0, exposure_time=0.25, temperature=21.5),
    ]
    found = [
        Integrity("d.dng", "dark", 60, 90, 64.26, 0.0, 0.0, remarks=("is cold",)),
        Integrity(
            *("s.dng", "scene", 0, 4095, 700.04, 0.0012, 0.5, 4, 0.3),
            shift=Shift(-0.25, 1.0, 0.987),
            complaints=complaints,
        ),
    ]
    return Check(captures, found, (), ("one series",))


def test_a_check_is_a_table_and_what_is_wrong():
    assert integrity_text(SENSOR, checked(("is blurred",)), ["given"]).splitlines() == [
        "acme: black 64, 64.5 DN, white 4095 DN",
        "frame  kind   ISO  time    temperature  low  mean   high  at 0   clipped  "
        "codes                  registration",
        "d.dng  dark   -    -       -            60   64.3   90    0.00%  0.00%    "
        "all                    -",
        "s.dng  scene  800  0.25 s  21.5 C       0    700.0  4095  0.12%  50.00%   "
        "one in 4, 30% missing  -0.25 +1.00 px, corr. 0.99",
        "note      given",
        "note      d.dng: is cold",
        "note      one series",
        "wrong     s.dng: is blurred",
    ]
    assert integrity_text(SENSOR, checked(), []).endswith("\nnothing is wrong")
    found = integrity_json(SENSOR, checked(("is blurred",)), ["given"])
    assert found["sensor"] == "acme" and found["wrong"] == ["s.dng: is blurred"]
    assert found["notes"] == ["given", "d.dng: is cold", "one series"]
    assert found["frames"][1]["shift"] == vars(Shift(-0.25, 1.0, 0.987))
    said = [(f["iso"], f["exposure_time"], f["temperature"]) for f in found["frames"]]
    assert said == [(None, None, None), (800.0, 0.25, 21.5)]


GAP = SimpleNamespace(
    before=0.123456, after=0.01, chi2_before=1.5, chi2_after=1.0004, held_out=["a", "b"]
)
EFFECT = SimpleNamespace(
    name="prnu",
    sentence="PRNU of 1 %",
    where="",
    ambiguous_with=["column_gain"],
    gain_nats=80.04,
    alternatives=[SimpleNamespace(name="dsnu", gain_nats=12.34)],
)


def diagnosed(**fields):
    return SimpleNamespace(
        **{
            **{"verdict": "explained", "effects": [EFFECT], "gap": GAP, "notes": []},
            **{"interrupted": False, "time_limit_reached": False, "unexplained": []},
            **{"next_captures": []},
            **fields,
        }
    )


def test_a_comparison_may_be_of_one_sensor():
    found = comparison_json(["acme"], [diagnosed()], ["odd"])
    [row] = found.pop("sensors")
    assert row == {
        **{"sensor": "acme", "gap": 0.123456, "chi_square": 1.5},
        "verdict": "explained",
    }
    assert found == {
        **{"gap_unit": "nats/pixel", "test_frames": ["a", "b"], "notes": ["odd"]}
    }
    assert comparison_text(["acme"], [diagnosed()], ["odd"]).splitlines() == [
        "sensor  gap     chi-square  verdict",
        "acme    0.1235  1.500       explained",
        "gap in nats/pixel, on 2 test frames",
        "note      odd",
    ]


def test_a_verdict_is_its_effects_its_gap_and_what_is_left():
    left = [SimpleNamespace(name=f"t{n}", where="in red") for n in range(8)]
    found = diagnosed(unexplained=left, next_captures=["darks"], notes=["odd", "warm"])
    text = verdict_text(found, ["odd"], "out", ["verdict.json", "report.html"])
    assert text.splitlines() == [
        "verdict   explained: prnu",
        "          PRNU of 1 %",
        "          or it is column_gain",
        "gap       0.1235 -> 0.01 nats/pixel, chi-square 1.500 -> 1.000, on 2 test "
        "frames",
        *(f"left      t{n}: in red" for n in range(6)),
        "left      ... and 2 more, in the report",
        "next      darks",
        "note      odd",
        "note      warm",
        "wrote     out/report.html",
    ]
    assert reasons(found) == ["why       prnu: 80.0 nats; dsnu in its place: 12.3"]
    for name, words in (
        ("interrupted", "interrupted: what stands here is partial"),
        ("time_limit_reached", "the time limit ended the diagnosis: more may be m"),
    ):
        found = diagnosed(**{name: True}, effects=[])
        lines = verdict_text(found, [], "out", ["verdict.json"]).splitlines()
        assert lines[0] == "verdict   explained" and lines[1].strip().startswith(words)
        assert lines[-1] == "wrote     out/verdict.json"


def test_sensors_are_compared_by_their_gaps():
    other = diagnosed(verdict="unexplained")
    assert comparison_text(
        ["one", "other"], [diagnosed(), other], ["n"]
    ).splitlines() == [
        "sensor  gap     chi-square  verdict",
        "one     0.1235  1.500       explained",
        "other   0.1235  1.500       unexplained",
        "gap in nats/pixel, on 2 test frames",
        "note      n",
    ]


def test_times_have_a_unit_or_are_seconds():
    times = {"90": 90, "90s": 90, "1.5 min": 90, "10min": 600, "2h": 7200, "0.5h": 1800}
    assert {text: duration(text) for text in times} == times
    for text in ("0", "0s", "-1", "1d", "min", "1m", "1e3", ""):
        with pytest.raises(argparse.ArgumentTypeError, match=f"^{text} must be a time"):
            duration(text)
