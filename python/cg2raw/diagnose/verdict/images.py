# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What scenes, charts and flats of known light say, as a Diagnosis."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.cfa import sites_of
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.diagnosis import (
    Chart,
    DetectionLimit,
    Diagnosis,
    Estimate,
    Finding,
    Gap,
)
from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.catalogue import effect, heading, misfit_sources, title
from cg2raw.diagnose.scenes.curves import curves_of
from cg2raw.diagnose.scenes.decide import PHOTONS, WELL, Scenes
from cg2raw.diagnose.scenes.flicker import chart_series, row_waves
from cg2raw.diagnose.scenes.pictures import histogram, pictures_of
from cg2raw.diagnose.scenes.predict import variance_left
from cg2raw.diagnose.scenes.selection import limits, nats_to_be_seen
from cg2raw.diagnose.stated_shapes import SHAPE_ERROR
from cg2raw.diagnose.verdict.findings import (
    deciding_captures,
    finding_of,
    verdict_of,
)
from cg2raw.diagnose.verdict.profile import updated_profile
from cg2raw.diagnose.verdict.unexplained import chi_square_test, left_over
from cg2raw.model.flicker import NAME as FLICKER
from cg2raw.normal import CI95

STRENGTHS = np.geomspace(1e-4, 1.0, 81)  # of effects without derivatives


def diagnosis_of_images(found: Scenes, details: bool) -> Diagnosis:
    """Return what images say as a diagnosis. details : with pictures and curves."""
    before, after = found.test_points
    gap = _gap(found)
    tests = found.residual_tests
    gained = gap.before - gap.after
    left = left_over(tests[1], gained)
    # Where captures have more than noise, its size was fitted to other frames.
    if not found.excess and not any(point.view.is_table for point in after):
        left += chi_square_test(gap.chi2_after, found.freedom, gained)
    values = _values(found)
    findings, shapes = _findings(found, values, bool(left))
    notes = [*found.capture_set.notes, *_notes(found), *shapes]
    sensor = found.capture_set.sensor
    every = [*findings, *_shape_findings(found, values, findings)]
    names = _by_split(found)
    captures = sorted({name for split in GROUPS[:2] for name in names[split]})
    is_closed = bool(findings) and gap.after <= gap.before
    noise = noise_row(found)
    return Diagnosis(
        verdict="incomplete" if found.ended else verdict_of(findings, bool(left)),
        sensor_id=sensor.id,
        effects=findings,
        gap=gap,
        tests_before=tests[0],
        tests_after=tests[1],
        unexplained=left,
        detection_limits=[] if found.ended else list(_limits(found)),
        next_captures=deciding_captures(findings),
        notes=notes,
        groups=names,
        pictures=pictures_of(before, after) if details else [],
        curves=curves_of(found.model, values, [point.frame for point in after])
        if details
        else [],
        charts=list(_charts(found)) if details else [],
        histogram_before=histogram(before),
        histogram_after=histogram(after),
        profile_json=updated_profile(
            sensor, every if is_closed else [], captures, noise
        ),
        interrupted=found.ended is KeyboardInterrupt,
        time_limit_reached=found.ended not in (None, KeyboardInterrupt),
    )


def _by_split(found: Scenes) -> dict[str, list[str]]:
    names: dict[str, list[str]] = {split: [] for split in GROUPS}
    for view in found.views:
        names[view.group] += [frame.capture.name for frame in view.frames]
    return names


def _values(found: Scenes) -> dict[str, dict[str, Estimate]]:
    """Return the values of all effects in the model, beyond the profile's."""
    both = found.both
    index = found.space.index(found.fitted)
    errors = np.zeros(found.space.size)
    ratio = (both.squares - 2 * both.gain(found.theta)) / max(both.n, 1)
    variances = np.diagonal(both.covariance(index)) * max(ratio, 1.0)
    errors[index] = np.sqrt(np.maximum(variances, 0))
    values = {}
    for one in found.effects:
        if one.name in found.chosen.names:
            part = found.space.slices[one.name]
            values[one.name] = _estimates(
                one, one.used, found.theta[part], errors[part]
            )
    for name, numbers in found.shapes.items():
        one = effect(name)
        values[name] = _estimates(one, one.parameters, *numbers)
    return values


def _estimates(
    one: Effect, names: Sequence[str], values: Any, errors: Any
) -> dict[str, Estimate]:
    units = dict(zip(one.parameters, one.units, strict=True))
    return {
        name: Estimate(
            float(value),
            units[name],
            (float(value - CI95 * error), float(value + CI95 * error)),
        )
        for name, value, error in zip(names, values, errors, strict=True)
    }


def _findings(
    found: Scenes, values: Mapping[str, Mapping[str, Estimate]], left: bool
) -> tuple[list[Finding], list[str]]:
    """Return (findings, notes on names that are none of their own).

    An effect's model has a shape; what the true one has beside it, SHAPE_ERROR of its
    gain, is taken up by another, known or any that does as well. That stays in the
    profile, and is not called an effect of its own."""
    nats = {**found.chosen.nats, **found.nats}
    every = {
        name: [some[0] for some in found.chosen.alike.get(name, ()) if len(some) == 1]
        for name in nats
    }
    findings, notes = [], []
    for name in sorted(nats, key=lambda one: -nats[one]):
        alike = every[name]
        vague = SHAPE_ERROR if len(alike) > 1 else 0.0
        if larger := misfit_sources(name, nats, every, vague):
            share = nats[name] / nats[larger[0]]
            notes.append(
                f"{heading(name)} takes up what the model of {title(larger[0])} does "
                f"not describe ({share:.1%} of its gain): it is in the profile, and is "
                "no finding of its own."
            )
            continue
        sensor = found.capture_set.sensor
        instead = found.chosen.instead.get(name)
        findings.append(
            finding_of(name, values[name], nats[name], sensor, left, alike, instead)
        )
    return findings, notes


def _shape_findings(
    found: Scenes,
    values: Mapping[str, Mapping[str, Estimate]],
    findings: Sequence[Finding],
) -> list[Finding]:
    """Return what the profile has besides the findings."""
    named = {one.name for one in findings}
    nats = {**found.chosen.nats, **found.nats}
    return [
        Finding(name, values[name], gain, 1.0, [], [], "", "")
        for name, gain in nats.items()
        if name not in named
    ]


def _gap(found: Scenes) -> Gap:
    gram = found.grams["report"]
    n = max(gram.n, 1) * variance_left(found.model)
    squares = gram.squares + found.of_flicker, gram.squares - 2 * gram.gain(found.theta)
    chi_squares = squares[0] / n, squares[1] / n
    before, after = ((one - 1) / 2 for one in chi_squares)
    half = CI95 * math.sqrt(0.5 / n)
    return Gap(
        before,
        after,
        chi_squares[0],
        chi_squares[1],
        sorted(_by_split(found)["report"]),
        interval_before=(before - half, before + half),
        interval_after=(after - half, after + half),
    )


def _limits(found: Scenes) -> Iterator[DetectionLimit]:
    select = found.grams["select"]
    named = {*found.chosen.names, *found.shapes}
    free = [name for name in found.candidates if name not in named]
    every = limits(found.space, select, list(found.fitted), free, found.least)
    for one in found.effects:
        strengths = every.get(one.name)
        most = (one.high - one.low)[one.is_used][0]  # beyond is no such effect
        if strengths is not None and strengths[0] <= most:
            parameter, unit = one.parameters[0], one.units[0]
            yield DetectionLimit(one.name, parameter, float(strengths[0]), unit)
    if FLICKER not in named and math.isfinite(found.least_flicker):
        yield DetectionLimit(FLICKER, "amplitude", found.least_flicker, "1")
    needed = nats_to_be_seen(found.least)
    for name in (WELL, PHOTONS):
        if name in found.names and name not in named:
            one = effect(name)
            gain = one.expected_gain(found.selected)
            seen = [s for s in STRENGTHS if gain and gain(float(s)) >= needed]
            if seen:
                parameter, unit = one.parameters[0], one.units[0]
                yield DetectionLimit(name, parameter, float(seen[0]), unit)


def _charts(found: Scenes) -> Iterator[Chart]:
    """Yield the chart of flicker: what test frames that repeat each other differ by."""
    if FLICKER not in found.shapes:
        return
    if (waves := row_waves(found.test_points[1])) is not None:
        yield Chart(
            FLICKER,
            "Light of the rows in the difference of two test frames",
            "row",
            "% of the light",
            (chart_series(waves, found.shapes[FLICKER][0]),),
        )


def noise_row(found: Scenes) -> dict[str, Any] | None:
    """Return a row of a noise table as images show it; None where the profile has one,
    or of frames of no known ISO."""
    frames = [view.frame for view in found.views if not view.frame.noise.measured]
    isos = [frame.capture.iso for frame in frames if frame.capture.iso is not None]
    if found.capture_set.sensor.noise or not isos:
        return None
    frame = next(frame for frame in frames if frame.capture.iso == isos[0])
    sites = len(sites_of(found.capture_set.sensor.cfa))
    row: dict[str, Any] = {"iso": isos[0]}
    for name in ("beta1", "beta2"):
        betas = np.array(getattr(frame.noise, name)) * found.model.noise_gain(name)
        row[name] = np.broadcast_to(betas, max(sites, len(betas))).tolist()
    return row


def _notes(found: Scenes) -> list[str]:
    notes = []
    if found.capture_set.nuisances:
        free = ", ".join(sorted(found.capture_set.nuisances))
        notes.append(f"Free nuisances, which are not effects: {free}.")
    if any(term.calibration for term in found.model.terms):
        notes.append(
            "The noise was fitted to the images, and is no finding: darks and flats "
            "that repeat each other tell it."
        )
    for name, alike in found.chosen.alike.items():
        pairs = [" with ".join(map(title, some)) for some in alike if len(some) == 2]
        if pairs:
            notes.append(
                f"{heading(name)} explains as much as {', or '.join(pairs[:2])}: "
                "fewer effects are named."
            )
    return notes
