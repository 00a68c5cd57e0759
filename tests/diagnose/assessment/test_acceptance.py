# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Names and models that must not be believed, whatever a search says."""

import time

import numpy as np
import pytest

from cg2raw.diagnose.assessment import acceptance
from cg2raw.diagnose.assessment.acceptance import CONFIRMING_GAIN, founded, is_better
from cg2raw.diagnose.assessment.gap import Sums
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.diagnosis import CHI_SQUARE_NAME, Estimate, ResidualTest
from cg2raw.diagnose.inference.model_selection import Search, Step
from cg2raw.diagnose.likelihood.workers import TimeIsUp, Workers
from cg2raw.diagnose.verdict.unexplained import left_over
from diagnose.planted import (
    BY_NAME,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)
from diagnose.test_pipeline import SENSOR, run, set_of, shown_set

KINDS = ("dark", "flat", "scene")


def frames_with(sensor=SENSOR, seed=1, kinds=KINDS, **terms):
    """Return frames to fit, drawn from a model with terms."""
    captures = [capture_of(kind, n) for n, kind in enumerate(kinds)]
    return drawn(frames_of(sensor, captures), model_of(sensor, **terms), seed)


def unfounded(model, **intervals):
    """Return why the only effect of a model may not be named.

    intervals : of its parameters; the values of others lie far from 0."""
    (term,) = model.terms
    parameters = {
        name: Estimate(1.0, "1", intervals.get(name, (0.9, 1.1)))
        for name in term.effect.parameters
    }
    return acceptance._unfounded(model, term, {term.name: parameters})


@pytest.mark.parametrize(
    ("low", "high", "named"),
    [(0.1, 0.3, True), (-0.3, -0.1, True), (-0.1, 0.3, False), (0.0, 0.2, False)],
)
def test_a_name_needs_an_interval_without_its_null(low, high, named):
    model = model_of(SENSOR, exposure=[0.1])
    assert (unfounded(model, gain=(low, high)) == "") == named


def test_one_parameter_beyond_its_null_is_enough():
    model = model_of(SENSOR, lens_shading=[-0.2, 0, 0, 0, 0, 0, 0])
    wide = {name: (-9.0, 9.0) for name in BY_NAME["lens_shading"].parameters}
    assert "holds r2 0 and r4 0" in unfounded(model, **wide)
    assert unfounded(model, **{**wide, "r2": (-0.3, -0.1)}) == ""


def test_tails_are_there_by_their_share_alone():
    """A ratio is far from 0 of its nature."""
    model = model_of(SENSOR, heavy_tailed_noise=[0.01, 9.0])
    reason = unfounded(model, fraction=(-0.0019, 0.0021), variance_ratio=(5.0, 13.0))
    assert reason == "its 95 % interval holds fraction 0"


BOUNDS = [
    ({"read_noise": [3.0]}, "log_variance is 3,"),
    ({"read_noise": [-2.5]}, "log_variance is -2.5,"),
    ({"heavy_tailed_noise": [0.01, 80.0]}, "variance_ratio is 80,"),
    ({"heavy_tailed_noise": [0.01, 1.1]}, "variance_ratio is 1.1,"),
    ({"row_noise": [4.0]}, "sigma is 4,"),
    ({"noise_reduction": [0.0, 0.1]}, ""),  # a bound that is the null
    ({"exposure": [0.1]}, ""),
    ({"read_noise": [2.99]}, ""),
]


@pytest.mark.parametrize(("terms", "said"), BOUNDS, ids=str)
def test_a_parameter_where_the_search_ends_is_no_finding(terms, said):
    reason = unfounded(model_of(SENSOR, **terms))
    assert reason.startswith(said) and bool(reason) == bool(said)


def test_the_bounds_of_the_registry_count_with_what_the_profile_has():
    listed = [{"name": "exposure", "parameters": {"gain": 0.5}}]
    sensor = sensor_of(effects=listed)
    low, high = BY_NAME["exposure"].low[0], BY_NAME["exposure"].high[0]
    assert unfounded(model_of(sensor, exposure=[(high - 0.5) / 2])) == ""
    reason = unfounded(model_of(sensor, exposure=[high - 0.25]))
    assert reason.startswith(f"gain is {high:g} together with the profile's")
    assert low < 0 < high


def test_what_is_not_founded_is_left_out_and_the_rest_fitted_again():
    frames = frames_with(exposure=[0.05])
    model = model_of(SENSOR, exposure=[0.02], gr_gb_imbalance=[1e-5, 0.0])
    left, values, refused = founded(model, on(frames))
    assert left.names == ["exposure"] and set(values) == {"exposure"}
    assert refused["gr_gb_imbalance"].startswith("its 95 % interval holds")
    assert left.terms[0].values[0] == pytest.approx(0.05, abs=0.002)
    (note,) = acceptance.refusals(refused)
    assert note.startswith("Gr/Gb imbalance is not named, though it was")


@pytest.mark.parametrize(
    ("gain", "better"), [(CONFIRMING_GAIN + 0.1, True), (2.9, False), (-100.0, False)]
)
def test_whole_held_out_frames_must_be_more_likely(gain, better):
    before, after = Sums(log_likelihood=-5e6), Sums(log_likelihood=-5e6 + gain)
    assert is_better(before, after) == better
    said = acceptance.not_better(["exposure"], before, after)
    assert f"{'more' if gain > 0 else 'less'} likely by {abs(gain):.1f} nats" in said


def test_by_chance_one_model_in_twenty_at_most_is_better():
    """A term at a value that is not fitted, of what the frames do not have."""
    frames = frames_with(seed=3)
    sums = {}
    for gain in (0.0, *np.linspace(-3e-3, 3e-3, 40)):
        sums[gain] = Sums()
        for frame in frames:
            sums[gain].add(model_of(SENSOR, exposure=[gain]), frame)
    better = [is_better(sums[0.0], one) for gain, one in sums.items() if gain]
    assert np.mean(better) <= 0.05


def misled(monkeypatch, **terms):
    """Let the search end with terms that the frames do not have."""

    def search(self):
        model = self.baseline.model
        self.steps += [Step("added", name, 99.0, 99.0) for name in terms]
        for name, values in terms.items():
            model = model.with_term(model_of(SENSOR, **{name: values}).terms[0])
        return model

    monkeypatch.setattr(Search, "run", search)
    # What is fitted again would be right again.
    monkeypatch.setattr(acceptance, "fit", lambda model, *_: model)


def test_a_model_that_is_worse_is_no_finding_and_no_profile(monkeypatch):
    misled(monkeypatch, exposure=[-0.144])
    found = run(set_of(SENSOR))
    assert (found.verdict, found.effects, found.profile_json) == ("consistent", [], "")
    assert found.gap.chi2_after == found.gap.chi2_before
    (note,) = [note for note in found.notes if note.startswith("Not confirmed")]
    assert "with exposure the report frames, whole, are less likely by" in note
    found = run(set_of(SENSOR, model=model_of(SENSOR, exposure=[0.05])))
    assert (found.verdict, found.profile_json) == ("unexplained", "")


def set_of_darks(**terms):
    """Return a set of darks of two times."""
    captures = [
        capture_of("dark", n, name=f"dark{n}", set=f"d{n}", group=GROUPS[n % 3],
                   exposure_time=1.0 + 60 * (n // 6), shape=(64, 96))
        for n in range(12)
    ]  # fmt: skip
    return shown_set(SENSOR, captures, 5, model=model_of(SENSOR, **terms))


@pytest.mark.slow
def test_effects_of_light_are_not_named_of_darks():
    """A map that grows with the charge of the dark current looks like PRNU."""
    found = run(set_of_darks(dark_current=[2e-3]), only=())
    assert [effect.name for effect in found.effects] == ["dark_current"]
    cannot = {limit.name for limit in found.detection_limits if limit.strength is None}
    assert {"prnu", "shot_noise", "exposure", "lens_shading", "blur"} <= cannot
    assert "row_noise" not in cannot


@pytest.mark.parametrize("kinds", [("dark",), ("dark", "flat")])
def test_without_an_image_nothing_of_images_is_looked_for(kinds):
    captures = set_of(SENSOR).captures
    kept = CaptureSet(SENSOR, [c for c in captures if c.kind in kinds])
    found = run(kept, only=("blur", "color_matrix", "exposure", "read_noise"))
    cannot = {limit.name for limit in found.detection_limits if limit.strength is None}
    assert {"blur", "color_matrix"} <= cannot
    assert ("exposure" in cannot) == ("flat" not in kinds)


TESTS = [  # p, nats per pixel, nats per pixel that were closed, whether it counts
    (1e-9, 5e-4, 0.0, True),
    (1e-9, 5e-4, 1.0, False),  # a trace of a large effect
    (1e-9, 1.1e-3, 1.0, True),  # however large
    (1e-9, 0.1, 120.0, True),
    (5e-5, 1.1e-3, 0.0, True),
    (2e-4, 1.1e-3, 0.0, False),
    (1e-9, 1e-4, 0.0, False),
]


@pytest.mark.parametrize(("p", "nats", "closed", "counts"), TESTS, ids=str)
def test_what_is_left_counts_in_absolute_terms(p, nats, closed, counts):
    quiet = [ResidualTest(f"quiet {n}", 0.0, 0.5, 0.0, "") for n in range(35)]
    test = ResidualTest("loud", 9.0, p, nats, "")
    assert left_over([*quiet, test], closed) == ([test] if counts else [])


@pytest.mark.parametrize("factor", [0.93, 1.0, 1.07])
def test_chi_square_of_whole_frames_is_near_1_on_both_sides(factor):
    """Read noise is all of a dark's variance, and nobody may name it here."""
    model = model_of(SENSOR, read_noise=[np.log(factor)])
    captures = [
        capture_of("dark", n, name=f"d{n}", set=f"d{n}", group=GROUPS[n % 3],
                   shape=(128, 192))
        for n in range(6)
    ]  # fmt: skip
    found = run(shown_set(SENSOR, captures, 5, model=model), only=("black_level",))
    chi_square = [t for t in found.unexplained if t.name == CHI_SQUARE_NAME]
    assert len(chi_square) == (factor != 1.0)
    assert (found.verdict == "consistent") == (factor == 1.0)
    if chi_square:
        assert chi_square[0].statistic == pytest.approx(factor, abs=0.02)
        assert ("smaller" in chi_square[0].where) == (factor < 1)


def test_workers_begin_nothing_after_the_deadline():
    workers = Workers(2, time.monotonic() - 1)
    with pytest.raises(TimeIsUp):
        workers.map(str, [1])
    workers.deadline = None
    assert workers.map(str, [1]) == ["1"]


def test_a_time_limit_of_nothing_still_reports():
    found = run(set_of(SENSOR, model=model_of(SENSOR, exposure=[0.05])), time_limit=0.0)
    assert found.time_limit_reached and not found.interrupted
    assert (found.verdict, found.effects) == ("incomplete", [])
    assert not [limit for limit in found.detection_limits if limit.strength is not None]
    found = run(set_of(SENSOR), time_limit=0.0)  # nothing was looked at
    assert found.verdict == "incomplete"


def test_a_time_limit_keeps_what_was_found_until_then(monkeypatch):
    """An effect that was accepted counts, even if the time ends while it is settled."""
    true = model_of(SENSOR, exposure=[0.05], read_noise=[0.5])
    settled = []

    def late(self, model, newest):
        settled.append(newest)
        raise TimeIsUp

    monkeypatch.setattr(Search, "_settled", late)
    found = run(set_of(SENSOR, model=true), time_limit=1000.0)
    assert found.time_limit_reached and len(settled) == 1
    assert [effect.name for effect in found.effects] == settled
    assert found.verdict == "incomplete"
    assert [rung.name for rung in found.ladder] == settled


def test_why_a_name_was_taken_is_told():
    true = model_of(SENSOR, exposure=[0.05])
    found = run(set_of(SENSOR, model=true))
    (effect,) = found.effects
    assert effect.rule == "It gains most on the held-out frames."
    assert found.ladder[0].rule == effect.rule


def test_a_search_that_was_not_misled_is_believed():
    found = run(set_of(SENSOR, model=model_of(SENSOR, exposure=[0.05])))
    assert found.verdict == "explained" and found.profile_json
