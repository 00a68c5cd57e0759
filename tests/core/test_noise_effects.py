# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A profile says what draws the noise of its ISOs: how it is read and written, and
that runs that do not say otherwise are drawn so."""

import json

import numpy as np
import pytest

import cg2raw
from oracles import cameras

ROW = {"iso": 100, "beta1": [2e-3, 1e-3, 1.5e-3, 3e-3], "beta2": [4e-6] * 4}
SHAPED = {**ROW, "tukey_lambda": 0.14, "row_sigma": 0.0}
OUTLIERS = {"outlier_fraction": 0.01, "outlier_variance_ratio": 20.0}
HEAVY = {**SHAPED, **OUTLIERS}
PHYSICAL = ["poisson_shot_noise", "heavy_tailed_noise"]
GAUSSIAN = ["shot_noise", "read_noise"]


def sensor_of(noise, drawn=None, effects=()):
    fields = {"noise": noise, "effects": list(effects), "noise_effects": drawn}
    return cg2raw.Sensor.from_json(cameras.profile_text(**fields), "inline.json")


def signal(sensor, level=0.1, **run):
    rgb = np.full((40, 60, 3), level, np.float32)
    run = {"iso": 100, "seed": 2, **run}
    return np.asarray(sensor.signal(rgb, illuminant="A", camera_input=True, **run))


@pytest.mark.parametrize("of_light", ["shot_noise", "poisson_shot_noise"])
@pytest.mark.parametrize("of_readout", ["read_noise", "heavy_tailed_noise"])
def test_they_survive_a_round_trip(of_light, of_readout):
    rows = [HEAVY, {**HEAVY, "iso": 200, "outlier_fraction": 0.0}]
    sensor = sensor_of(rows, [of_light, of_readout])
    once = sensor.to_json()
    assert sensor.noise_effects == [of_light, of_readout]
    assert json.loads(once)["noise_effects"] == [of_light, of_readout]
    assert json.loads(once)["noise"] == rows
    assert cg2raw.Sensor.from_json(once).to_json() == once


def test_a_profile_that_does_not_say_stays_as_it_is():
    sensor = sensor_of([ROW])
    assert sensor.noise_effects == GAUSSIAN
    assert "noise_effects" not in json.loads(sensor.to_json())


ALLOWED = "shot_noise or poisson_shot_noise, then read_noise or heavy_tailed_noise"
WRONG = [
    ([], ALLOWED),
    (["shot_noise"], ALLOWED),
    (["read_noise", "shot_noise"], rf"\[read_noise, shot_noise\].*{ALLOWED}"),
    (["shot_noise", "row_noise"], ALLOWED),
    (["shot_noise", "poisson_shot_noise"], ALLOWED),
    (["shot_noise", "read_noise", "row_noise"], ALLOWED),
    ("shot_noise", "list of texts"),
    ({"shot_noise": 1}, "list of texts"),
    (["shot_noise", 1], "list of texts"),
]


@pytest.mark.parametrize(("drawn", "says"), WRONG)
def test_wrong_names_say_what_is_allowed(drawn, says):
    with pytest.raises(ValueError, match=rf"^inline.json: noise_effects .*{says}"):
        sensor_of([HEAVY], drawn)


def test_heavy_tails_need_a_shape():
    with pytest.raises(
        ValueError,
        match="^inline.json: noise_effects: heavy_tailed_noise needs tukey_lambda and "
        "row_sigma.*read_noise$",
    ):
        sensor_of([ROW], ["shot_noise", "heavy_tailed_noise"])


WRONG_ROWS = [
    ({"outlier_fraction": 0.1}, "outlier_variance_ratio.*missing"),
    ({"outlier_variance_ratio": 2.0}, "outlier_fraction.*missing"),
    ({"outlier_fraction": -0.1}, "outlier_fraction -0.1 must be within 0 to 0.5"),
    ({"outlier_fraction": 0.51}, "outlier_fraction 0.51 must be within 0 to 0.5"),
    ({"outlier_variance_ratio": 0.9}, "outlier_variance_ratio 0.9.*1 to 100"),
    ({"outlier_variance_ratio": 101}, "outlier_variance_ratio 101.*1 to 100"),
    ({"outlier_fraction": "x"}, "outlier_fraction.*number"),
]


@pytest.mark.parametrize(("wrong", "says"), WRONG_ROWS)
def test_outliers_out_of_bounds_are_named(wrong, says):
    known = OUTLIERS if "missing" not in says else {}
    with pytest.raises(ValueError, match=rf"^inline.json: noise.*{says}"):
        sensor_of([{**SHAPED, **known, **wrong}])


def test_outliers_come_with_a_shape_and_in_all_rows():
    with pytest.raises(ValueError, match="tukey_lambda.*missing"):
        sensor_of([{**ROW, **OUTLIERS}])
    pair = "iso 200: outlier_fraction and outlier_variance_ratio are"
    with pytest.raises(ValueError, match=f"{pair} missing: all rows.*or none"):
        sensor_of([HEAVY, {**SHAPED, "iso": 200}])
    with pytest.raises(ValueError, match=f"{pair} given: all rows.*or none"):
        sensor_of([SHAPED, {**HEAVY, "iso": 200}])


@pytest.mark.parametrize(
    ("iso", "fraction", "ratio"),
    [
        (50, 0.01, 20),
        (100, 0.01, 20),
        (200, 0.02, 15),
        (400, 0.03, 10),
        (800, 0.03, 10),
    ],
)
def test_outliers_between_isos(iso, fraction, ratio):
    """Linear in log ISO, held outside."""
    other = {"outlier_fraction": 0.03, "outlier_variance_ratio": 10.0}
    seen = sensor_of([HEAVY, {**HEAVY, **other, "iso": 400}]).noise_at(iso)
    assert seen["outlier_fraction"] == pytest.approx(fraction, rel=1e-12)
    assert seen["outlier_variance_ratio"] == pytest.approx(ratio, rel=1e-12)
    assert seen["tukey_lambda"] == 0.14, "the core stays normal"


def test_a_run_that_does_not_say_is_drawn_as_the_profile_says():
    plain, heavy = sensor_of([HEAVY]), sensor_of([HEAVY], PHYSICAL)
    assert (signal(heavy) == signal(plain, noise="physical")).all()
    assert (signal(heavy, noise="gaussian") == signal(plain)).all()
    assert (signal(plain) == signal(plain, noise="gaussian")).all()
    assert (signal(plain) == signal(sensor_of([HEAVY], GAUSSIAN))).all()
    assert (signal(heavy) != signal(plain)).mean() > 0.9


def test_each_of_the_two_is_drawn_by_what_is_named():
    """In the dark there is only that of the read-out; without it, that of light."""
    mixed = [
        ("shot_noise", "heavy_tailed_noise"),
        ("poisson_shot_noise", "read_noise"),
    ]
    dark = {names[1]: signal(sensor_of([HEAVY], names), 0.0) for names in mixed}
    plain = sensor_of([HEAVY])
    assert (dark["read_noise"] == signal(plain, 0.0)).all()
    assert (dark["heavy_tailed_noise"] == signal(plain, 0.0, noise="physical")).all()
    quiet = [{**ROW, "beta2": [0.0] * 4}]
    electrons = signal(sensor_of(quiet, ["poisson_shot_noise", "read_noise"]))
    sites = electrons[::2, ::2] / ROW["beta1"][0]
    assert np.abs(sites - np.rint(sites)).max() < 1e-3, "whole electrons"


def test_noise_of_rows_comes_with_heavy_tails():
    banded = {**HEAVY, "row_sigma": 1.5e-3}
    of_light = "shot_noise"

    def row_means(drawn):
        return signal(sensor_of([banded], [of_light, drawn]), 0.0).mean(axis=1).std()

    assert row_means("heavy_tailed_noise") > 3.0 * row_means("read_noise")
    rows = {"name": "row_noise", "parameters": {"sigma": 1e-3}}
    with pytest.raises(ValueError, match="row_noise would act twice"):
        signal(sensor_of([banded], PHYSICAL, [rows]))
    without = sensor_of([HEAVY], PHYSICAL, [rows])
    means = signal(without, 0.0).mean(axis=1).std()
    assert means > 3.0 * signal(sensor_of([HEAVY], PHYSICAL), 0.0).mean(axis=1).std()


def test_the_predicted_variance_is_that_of_the_table():
    rows = {**HEAVY, "row_sigma": 1.5e-3}
    rgb = np.full((40, 60, 3), 0.1, np.float32)
    run = {"illuminant": "A", "camera_input": True, "iso": 100}
    gaussian, heavy = (
        sensor_of([rows], drawn).predict(rgb, **run) for drawn in (None, PHYSICAL)
    )
    assert (gaussian[0] == heavy[0]).all()
    assert heavy[1] == pytest.approx(gaussian[1], rel=1e-5)


def test_a_larger_cfa_has_outliers_too():
    rows = {**HEAVY, "beta1": 0.0, "beta2": [1e-6, 4e-6, 9e-6]}
    fields = {"cfa": cameras.X_TRANS, "noise": [rows], "noise_effects": PHYSICAL}
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(**fields))
    rgb = np.zeros((1200, 1200, 3), np.float32)
    run = {"illuminant": "A", "camera_input": True, "iso": 100}
    dark = np.asarray(sensor.signal(rgb, **run), float)
    for letter, variance in zip("RGB", rows["beta2"], strict=True):
        sites = np.array([c == letter for c in cameras.X_TRANS]).reshape(6, 6)
        seen = dark[np.tile(sites, (200, 200))]
        # Kurtosis of this mixture: 3 (0.99 + 0.01 20^2) / 1.19^2 = 10.6.
        error = np.sqrt((10.6 - 1.0) / seen.size)
        assert seen.var() == pytest.approx(variance, rel=4.0 * error)
        assert np.mean(seen**4) / seen.var() ** 2 == pytest.approx(10.6, rel=0.1)


def test_noise_added_to_an_array_is_drawn_so():
    heavy, clean = sensor_of([HEAVY], PHYSICAL), np.full((40, 60), 0.1, np.float32)
    seen = heavy.add_noise(clean, iso=100, seed=2)
    assert (seen == signal(heavy)).all()
