# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Benchmark of the diagnosis: hidden effects, drawn by seed, and how many it names.

    ./studies/run diagnose low-none --count 20

Suites that are frozen come from their files (frozen.py), unless --seed draws others;
gates is some sets of each. A run that was interrupted goes on with --resume."""

import argparse
import contextlib
import json
import math
import multiprocessing
import os
import sys
import time
from collections.abc import Iterator, Sequence
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import Diagnosis
from cg2raw.interrupts import raised
from cg2raw.short_messages import Parser
from cg2raw.system import children_without_ctrl_c
from studies.diagnose.cameras import cameras, manifest
from studies.diagnose.frozen import SIZES, freeze, frozen
from studies.diagnose.gates import COUNTS, GATES, OF_REAL_FRAMES
from studies.diagnose.gates import table as gates_table
from studies.diagnose.real import manifest_of
from studies.diagnose.real_frames import add_data, folder_of
from studies.diagnose.scores import errors, half_points, of_limits, score, table
from studies.diagnose.suites import SUITES, AnyCase, cases
from studies.places import ROOT

# Threads of BLAS and OpenMP would only be in the way of the worker processes.
ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
CAMERAS = "cameras"  # a suite of real frames as they are
RECORDS = ROOT / "build" / "diagnose.jsonl"
Limits = dict[str, Any]  # time_limit and pixels, as of diagnose


def run_case(case: AnyCase, alpha: float, **limits: Any) -> dict[str, Any]:
    """Diagnose one case; return its record. What fails is recorded as "error".

    limits : time_limit and pixels, as of diagnose. Its seconds are the processor's,
    whatever else that is doing."""
    record: dict[str, Any] = {
        "suite": case.suite,
        "number": case.number,
        "seed": case.seed,
        "alpha": alpha,
        "hidden": list(case.strengths),
        "strengths": case.strengths,
        "strength": next(iter(case.strengths.values()), None),
    }
    try:
        captures, _ = case.captures()
        start = time.process_time()
        given = {key: value for key, value in limits.items() if value is not None}
        found = _diagnosed(captures, alpha, without=case.without, **given)
        record["seconds"] = time.process_time() - start
    except Exception as error:  # one bad case must not end a night's bench
        record["error"] = f"{type(error).__name__}: {error}"
        return record
    record.update(score(list(case.strengths), found))
    record["errors"] = errors(case.expected(), found)
    record["nats_needed"] = nats_needed(alpha)
    missed = [name for name in case.strengths if name not in record["named"]]
    if missed and not case.without and case.suite not in ("unknown", "few"):
        record["evidence"] = case.evidence(missed)
        record["of_limits"] = of_limits(missed, case.expected(), found, captures.sensor)
    if case.suite == "closed-loop":
        record.update(_again(captures, found, alpha))
    return record


def _diagnosed(captures: CaptureSet, alpha: float, **options: Any) -> Diagnosis:
    from cg2raw.diagnose import diagnose

    return diagnose(captures, alpha=alpha, threads=1, details=False, **options)


def nats_needed(alpha: float) -> float:
    """Return what a name needs on the select frames: ln(names / alpha)."""
    from cg2raw.diagnose.effects.catalogue import names

    return math.log(len(names()) / alpha)


def _again(captures: CaptureSet, found: Diagnosis, alpha: float) -> dict[str, Any]:
    """Diagnose frames of the found profile by that profile: there must be no gap."""
    from cg2raw import Sensor
    from diagnose.closed_loop import simulated

    sensor = Sensor.from_json(found.profile_json)
    second = _diagnosed(simulated(captures, sensor), alpha)
    return {
        "again_verdict": second.verdict,
        "again_named": [one.name for one in second.effects],
        "again_unexplained": [one.name for one in second.unexplained],
    }


def _job(work: tuple[AnyCase, float, Limits]) -> dict[str, Any]:
    case, alpha, limits = work
    return run_case(case, alpha, **limits)


def records_of(
    wanted: Sequence[AnyCase], alpha: float, jobs: int, limits: Limits | None = None
) -> Iterator[dict[str, Any]]:
    """Yield the records of cases as they are done.

    jobs : worker processes; 1 for this process."""
    work = [(case, alpha, limits or {}) for case in wanted]
    if jobs == 1 or len(work) < 2:
        yield from map(_job, work)
        return
    for name in ONE_THREAD:
        os.environ[name] = "1"
    resource_tracker.ensure_running()  # which unblocks Ctrl-C when it starts
    with raised(), contextlib.ExitStack() as end:
        with children_without_ctrl_c():
            pool = end.enter_context(multiprocessing.get_context("spawn").Pool(jobs))
        yield from pool.imap_unordered(_job, work)


def done_before(
    path: Path | None, wanted: Sequence[AnyCase], alpha: float
) -> list[dict[str, Any]]:
    """Return the records in a file that are of these cases and did not fail."""
    if path is None or not path.exists():
        return []
    keys = {(case.suite, case.number, case.seed): case for case in wanted}
    kept = {}
    for line in path.read_text().splitlines():
        try:
            one = json.loads(line)
        except ValueError:
            continue  # the line that an interruption cut
        key = (one["suite"], one["number"], one["seed"])
        case = keys.get(key) if "error" not in one else None
        ours = one["alpha"] == alpha
        if case and ours and one.get("strengths") == case.strengths:
            kept[key] = one
    return list(kept.values())


def bench(
    suite: str,
    *,
    count: int | None = None,
    seed: int | None = None,
    jobs: int = 1,
    effects: Sequence[str] = (),
    alpha: float = 0.01,
    path: Path | None = None,
    progress: bool = False,
    captures: str | os.PathLike[str] | None = None,
    data: Path | None = None,
    limits: Limits | None = None,
) -> list[dict[str, Any]]:
    """Run a suite; return the records of its cases, in their order.

    seed : None for the frozen sets, of which count are the first, and effects those
    that hide one of them; with one, count, effects and captures are as of suites.cases.
    data : folder of real frames, of cameras. path : JSON lines, appended as cases
    end. limits : as of run_case; a time limit makes results depend on the machine."""
    wanted = _wanted(suite, seed, count, effects, captures, data)
    records = done_before(path, wanted, alpha)
    numbers = {one["number"] for one in records}
    left = [case for case in wanted if case.number not in numbers]
    for one in records_of(left, alpha, jobs, limits):
        records.append(one)
        if path is not None:
            with path.open("a") as file:
                file.write(json.dumps(one) + "\n")
        if progress:
            hidden = "+".join(one["hidden"]) or "nothing"
            said = one.get("error") or f"{one['outcome']}: {', '.join(one['named'])}"
            print(f"{len(records)}/{len(wanted)} {hidden}: {said}", file=sys.stderr)
    return sorted(records, key=lambda one: one["number"])


def _wanted(
    suite: str,
    seed: int | None,
    count: int | None,
    effects: Sequence[str],
    captures: str | os.PathLike[str] | None,
    data: Path | None,
) -> list[AnyCase]:
    if suite == CAMERAS:
        there, absent = cameras(folder_of(data))
        for sentence in absent:
            print(f"diagnose: {sentence}", file=sys.stderr)
        return list(there[:count])
    if seed is not None or suite not in SIZES:
        return cases(suite, seed or 0, count, effects, captures)
    is_real = suite == "real"
    if captures is not None and not is_real:
        raise ValueError(f"captures {captures}: suite {suite} makes its own; only real")
    found = frozen(suite, _planted_in(captures, data) if is_real else None)
    if effects:
        found = [case for case in found if set(effects) & set(case.strengths)]
    if not found:
        raise ValueError(f"no set of {suite} hides {' or '.join(effects)}")
    return found[:count]


def _planted_in(captures: str | os.PathLike[str] | None, data: Path | None) -> Path:
    """Return the manifest of the frames that the suite real plants effects in."""
    if captures is not None:
        return manifest_of(captures)
    return manifest("ccd", folder_of(data))


def _check_new(path: Path | None, suite: str) -> None:
    """Raise ValueError if a file has records of a suite already."""
    if path is None or not path.exists():
        return
    start = json.dumps({"suite": suite})[:-1]
    found = sum(line.startswith(start) for line in path.read_text().splitlines())
    if found:
        raise ValueError(
            f"{path}: has {found} sets of {suite}: go on with --resume, or name "
            "another file with --json"
        )


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    parser = Parser(prog="studies/run diagnose", description=__doc__.splitlines()[0])
    parser.add_argument("suite", choices=[*SUITES, CAMERAS, GATES], nargs="?")
    parser.add_argument("--count", type=int, help="of sets; with --seed, per effect")
    parser.add_argument("--seed", type=int, help="draws sets that are not the frozen")
    parser.add_argument("--freeze", action="store_true", help="write the frozen sets")
    parser.add_argument("--resume", action="store_true", help="leave out what is done")
    parser.add_argument("--jobs", type=int, default=2, help="worker processes")
    parser.add_argument("--effects", default="", help="NAME,... to hide")
    parser.add_argument(
        "--captures", metavar="PATH", help="captures.yaml or its folder, of real suites"
    )
    add_data(parser)
    parser.add_argument("--pixels", type=int, help="of each frame that are fitted")
    parser.add_argument("--time-limit", type=float, metavar="S", help="of each case")
    parser.add_argument("--alpha", type=float, default=0.01)
    parser.add_argument("--json", type=Path, help="file of records, %(default)s")
    parser.add_argument("--quiet", action="store_true", help="no progress; table alone")
    parser.set_defaults(json=RECORDS)
    given = parser.parse_args(argv)
    if not given.suite and not given.freeze:
        parser.error(f"suite must be one of {', '.join(SUITES)}")
    return given


def _suites(given: argparse.Namespace) -> dict[str, int | None]:
    """Return how many sets of which suites are asked for; None for all."""
    if given.suite != GATES:
        return {given.suite: given.count}
    suites = COUNTS
    if given.data is None:
        suites = {s: COUNTS[s] for s in COUNTS if s not in OF_REAL_FRAMES}
        left_out = f"{', '.join(OF_REAL_FRAMES)}: skipped, no folder of real frames"
        print(f"diagnose: {left_out}", file=sys.stderr)
    return {suite: given.count or count for suite, count in suites.items()}


def _records(
    given: argparse.Namespace, suite: str, count: int | None
) -> list[dict[str, Any]]:
    return bench(
        suite,
        count=count,
        seed=given.seed,
        jobs=max(given.jobs, 1),
        effects=[name for name in given.effects.split(",") if name],
        alpha=given.alpha,
        path=given.json,
        progress=not given.quiet,
        captures=given.captures,
        data=given.data,
        limits={
            "pixels": given.pixels,
            "time_limit": given.time_limit,
        },
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Run one suite and print its table; 1 if a case failed, or for bad arguments."""
    given = _arguments(argv)
    try:
        if given.freeze:
            planted = given.captures or given.data
            path = _planted_in(given.captures, given.data) if planted else None
            print("frozen:", ", ".join(freeze(path)))
            return 0
        suites = _suites(given)
        if not given.resume:
            for suite in suites:
                _check_new(given.json, suite)
        given.json.parent.mkdir(parents=True, exist_ok=True)
        records = [one for item in suites.items() for one in _records(given, *item)]
    except (ValueError, OSError) as error:
        print(f"diagnose: {error}", file=sys.stderr)
        return 1
    if given.suite == GATES:
        print(gates_table(records))
    else:
        print(table(given.suite, records))
    if given.suite == "power":
        for name, strength in half_points(records).items():
            print(f"half of {name} named at {strength:.4g}")
    return int(any("error" in one for one in records))
