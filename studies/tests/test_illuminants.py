# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies.illuminants: its models, measures, and the page it is on."""

import re

import numpy as np
import pytest

from oracles import cameras

pytest.importorskip("scipy", reason="scipy is not installed")
PAGE = "docs/illuminants.md"


@pytest.fixture(scope="module")
def study():
    """The modules (study, models) of the command."""
    from studies.illuminants import models, study

    return study, models


def planted(count=150):
    """(count, 2) neutrals of a made-up camera: bent, as real ones are."""
    rng = np.random.default_rng(3)
    red = rng.uniform(0.4, 1.0, count)
    return np.column_stack([red, 0.3 / red + 0.03 * rng.standard_normal(count)])


@pytest.fixture(scope="module")
def densities(study):
    """[(model, cell, values)]: each model's density on a grid, and the grid's cell."""
    side = np.linspace(0.15, 1.1, 600)
    grid = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    models = study[1].fitted_models(planted(), "planted", 0)
    return [(model, (side[1] - side[0]) ** 2, model.density(grid)) for model in models]


def test_every_density_integrates_to_one_where_its_draws_lie(densities):
    for model, cell, values in densities:
        # The support's edges cross cells; the smallest is some 70 cells wide.
        assert values.sum() * cell == pytest.approx(1.0, abs=0.03)
        draws = model.draws(50, 4)
        assert draws.shape == (50, 2) and (model.density(draws) > 0.0).all()


def test_draws_follow_their_density(densities):
    for model, cell, values in densities:
        draws = np.concatenate([model.draws(500, split) for split in range(8)])
        # The mean of 1 / density over draws is the area of the support.
        area = np.mean(1.0 / model.density(draws))
        assert area == pytest.approx((values > 0.0).sum() * cell, rel=0.1)


def test_mass_inside_a_hull_is_that_of_many_draws(study):
    mean, covariance = np.array([0.6, 0.5]), np.array([[0.03, -0.02], [-0.02, 0.02]])
    hull = np.array([[0.4, 0.7], [0.5, 0.4], [0.9, 0.2], [0.8, 0.5]])
    mass = study[1].mass_inside(mean, covariance, hull)
    drawn = np.random.default_rng(1).multivariate_normal(mean, covariance, 200000)
    assert mass == pytest.approx(study[1].is_inside(drawn, hull).mean(), abs=5e-3)
    far = mean + 100.0 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    assert study[1].mass_inside(mean, covariance, far) == pytest.approx(1.0, abs=1e-6)


def test_the_angle_is_that_to_the_nearest_draw(study):
    neutrals = np.array([[1.0, 1.0], [0.5, 0.5]])
    draws = np.array([[1.0, 1.0], [1.0, 0.0]])
    expected = [0.0, np.degrees(np.arccos(2.0 / np.sqrt(1.5 * 3.0)))]
    assert study[0].nearest_angle(neutrals, draws) == pytest.approx(expected, abs=2e-6)


def test_halves_are_disjoint_complete_and_differ(study):
    fitted, held = study[1].halves(planted(117), 0, 1)
    assert sorted([*fitted, *held]) == list(range(117)) and len(fitted) == 59
    assert set(fitted) != set(study[1].halves(planted(117), 0, 2)[0])


def test_a_lead_is_negative_where_the_box_is_the_truth(study):
    """The study can find against us: on neutrals that are uniform over a box."""
    neutrals = np.random.default_rng(8).uniform(0.4, 0.8, (200, 2))
    _, density = study[0].measured(neutrals, "planted", 0, splits=10)
    log = study[0].log_likelihood(density)
    mean, error = study[0].lead(log[:, 0] - log[:, 2])
    assert mean < -2.0 * error


def rows_of(text):
    """Cells of the rows of each table that name one of the nine cameras first."""
    lines = [line.strip("| ").split(" | ") for line in text.splitlines() if "|" in line]
    return [line for line in lines if line[0] in cameras.NINE]


def test_the_page_says_that_cg2raw_leads_on_all_nine(repository):
    rows = rows_of((repository / PAGE).read_text())
    assert [row[0] for row in rows] == 3 * sorted(cameras.NINE)
    for row in rows[:18]:
        leads = [float(re.match(r"-?[\d.]+", cell)[0]) for cell in row if "(" in cell]
        assert len(leads) == 2 and min(leads) > 0.0, row
    for camera, _, ours, gains, box, *_ in rows[:9]:
        assert float(ours) < min(float(gains), float(box)), camera
    for camera, ours, gains, box, *_ in rows[9:18]:
        assert float(ours) > max(float(gains), float(box)), camera


def test_the_page_says_that_a_mixture_gains_on_all_nine(repository):
    for camera, _, gain, _ in rows_of((repository / PAGE).read_text())[18:]:
        mean, error = map(float, re.findall(r"[\d.]+", gain))
        assert mean > 3.0 * error, camera


def test_the_mixture_s_density_is_that_of_its_draws(study):
    from studies.illuminants.mixture import SensorMixture

    side = np.linspace(0.15, 1.1, 300)
    grid = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    model, cell = SensorMixture(planted(), "planted"), (side[1] - side[0]) ** 2
    assert model.density(grid).sum() * cell == pytest.approx(1.0, abs=0.03)
    draws = np.concatenate([model.draws(500, split) for split in range(8)])
    area = np.mean(1.0 / model.density(draws))
    assert area == pytest.approx((model.density(grid) > 0.0).sum() * cell, rel=0.2)


def test_the_figure_of_the_page_is_there_and_small(repository):
    assert "(images/illuminants.png)" in (repository / PAGE).read_text()
    size = (repository / "docs/images/illuminants.png").stat().st_size
    assert 10_000 < size < 400_000


def test_a_missing_table_is_one_line(study, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["study", "--data", str(tmp_path)])
    assert study[0].main() == 1
    out, err = capsys.readouterr()
    assert "nus9_gt_illuminants.csv" in err and "--data" in err
    assert (out, err.count("\n")) == ("", 1)


@pytest.mark.slow
def test_the_page_is_what_the_command_prints(
    run_module, repository, camera_data, tmp_path
):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    figure = tmp_path / "figure.png"
    done = run_module("illuminants.study", "--data", camera_data, "--figure", figure)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() in (repository / PAGE).read_text()
    assert figure.read_bytes().startswith(b"\x89PNG")
