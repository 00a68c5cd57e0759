# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Conclusion: a model and its search become a Diagnosis."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import norm

from cg2raw.diagnose.assessment.acceptance import (
    founded,
    is_better,
    not_better,
    refusals,
)
from cg2raw.diagnose.assessment.figures import curves_of, histogram
from cg2raw.diagnose.assessment.gap import Sums, gap_of, systematic
from cg2raw.diagnose.assessment.residual_tests import residual_tests
from cg2raw.diagnose.assessment.updated_profile import found_profile
from cg2raw.diagnose.assessment.whole_frames import look_at
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import (
    Alternative,
    Diagnosis,
    Finding,
    Gap,
    ResidualTest,
    Rung,
)
from cg2raw.diagnose.effects import words
from cg2raw.diagnose.effects.catalogue import Candidate
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.detection_limits import smallest_visible
from cg2raw.diagnose.inference.fisher_scoring import fit
from cg2raw.diagnose.inference.model_selection import Search, Step
from cg2raw.diagnose.inference.registration import Registration
from cg2raw.diagnose.likelihood.likelihood import Workers, total
from cg2raw.diagnose.likelihood.prediction import Model

STRUCTURE = 1e-3  # chance of one false alarm among all residual tests
LEAST_NATS = 2e-4  # per pixel; what is smaller is a trace, and no structure
SHARE_LEFT = 1e-3  # of what was closed, likewise
# What takes up how a true effect differs from its model, and the share of its gain up
# to which that is no finding: far wings of a point spread function, what is left along
# edges; how an image is displaced between pixels; a fall-off that is no polynomial; the
# slow part of a map, which the map leaves out. Shares are about twice the largest that
# single hidden effects and measured lenses left. Noise that shows where there is no
# image, in darks and flats, is noise all the same.
TAKEN_UP_BY: Mapping[str, Mapping[str, float]] = {
    "blur": {
        "veiling_glare": 0.015,
        "crosstalk": 0.004,
        "noise_reduction": 0.025,
        "heavy_tailed_noise": 0.025,
    },
    "lateral_chromatic_aberration": {"blur": 0.01},
    "lens_shading": {"exposure": 1e-4, "prnu": 5e-5},
    "prnu": {"color_shading": 0.01, "lens_shading": 0.01, "gr_gb_imbalance": 0.003},
}
NOISES = ("noise_reduction", "heavy_tailed_noise")
# Absolute bounds, whatever was closed: nats per pixel that nobody calls a trace, and
# how far reduced chi-square of whole frames may be from 1.
LARGE_NATS, LARGE_P = 1e-3, 1e-4
CHI_SQUARE, CHANCE = 0.02, 4.0  # CHANCE: standard errors, where pixels are few
CHI_SQUARE_NAME = "chi-square of whole frames"
CERTAIN_E = 690.0  # log of the largest e-value that is written


def left_over(tests: Sequence[ResidualTest], gained: float) -> list[ResidualTest]:
    """Return the tests that say that something is left, of a model that closed so many
    nats per pixel."""
    least = max(LEAST_NATS, SHARE_LEFT * gained)
    return [
        test
        for test in tests
        if (test.p_value < STRUCTURE / len(tests) and test.nats_per_pixel > least)
        or (test.p_value < LARGE_P and test.nats_per_pixel > LARGE_NATS)
    ]


def _traces(
    tests: Sequence[ResidualTest], left: Sequence[ResidualTest]
) -> list[ResidualTest]:
    """Return the tests beyond chance that say that too little is left to matter."""
    alarms = [test for test in tests if test.p_value < STRUCTURE / len(tests)]
    return [test for test in alarms if test not in left]


def _chi_square(after: Sums) -> list[ResidualTest]:
    """Return the test of whole frames' chi-square, if it is not near 1."""
    error = np.sqrt(2 / max(after.residuals, 1))
    away = after.chi2 - 1
    if abs(away) <= max(CHI_SQUARE, CHANCE * error):
        return []
    text = "larger" if away > 0 else "smaller"
    return [
        ResidualTest(
            CHI_SQUARE_NAME,
            after.chi2,
            float(2 * norm.sf(abs(away) / error)),
            0.5 * float(abs(away - np.log(after.chi2))),
            f"the residuals are {text} than the noise that is predicted",
        )
    ]


def _findings(
    model: Model, steps: Sequence[Step], values: Any, gap: Gap, provisional: bool
) -> list[Finding]:
    findings = []
    for term in model.terms:
        if term.calibration:
            continue
        step = next(s for s in reversed(steps) if s.name == term.name)
        others = [
            Alternative(name, height)
            for name, height in step.ranking
            if name != term.name
        ]
        findings.append(
            Finding(
                name=term.name,
                parameters=values[term.name],
                gain_nats=step.gain,
                e_value=float(np.exp(min(step.evidence, CERTAIN_E))),
                alternatives=others,
                ambiguous_with=list(step.ambiguous),
                where=words.where(term.name),
                sentence=words.sentence(term.name, values[term.name], gap),
                provisional=provisional,
                rule=step.rule,
            )
        )
    return findings


def _losses_without(name: str, model: Model, search: Search) -> tuple[float, float]:
    """Return what the select frames lose, nats, if all but one effect explain them;
    and what the uniform ones of them lose."""
    rest = fit(model.without(name), search.fit_frames, search.workers)
    uniform = [f for f in search.select_frames if f.capture.kind in ("dark", "flat")]

    def loss(frames: Sequence[Frame]) -> float:
        with_it, without = (
            total(each, frames, search.workers) for each in (model, rest)
        )
        return with_it - without

    return loss(search.select_frames), loss(uniform)


def _without_shapes(
    findings: Sequence[Finding], model: Model, search: Search
) -> tuple[list[Finding], list[str]]:
    """Return (findings, notes on those that are no findings).

    An effect's model has a shape; what the true one has beside it is taken up by
    another. That stays in the model, and is not called an effect of its own."""
    gains = {finding.name: finding.gain_nats for finding in findings}
    kept, notes = [], []
    for finding in findings:
        enough = {
            larger: TAKEN_UP_BY[larger][finding.name] * gains[larger]
            for larger in gains
            if finding.name in TAKEN_UP_BY.get(larger, {})
        }
        # What it gained when it was added may since be explained by others.
        gain, of_uniform = np.inf, 0.0
        if enough:
            gain, of_uniform = _losses_without(finding.name, model, search)
        if finding.name in NOISES and of_uniform > search.threshold:
            gain = np.inf
        larger = next((name for name, least in enough.items() if gain < least), None)
        if larger is None:
            kept.append(finding)
            continue
        notes.append(
            f"{words.title(finding.name).capitalize()} takes up what the model of "
            f"{words.title(larger)} does not describe ({gain / gains[larger]:.1%} of "
            "its gain): it is in the profile, and is no finding of its own."
        )
    return kept, notes


def _verdict(findings: Sequence[Finding], left: Sequence[ResidualTest]) -> str:
    if not findings:
        return "unknown structure" if left else "no gap"
    if left:
        return "identified, rest unexplained"
    ambiguous = any(finding.ambiguous_with for finding in findings)
    return "ambiguous" if ambiguous else "identified"


def concluded(
    base: Model,
    model: Model,
    search: Search,
    groups: dict[str, list[Frame]],
    workers: Workers,
    alpha: float,
    vocabulary: Sequence[Candidate],
    capture_set: CaptureSet,
    registration: Registration | None,
    details: bool,
) -> Diagnosis:
    report = groups["report"]
    model, values, refused = founded(model, groups["fit"], workers)
    notes = refusals(refused)
    look = look_at(capture_set, report, base, model, registration, workers, details)
    if model.found_names and not is_better(look.before, look.after):
        notes.append(not_better(model.found_names, look.before, look.after))
        model, values, look = base, {}, look.unchanged
        confirmed = False
    else:
        confirmed = True
    gap = gap_of(
        look.before,
        look.after,
        (systematic(base, base, report), systematic(model, base, report)),
        sorted({frame.capture.name for frame in report}),
    )
    before = residual_tests(base, groups["select"], workers, groups["fit"])
    after = residual_tests(model, report, workers, groups["select"])
    left = [*left_over(after, gap.before - gap.after), *_chi_square(look.after)]
    every = _findings(model, search.steps, values, gap, bool(left))
    findings, shapes = _without_shapes(every, model, search)
    shown = report if details else []
    return Diagnosis(
        verdict=_verdict(findings, left),
        sensor_id=capture_set.sensor.id,
        effects=findings,
        gap=gap,
        tests_before=before,
        tests_after=after,
        unexplained=left,
        ladder=[*map(_rung, search.steps), *map(_refused_rung, refused)],
        power=smallest_visible(
            model, vocabulary, groups["select"], workers, alpha, groups["fit"]
        ),
        next_captures=[
            text
            for finding in findings
            for text in words.deciding_captures(finding.name, finding.ambiguous_with)
        ],
        notes=[*_notes(capture_set, report, _traces(after, left)), *shapes, *notes],
        groups={n: [f.capture.name for f in fs] for n, fs in groups.items()},
        pictures=list(look.pictures),
        curves=curves_of(model, values, shown) if details else [],
        histogram_before=histogram(base, report, workers),
        histogram_after=histogram(model, report, workers),
        profile_json=found_profile(model, groups["fit"], findings, values)
        if confirmed
        else "",
    )


def _rung(step: Step) -> Rung:
    ranking = [Alternative(name, gain) for name, gain in step.ranking]
    return Rung(step.action, step.name, step.gain, ranking, step.rule)


def _refused_rung(name: str) -> Rung:
    return Rung("dropped", name, 0.0, [], "It may not be named: see the notes.")


def _notes(
    capture_set: CaptureSet, frames: Sequence[Frame], traces: Sequence[ResidualTest]
) -> list[str]:
    notes = list(capture_set.notes)
    if capture_set.nuisances:
        words_ = ", ".join(sorted(capture_set.nuisances))
        notes.append(f"Floated without being called an effect: {words_}.")
    if any(not frame.noise.measured for frame in frames):
        notes.append(
            "The profile has no noise at these ISOs: its level was fitted to the "
            "captures, and is no finding."
        )
    if traces:
        most = max(traces, key=lambda test: test.nats_per_pixel)
        tests = "residual test" if len(traces) == 1 else "residual tests"
        notes.append(
            f"{len(traces)} {tests} beyond chance, too small to matter: at most "
            f"{most.nats_per_pixel:.2g} nats/pixel ({most.name})."
        )
    return notes
