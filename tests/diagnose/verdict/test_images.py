# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What images say: the noise of a profile without any, and limits of what is none."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.frames.noise_model import NoiseModel
from cg2raw.diagnose.scenes.gram import Gram, Space
from cg2raw.diagnose.verdict.images import (
    _findings,
    _gap,
    _limits,
    _notes,
    _values,
    noise_row,
)
from diagnose.planted import BY_NAME, bare, model_of, sensor_of


def test_a_profile_without_noise_gets_that_of_its_first_iso():
    """With what the images found to multiply it; one number stands for all sites."""
    frames = [
        SimpleNamespace(
            noise=NoiseModel((beta1,), (1e-3 * beta1,), measured=False),
            capture=SimpleNamespace(iso=iso),
        )
        for iso, beta1 in ((None, 3e-4), (400.0, 4e-4), (100.0, 1e-4))
    ]
    found = SimpleNamespace(
        views=[SimpleNamespace(frame=frame) for frame in frames],
        capture_set=SimpleNamespace(sensor=bare(sensor_of())),
        model=model_of(sensor_of(), shot_noise=[np.log(2)]),
    )
    assert noise_row(found) == {
        "iso": 400.0,
        "beta1": pytest.approx([8e-4] * 4),
        "beta2": pytest.approx([4e-7] * 4),
    }
    found.views = found.views[:1]
    assert noise_row(found) is None


def test_the_gap_of_images_is_half_of_what_their_chi_square_has_beyond_one():
    """In nats per pixel: before, and less twice what the values gain after. Flicker was
    taken off the squares, which it had before."""
    gram = Gram(100, 280.0, np.array([10.0, 10.0]), np.eye(2))
    gap = _gap(
        SimpleNamespace(
            grams={"report": gram},
            of_flicker=20.0,
            theta=np.array([10.0, 5.0]),  # gain 150 - 125 / 2 nats
            model=model_of(sensor_of()),
            views=[],
        )
    )
    assert (gap.chi2_before, gap.chi2_after) == pytest.approx((3.0, 1.05))
    assert (gap.before, gap.after) == pytest.approx((1.0, 0.025))
    low, high = gap.interval_after
    assert (high - low) / 2 == pytest.approx(1.96 * 0.005**0.5, rel=1e-3)


@pytest.mark.parametrize(("squares", "wider"), [(500.0, 2.0), (150.0, 1.0)])
def test_intervals_are_wider_where_the_residuals_are(squares, wider):
    """By the root of their chi-square, and never narrower. The value gains 50 nats."""
    gram = Gram(100, squares, np.array([1e3]), np.array([[1e4]]))
    found = SimpleNamespace(
        both=gram,
        theta=np.array([0.1]),
        effects=[BY_NAME["exposure"]],
        space=Space.of({"exposure": 1}),
        fitted={"exposure"},
        chosen=SimpleNamespace(names=["exposure"]),
        shapes={},
    )
    one = _values(found)["exposure"]["gain"]
    half = 1.96 * wider / 100
    assert (one.value, *one.ci95) == pytest.approx(
        (0.1, 0.1 - half, 0.1 + half), rel=1e-3
    )


def test_a_limit_beyond_what_an_effect_may_be_is_none():
    """Of 8 px from end to end: chromatic aberration of hundreds is not shown."""
    names = ["exposure", "lateral_chromatic_aberration"]
    effects = [BY_NAME[name] for name in names]
    space = Space.of({one.name: len(one.used) for one in effects})

    def shown(aberration):
        information = np.full(space.size, aberration)
        information[0] = 1e6
        gram = Gram(100, 100.0, np.zeros(space.size), np.diag(information))
        found = SimpleNamespace(
            grams={"select": gram},
            chosen=SimpleNamespace(names=[]),
            shapes={},
            candidates=names,
            space=space,
            fitted=set(),
            least=8.0,
            effects=effects,
            least_flicker=np.inf,
            names=set(names),
        )
        return [one.name for one in _limits(found)]

    assert shown(1e4) == names
    assert shown(1e-4) == ["exposure"]


def scenes(nats, alike):
    """Return what images found. nats : of each name. alike : {name: sets of names}."""
    return SimpleNamespace(
        chosen=SimpleNamespace(nats=nats, alike=alike, instead={}),
        nats={},
        capture_set=SimpleNamespace(
            sensor=sensor_of(), nuisances={"light", "exposure"}
        ),
        model=model_of(sensor_of()),
    )


@pytest.mark.parametrize(
    ("blur", "alike", "names"),
    [
        (10.1, {}, ["lens_distortion", "blur"]),
        (9.9, {}, ["lens_distortion"]),  # below 1 % of the other's
        (30.0, {"blur": [["veiling_glare"]]}, ["lens_distortion", "blur"]),
    ],
)
def test_what_takes_up_the_rest_of_another_model_is_no_finding(blur, alike, names):
    nats = {"blur": blur, "lens_distortion": 1000.0}
    values = {name: {} for name in nats}
    findings, notes = _findings(scenes(nats, alike), values, False)
    assert [one.name for one in findings] == names
    if "blur" in names:
        assert findings[1].ambiguous_with == [one for [one] in alike.get("blur", ())]
    else:
        [note] = notes
        assert note.startswith(
            "Lens blur takes up what the model of lens distortion does"
        )
        assert "(1.0% of its gain)" in note


def test_what_stands_behind_such_a_name_is_a_finding_all_the_same():
    nats = {"lens_distortion": 1000.0, "blur": 9.9, "prnu": 9.0}
    findings, _ = _findings(scenes(nats, {}), {name: {} for name in nats}, False)
    assert [one.name for one in findings] == ["lens_distortion", "prnu"]


def test_names_that_others_explain_together_are_said():
    free, note = _notes(scenes({}, {"blur": [["veiling_glare", "exposure"], ["prnu"]]}))
    assert free == "Free nuisances, which are not effects: exposure, light."
    assert note.startswith("Lens blur explains as much as veiling glare with exposure")
