# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What darks and flats say, as a Diagnosis: verdict, findings, gap, limits, profile."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.darks_and_flats import (
    TEST,
    DarksAndFlats,
    untested,
)
from cg2raw.diagnose.diagnosis import (
    Diagnosis,
    Estimate,
    Finding,
    Gap,
)
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.effects.registry import unit_of
from cg2raw.diagnose.verdict.charts import charts_of
from cg2raw.diagnose.verdict.findings import (
    deciding_captures,
    finding_of,
    verdict_of,
)
from cg2raw.diagnose.verdict.limits import detection_limits
from cg2raw.diagnose.verdict.profile import mean_of_edge, updated_profile
from cg2raw.diagnose.verdict.unexplained import (
    chi_square_test,
    full_well_test,
    left_over,
    tests_of,
    unnamed_tests,
)
from cg2raw.diagnose.verdict.values import values_of
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.components import FREE
from cg2raw.model.dark_levels import DRIFT
from cg2raw.model.fit import Fit, refitted
from cg2raw.model.flat_levels import CHANGES
from cg2raw.model.full_well import NAME as WELL
from cg2raw.model.lags import FILTER
from cg2raw.model.likelihood import Likelihood, misfits
from cg2raw.model.selection import NAMES
from cg2raw.model.shapes.heavy_tailed_noise import NAME as TAILS
from cg2raw.model.values import LOGARITHMS
from cg2raw.normal import CI95
from cg2raw.statistics.constant import ConstantStatistics

GAIN_ERRORS = 20.0  # that a gain of a noise table is: known to 5 %
# What else an effect moves: the mean of a pattern, the variance of wider noise.
MOVES: Mapping[str, tuple[str, ...]] = {
    "dark_current_nonuniformity": ("dark_current",),
    "hot_pixels": ("dark_current",),
    "amplifier_glow": ("dark_current",),
    "bias_structure": ("black_level",),
    "heavy_tailed_noise": ("read_noise",),
    "random_telegraph_noise": ("read_noise",),
    "noise_reduction": ("read_noise", "shot_noise"),
}


# What darks of one exposure time have, and what may have grown to it in that time.
GROWN: Mapping[str, str] = {
    "black_level": "dark_current",
    "read_noise": "dark_current",
    "dsnu": "dark_current_nonuniformity",
    "bias_structure": "amplifier_glow",
}


def diagnosis_of(
    found: DarksAndFlats,
    names: Collection[str],
    is_judged: bool,
    free: Collection[str],
    details: bool,
) -> Diagnosis:
    """Return what darks and flats say as a diagnosis.

    names : which may be named. is_judged : the profile is judged as it is, and nothing
    is named. free : effects that others decide, which are fitted all the same.
    details : with charts."""
    captures = found.captures
    chosen = [] if is_judged else list(found.names)
    frames = _by_split(found.statistics)
    test = found.statistics.of_splits([TEST])
    samples = samples_of(test)
    shapes = untested(captures.sensor)
    fits = [_fit_of(found, [*some, *free, *shapes]) for some in ([], chosen)]
    with_steps = found.amplifiers.given_back(test)
    held_out = [_held_out(fits[0], with_steps), _held_out(fits[1], test)]
    model = fits[1]
    gap, freedom = _gap(found, chosen, held_out, samples, bool(free))
    tests = [tests_of(one, model, samples) for one in held_out]
    spots = found.statistics.spots
    unnamed = [*unnamed_tests(found.selection.unnamed, samples, spots)]
    well = found.frames.well
    if well is not None and WELL in {*names} - {*chosen}:
        unnamed.append(full_well_test(well, samples))
    gained = gap.before - gap.after
    left = left_over([*tests[1], *unnamed], gained)
    left += chi_square_test(gap.chi2_after, freedom, gained)
    findings = _findings(found, chosen, names, bool(left))
    told = sorted(name for split in GROUPS[:2] for name in frames[split])
    is_closed = findings and gap.after <= gap.before
    return Diagnosis(
        verdict=verdict_of(findings, bool(left)),
        sensor_id=captures.sensor.id,
        effects=findings,
        gap=gap,
        tests_before=tests[0],
        tests_after=tests[1],
        unexplained=left,
        detection_limits=[
            one for one in detection_limits(found, chosen) if one.name in names
        ],
        next_captures=deciding_captures(findings),
        notes=_notes(found),
        groups=frames,
        charts=list(charts_of(found, model, held_out[1], findings)) if details else [],
        profile_json=updated_profile(
            captures.sensor,
            findings if is_closed else [],
            told,
            noise_row(found),
            mean_of_edge(findings, found.frames.captures[0].shape[1]),
        )
        if is_closed or not found.frames.has_noise
        else "",
    )


def unfinished(captures: CaptureSet, *, interrupted: bool) -> Diagnosis:
    """Return the diagnosis of a set of which nothing was decided before the time limit
    or, @interrupted, Ctrl-C."""
    return Diagnosis(
        verdict="incomplete",
        sensor_id=captures.sensor.id,
        effects=[],
        gap=Gap(math.nan, math.nan, math.nan, math.nan, []),
        tests_before=[],
        tests_after=[],
        unexplained=[],
        detection_limits=[],
        next_captures=[],
        notes=list(captures.notes),
        groups={},
        interrupted=interrupted,
        time_limit_reached=not interrupted,
    )


def noise_row(found: DarksAndFlats) -> dict[str, Any] | None:
    """Return a row of a noise table as the frames show it; None where the profile has
    one, of frames of no known ISO, and of darks with too little light of their own."""
    iso = found.frames.captures[0].iso
    sensor, each = found.captures.sensor, found.both.parameters.each
    gains = each("gain")
    errors = np.sqrt(np.diagonal(found.both.covariance)[gains])
    is_known = (found.both.theta[gains] > GAIN_ERRORS * errors).all()
    if found.frames.has_noise or iso is None or not is_known:
        return None
    ranges = sensor.white_level - np.asarray(sensor.black_level, float)
    beta1 = found.both.theta[gains] / ranges
    beta2 = found.both.theta[each("read_noise")] / ranges**2
    positive = [np.maximum(beta, 1e-12).tolist() for beta in (beta1, beta2)]
    return {"iso": iso, "beta1": positive[0], "beta2": positive[1]}


def _notes(found: DarksAndFlats) -> list[str]:
    notes = [*found.captures.notes, *found.frames.notes]
    if found.captures.nuisances:
        free = ", ".join(sorted(found.captures.nuisances))
        notes.append(f"Free nuisances, which are not effects: {free}.")
    if not found.frames.has_noise:
        notes.append(
            "The profile has no noise at this ISO: its level was fitted to the "
            "captures, and is no finding."
        )
    return notes


def samples_of(statistics: ConstantStatistics) -> int:
    """Return how many samples frames have that are not masked."""
    return statistics.unmasked * int(statistics.frames.sum())


def _by_split(statistics: ConstantStatistics) -> Mapping[str, list[str]]:
    found: dict[str, list[str]] = {split: [] for split in GROUPS}
    for group in statistics.groups:
        found[group.split] += group.frames
    return found


def _fit_of(found: DarksAndFlats, chosen: Sequence[str]) -> Fit:
    """Return the fit of what is named; all else is as the profile has it, but for what
    is FREE, which is as all together show it."""
    stated = {entry["name"] for entry in found.captures.sensor.effects or ()}
    stated.discard("noise_reduction")  # what it leaves is in the profile's parameters
    moving = [other for one in (*chosen, *stated) for other in MOVES.get(one, ())]
    chosen = [*chosen, *moving]
    parameters = [p for name in chosen for p in NAMES.get(name, ())]
    known = found.both.known
    free = found.both.parameters.are(parameters) & known
    kept = free | found.both.parameters.are(FREE) & known
    start = np.where(kept, found.both.theta, found.profile)
    return refitted(found.both.likelihood, start, free)


def _held_out(fitted: Fit, test: ConstantStatistics) -> Fit:
    """Return the likelihood of held-out frames at parameters that others fitted."""
    likelihood = Likelihood(test, fitted.theta)
    value = likelihood(fitted.theta).value
    return replace(fitted, value=value, likelihood=likelihood)


def _gap(
    found: DarksAndFlats,
    chosen: Sequence[str],
    held_out: Sequence[Fit],
    samples: int,
    are_levels_free: bool,
) -> tuple[Gap, float]:
    """Return the gap of held-out frames, nats per sample beyond those that the noise of
    the model makes, and the freedom of its chi-squares.

    held_out : before and after. are_levels_free : others decide those of flats."""
    squares, freedom, gained = np.zeros(2), 0.0, held_out[1].value - held_out[0].value
    for n, one in enumerate(held_out):
        every = list(misfits(one.likelihood, one.theta))
        squares[n] = sum(misfit.squares for misfit in every)
        freedom = sum(misfit.freedom for misfit in every)
    levels = [
        found.levels_of(one.likelihood.means.statistics, one, chosen)
        for one in (found.both, held_out[1])
        if not are_levels_free
    ]
    if levels and levels[0] is not None and levels[1] is not None:
        names = [name for name in CHANGES if name in chosen]
        values = levels[0].fitted(names)
        each = levels[1].value([], np.zeros(0)), levels[1].value(names, values)
        squares -= 2 * np.array(each)
        freedom += levels[1].ratios.size
        gained += each[1] - each[0]
    after = (squares[1] - freedom) / 2
    chi_square = squares / freedom
    half = CI95 * math.sqrt(freedom / 2)  # by the chance of chi-square
    gap = Gap(
        float((after + gained) / samples),
        float(after / samples),
        float(chi_square[0]),
        float(chi_square[1]),
        sorted(
            n
            for group in found.statistics.of_splits([TEST]).groups
            for n in group.frames
        ),
        interval_after=(
            float((after - half) / samples),
            float((after + half) / samples),
        ),
    )
    return gap, freedom


def _findings(
    found: DarksAndFlats,
    chosen: Sequence[str],
    names: Collection[str],
    is_provisional: bool,
) -> list[Finding]:
    sensor = found.captures.sensor
    values: dict[str, dict[str, Estimate]] = {name: {} for name in chosen}
    for one in values_of(found, chosen):
        if one.effect in values:
            unit = unit_of(one.effect, one.parameter, sensor.cfa)
            values[one.effect][one.parameter] = Estimate(
                one.value, unit, (one.low, one.high)
            )
    return [
        finding_of(
            name,
            values[name],
            found.selection.gains[name],
            sensor,
            is_provisional,
            _alike(found, name, chosen, names, values[name]),
        )
        for name in chosen
    ]


def _alike(
    found: DarksAndFlats,
    name: str,
    chosen: Collection[str],
    names: Collection[str],
    values: Mapping[str, Estimate],
) -> list[str]:
    """Return the effects that may be in the place of one. names : which may be
    named."""
    others = [FILTER] if _may_be_filtered(found, name, values) else []
    others += [MISMATCH] * (name in found.amplifiers.alike)
    darks = [one for one in found.statistics.groups if one.kind == "dark"]
    times = {(one.split, one.charge_time) for one in darks}
    has_one = len(times) == len({split for split, _ in times})  # in each split
    if has_one and all(time > 0 for _, time in times):
        grown = [GROWN[name]] if name in GROWN else []
        if name == DRIFT and len({time for _, time in times}) > 1:
            grown = [GROWN["black_level"]]
        others += [one for one in grown if one in names]
    if name == "prnu" and "shot_noise" not in found.selection.gains:
        others += ["shot_noise"]  # flats that nothing repeats have both in their pixels
    if name == "read_noise" and TAILS not in found.selection.gains and TAILS in names:
        others += [TAILS]  # likewise of darks
    if name in found.selection.unsure and all(map(_may_be_zero, values.values())):
        gains = found.selection.gains
        free = [one for one in MOVES if one not in chosen and gains.get(one, 0.0) > 0]
        others += [one for one in free if name in MOVES[one]]
    return others + [*found.selection.alike.get(name, ())]


def _may_be_zero(one: Estimate) -> bool:
    return one.ci95[0] <= 0 <= one.ci95[1]


def _may_be_filtered(
    found: DarksAndFlats, name: str, values: Mapping[str, Estimate]
) -> bool:
    """Return whether noise reduction would do the same: there is less noise than the
    profile says, and no two frames show whether neighbours share theirs."""
    if name not in LOGARITHMS or FILTER in found.selection.gains:
        return False
    can_be = any(one.name == FILTER for one in candidates(found.captures.sensor.cfa))
    return can_be and all(one.value < 0 for one in values.values())
