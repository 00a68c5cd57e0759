# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Baseline: the model that captures are compared with first, ready to be used."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.nuisance_fit import nuisance_of, without_highlights
from cg2raw.diagnose.inference.registration import Registration
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import predict
from cg2raw.diagnose.likelihood.workers import TimeIsUp
from cg2raw.interrupts import raised

LEAST_ALIKE = 0.5  # correlation of a capture and its render
HIGHEST_COMPARED = 0.9  # of white, for that
FEWEST_COMPARED = 500  # pixels, for that


@dataclass(frozen=True)
class Baseline:
    """The sensor as its profile says, with what has to be fitted to use it at all.

    registration : where renders lie, if they may be displaced or differently bright.
    ended : what came in between, Ctrl-C or the time, and left the profile alone."""

    model: Model
    splits: Splits
    registration: Registration | None = None
    ended: type[BaseException] | None = None


def baseline_of(
    capture_set: CaptureSet,
    splits: Splits,
    report: Callable[[str, float], None],
    is_noise_known: bool = True,
) -> Baseline:
    """Return the baseline of captures.

    is_noise_known : as the profile states it; else it is fitted, and is no finding.
    Raises ValueError for renders of something else."""
    bare = Model(capture_set.sensor)
    try:
        with raised():
            return _found(capture_set, splits, bare, report, is_noise_known)
    except (KeyboardInterrupt, TimeIsUp) as ended:
        return Baseline(bare, splits, ended=type(ended))


def _found(
    capture_set: CaptureSet,
    splits: Splits,
    bare: Model,
    report: Callable[[str, float], None],
    is_noise_known: bool,
) -> Baseline:
    """Return the baseline of all steps."""
    registration = _registration(capture_set, splits, bare, report)
    placed = splits if registration is None else splits.placed(registration)
    if capture_set.doubts_light:
        shown = [without_highlights(frame, bare) for frame in placed.frames]
        placed = Splits(shown, placed.workers)
    check_correspondence(bare, placed)
    model = _fitted(capture_set, placed, bare, is_noise_known)
    return Baseline(model, placed, registration)


def _registration(
    capture_set: CaptureSet,
    splits: Splits,
    model: Model,
    report: Callable[[str, float], None],
) -> Registration | None:
    """Align renders with captures, if they may be displaced or differently bright."""
    free = capture_set.nuisances
    if not free & {"registration", "exposure"}:
        return None
    report("aligning renders with captures", 0.26)
    found = Registration(splits.frames, "registration" in free, "exposure" in free)
    found.first(model, splits.frames)
    return found


def _fitted(
    capture_set: CaptureSet, splits: Splits, model: Model, is_noise_known: bool
) -> Model:
    """Return the model with its nuisance, and with noise that has to come from the
    captures."""
    model = replace(model, nuisance=nuisance_of(capture_set, splits.of_nuisances))
    pixels = [frame for frame in splits.frames if frame.samples is None]
    if pixels and not (is_noise_known and all(f.noise.measured for f in pixels)):
        for effect in candidates(capture_set.sensor.cfa):
            if effect.scales:
                model = model.with_term(Term(effect, effect.null, calibration=True))
    return fit(model, splits.fit) if model.terms else model


def check_correspondence(model: Model, splits: Splits) -> None:
    """Refuse renders of something else than was captured. Raises ValueError."""
    for frame in splits.frames:
        if not frame.capture.shows.render:
            continue
        p = predict(model, frame)
        used = frame.keep & ~frame.censored & (p.mean < HIGHEST_COMPARED)
        if used.sum() < FEWEST_COMPARED or p.mean[used].std() < np.sqrt(
            p.variance[used].mean()
        ):
            continue  # too little light or contrast to tell
        alike = float(np.corrcoef(p.mean[used], frame.signal[used])[0, 1])
        if not alike > LEAST_ALIKE:
            raise ValueError(
                f"{frame.capture.name}: the scene does not correspond to the capture: "
                f"they correlate by {alike:.2f}, and {LEAST_ALIKE} is the least: is it "
                "the render of this frame, of the same view and crop, and are both "
                "the same way up?"
            )
