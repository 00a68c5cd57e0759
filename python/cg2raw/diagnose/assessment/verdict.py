# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Verdict: a model, its search and whole held-out frames become a Diagnosis."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cg2raw.diagnose.assessment.acceptance import (
    founded,
    is_better,
    not_better,
    refusals,
)
from cg2raw.diagnose.assessment.curves import curves_of
from cg2raw.diagnose.assessment.figures import histogram
from cg2raw.diagnose.assessment.findings import (
    findings_of,
    refused_rung,
    rung_of,
    with_losses,
    without_shapes,
)
from cg2raw.diagnose.assessment.gap import gap_of, systematic
from cg2raw.diagnose.assessment.pieces import Pieces
from cg2raw.diagnose.assessment.residual_tests import residual_tests
from cg2raw.diagnose.assessment.updated_profile import updated_profile
from cg2raw.diagnose.assessment.whole_field import on_whole_frames
from cg2raw.diagnose.assessment.whole_frames import Look, WholeFrames
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import (
    STRUCTURE,
    Diagnosis,
    Finding,
    Gap,
    ResidualTest,
)
from cg2raw.diagnose.effects.base import EstimatesByEffect
from cg2raw.diagnose.effects.discriminating_captures import deciding_captures
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.detection_limits import detection_limits
from cg2raw.diagnose.inference.intervals import estimates
from cg2raw.diagnose.inference.model_selection import Search
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.verdict.unexplained import chi_square_test, left_over


@dataclass(frozen=True)
class _Held:
    """What held-out frames leave of a model: itself with its estimates, or baseline.

    refused : effects that may not be named. confirmed : whole report frames are more
    likely by it. notes : sentences on both."""

    model: Model
    values: EstimatesByEffect
    look: Look
    refused: Sequence[str]
    confirmed: bool
    notes: list[str]


def _held(
    capture_set: CaptureSet,
    baseline: Baseline,
    splits: Splits,
    model: Model,
    details: bool,
    search: Search,
) -> _Held:
    model, values, refused = founded(model, splits.fit)
    notes = refusals(refused)
    pieces = Pieces(capture_set, baseline.model, baseline.registration, splits.fit)
    fitted = on_whole_frames(model, pieces)
    if fitted is not model:
        model, values = fitted, estimates(fitted, splits.fit)
    whole = WholeFrames(splits.report, baseline.model, pieces, details)
    look = whole.look_at(model)
    if model.found_names and not is_better(look.before, look.after):
        notes.append(not_better(model.found_names, look.before, look.after))
        return _Held(baseline.model, {}, look.unchanged, [*refused], False, notes)
    return _Held(model, values, look, [*refused], True, notes)


def _gap(baseline: Baseline, held: _Held, frames: Sequence[Frame]) -> Gap:
    systematic_errors = (
        systematic(baseline.model, baseline.model, frames),
        systematic(held.model, baseline.model, frames),
    )
    names = sorted({frame.capture.name for frame in frames})
    return gap_of(held.look.before, held.look.after, systematic_errors, names)


def assessed(
    capture_set: CaptureSet,
    baseline: Baseline,
    search: Search,
    model: Model,
    details: bool,
) -> Diagnosis:
    """Return the diagnosis of a model that a search found.

    details : with what is drawn, and what is lost without each effect. A search that
    was cut short knows no detection limits."""
    splits, report = search.splits, search.splits.report
    cut_short = search.timed_out or search.interrupted
    held = _held(capture_set, baseline, splits, model, details, search)
    gap = _gap(baseline, held, report.frames)
    before = residual_tests(baseline.model, splits.select, splits.fit)
    after = residual_tests(held.model, report, splits.select)
    left = [
        *left_over(after, gap.before - gap.after),
        *chi_square_test(held.look.after.chi2, held.look.after.independent),
    ]
    every = findings_of(held.model, search.steps, held.values, bool(left))
    findings, shapes = without_shapes(every, held.model, search)
    notes = _notes(capture_set, baseline.model, _traces(after, left))
    found = Diagnosis(
        verdict=_verdict(findings, left, cut_short),
        sensor_id=capture_set.sensor.id,
        effects=findings,
        gap=gap,
        tests_before=before,
        tests_after=after,
        unexplained=left,
        ladder=[*map(rung_of, search.steps), *map(refused_rung, held.refused)],
        detection_limits=[]
        if cut_short
        else detection_limits(
            held.model, search.effects, splits.select, splits.fit, search.alpha
        ),
        next_captures=_next_captures(findings),
        notes=[*notes, *shapes, *held.notes],
        groups=splits.names,
        pictures=list(held.look.pictures),
        histogram_before=histogram(baseline.model, report),
        histogram_after=histogram(held.model, report),
        profile_json=updated_profile(
            held.model, splits.fit.frames, findings, held.values
        )
        if held.confirmed
        else "",
        interrupted=search.interrupted,
        time_limit_reached=search.timed_out,
    )
    return _detailed(found, held, search) if details else found


def _detailed(found: Diagnosis, held: _Held, search: Search) -> Diagnosis:
    """Return a diagnosis with what is drawn, and what is lost without each effect."""
    splits = search.splits
    return replace(
        found,
        effects=with_losses(found.effects, held.model, search),
        curves=curves_of(held.model, held.values, splits.report.frames),
    )


def _next_captures(findings: Sequence[Finding]) -> list[str]:
    return [
        text
        for finding in findings
        for text in deciding_captures(finding.name, finding.ambiguous_with)
    ]


def _verdict(
    findings: Sequence[Finding], left: Sequence[ResidualTest], cut_short: bool
) -> str:
    """Return the verdict. cut_short : by a time limit or Ctrl-C."""
    if cut_short:
        return "incomplete"
    if not findings:
        return "unexplained" if left else "consistent"
    if left:
        return "partially_explained"
    ambiguous = any(finding.ambiguous_with for finding in findings)
    return "ambiguous" if ambiguous else "explained"


def _traces(
    tests: Sequence[ResidualTest], left: Sequence[ResidualTest]
) -> list[ResidualTest]:
    """Return the tests beyond chance that say that too little is left to matter."""
    alarms = [test for test in tests if test.p_value < STRUCTURE / len(tests)]
    return [test for test in alarms if test not in left]


def _notes(
    capture_set: CaptureSet, model: Model, traces: Sequence[ResidualTest]
) -> list[str]:
    notes = list(capture_set.notes)
    if capture_set.nuisances:
        free = ", ".join(sorted(capture_set.nuisances))
        notes.append(f"Free nuisances, which are not effects: {free}.")
    if any(term.calibration for term in model.terms):
        notes.append(
            "The noise was fitted to the images, and is no finding: darks and flats "
            "that repeat each other tell it."
        )
    if traces:
        most = max(traces, key=lambda test: test.nats_per_pixel)
        tests = "residual test" if len(traces) == 1 else "residual tests"
        notes.append(
            f"{len(traces)} {tests} beyond chance, too small to matter: at most "
            f"{most.nats_per_pixel:.2g} nats/pixel ({most.name})."
        )
    return notes
