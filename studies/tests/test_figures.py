# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Figures show what was planted: lines, bars and pixels, the same bytes each time."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from studies.figures import errors_by_light, gap_bars
from studies.figures.contact_sheet import LABELS, contact_sheet, scene_pictures
from studies.figures.isp_examples import GOAL, INPUT, SHOWN, Examples, isp_examples
from studies.figures.isp_panels import MEANS, TITLES, isp_panels
from studies.figures.night_examples import night_examples
from studies.figures.styles import styles
from studies.figures.tiles import GAP, SCALE
from studies.figures.translation_curves import curves_in, translation_curves
from studies.sources.exposures import by_exposure
from studies.sources.sets import Draw, material
from studies.tables_of_results import ready
from tiers import slow

STUDIES = ("illuminant", "isp", "denoising")


@pytest.fixture(scope="module")
def entries(planted):
    """Return {study: {camera: entry}}."""
    return {study: ready(planted.summaries, study) for study in STUDIES}


@pytest.fixture
def drawn_on(monkeypatch):
    """Return drawn_on(module, make, *arguments): the figure before it is a PNG."""

    def run(module, make, *arguments):
        figure = Figure()
        monkeypatch.setattr(
            module, "drawn", lambda height, draw, *_, **__: draw(figure)
        )
        make(*arguments)
        return figure

    return run


def pixels(png):
    """Return (H, W, 3) of a PNG."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def colors(png):
    """Return how many colours a PNG has."""
    return len(np.unique(pixels(png).astype(int) @ (65536, 256, 1)))


def test_no_two_sources_look_alike(planted):
    found = styles([*planted.gaps, "something else"])
    assert len(set(found.values())) == len(planted.gaps) + 1


def test_errors_by_light_are_the_means_and_leds_stand_apart(planted, drawn_on):
    errors = planted.summaries["illuminant"]["cameras"]["sony-a7s-ii"]
    lights = ("below 3000 K", "above 3000 K", "LED lamps")
    with_leds = {of: {"sony-a7s-ii": errors} for of in lights}
    without = {"LED lamps": {"sony-a7s-ii": {"upi, match": errors["upi, match"]}}}
    figure = drawn_on(
        errors_by_light, errors_by_light.errors_by_light, with_leds, without
    )
    (axes,) = figure.axes
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == list(errors)
    drawn = [bars.lines[0].get_ydata() for bars in axes.containers]
    assert [len(values) for values in drawn] == [2, 1] * (len(errors) - 1) + [2, 1, 1]
    assert axes.get_xticklabels()[-1].get_text() == "no LEDs in training"
    for bars, source in zip(axes.containers[::2], errors, strict=False):
        mean = np.mean(errors[source]["frames"])
        assert bars.lines[0].get_ydata() == pytest.approx(mean, abs=1e-4)


def test_a_camera_without_frames_of_a_light_has_the_others(planted, drawn_on):
    errors = planted.summaries["illuminant"]["cameras"]
    few = {"nikon-d850": errors["nikon-d850"]}
    with_leds = {"below 3000 K": few, "LED lamps": errors}
    figure = drawn_on(errors_by_light, errors_by_light.errors_by_light, with_leds, {})
    shown = {
        axes.get_title(): [label.get_text() for label in axes.get_xticklabels()]
        for axes in figure.axes
    }
    assert shown == {
        "nikon-d850": ["below 3000", "LED lamps"],
        "sony-a7s-ii": ["LED lamps"],
    }


def test_bars_are_the_gaps_that_were_planted(entries, planted, drawn_on):
    """More is worse in each row, also of PSNR."""
    figure = drawn_on(gap_bars, gap_bars.gap_bars, entries)
    titles = [part._suptitle.get_text() for part in figure.subfigs]
    assert titles == [
        "illuminant",
        *(f"isp, {goal}" for goal in planted.goals),
        *(f"denoising, {c}" for c in planted.conditions),
    ]
    for part in figure.subfigs:
        assert [axes.get_title() for axes in part.axes] == list(sorted(planted.cameras))
        names = [label.get_text() for label in part.axes[0].get_yticklabels()]
        assert sorted(names) == sorted(set(planted.sources) - {"real"})
        for axes in part.axes:
            assert [bar.get_width() for bar in axes.patches] == pytest.approx(
                [planted.gaps[name] for name in names], abs=1e-4
            )
            assert axes.yaxis_inverted()


def test_a_study_of_one_camera_leaves_a_panel_empty(entries, drawn_on):
    camera, entry = next(iter(entries["isp"].items()))
    both = {"illuminant": entries["illuminant"], "isp": {camera: entry}}
    figure = drawn_on(gap_bars, gap_bars.gap_bars, both)
    assert [len(axes.patches) for axes in figure.subfigs[1].axes] == [11, 0]


@pytest.mark.parametrize(
    ("make", "rest"),
    [(errors_by_light.errors_by_light, ({},)), slow(gap_bars.gap_bars, ())],
)
def test_figures_are_not_blank_and_the_same_bytes_twice(make, rest, entries):
    found = {"illuminant": entries["illuminant"]}
    png = make(found, *rest)
    assert png.startswith(b"\x89PNG") and colors(png) > 40
    assert b"Software" not in png and b"Creation" not in png
    assert make(found, *rest) == png


def noise(seed, count):
    """Return pictures (count, 12, 16, 3) that no drawing would make."""
    return np.random.default_rng(seed).random((count, 12, 16, 3)).astype(np.float32)


def assert_shows(png, picture, left, top):
    """A picture is there, each pixel SCALE times each side."""
    height, width = (SCALE * size for size in picture.shape[:2])
    found = pixels(png)[top : top + height, left : left + width] / 255.0
    large = picture.repeat(SCALE, axis=0).repeat(SCALE, axis=1)
    assert np.abs(found - large).max() < 1.5 / 255.0


def test_panels_show_each_picture_and_map():
    pictures = {name: noise(seed, 2) for seed, name in enumerate((GOAL, INPUT, "real"))}
    flat = np.stack([np.zeros((12, 16)), np.full((12, 16), 10.0)])
    found = Examples("a camera", pictures, {INPUT: flat, "real": flat})
    png = isp_panels(found)
    across, down = SCALE * 16 + GAP, SCALE * 12
    for column, picture in enumerate(pictures.values()):
        assert_shows(png, picture[0], column * across, TITLES)
    dark = np.zeros((12, 16, 1)) + (0.267, 0.005, 0.329)  # viridis at 0
    assert_shows(png, dark, across, TITLES + down + MEANS)
    assert isp_panels(found) == png


def test_a_contact_sheet_shows_each_picture():
    pictures = {"a": noise(1, 3), "b": noise(2, 3)}
    png = contact_sheet(pictures)
    for line, row in enumerate(pictures.values()):
        for column, picture in enumerate(row):
            left = LABELS + column * (SCALE * 16 + GAP)
            assert_shows(png, picture, left, line * (SCALE * 12 + GAP))
    assert contact_sheet(pictures) == png


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("sony-a7s-ii")


@pytest.fixture(scope="module")
def small(world):
    """The world with few frames and features for the neural ISP."""
    rules = replace(
        world.protocol.isp, frames={"quick": 10}, features=60, step=4, ridges=(1e-3,)
    )
    return replace(world, protocol=replace(world.protocol, isp=rules))


def test_scenes_are_as_the_camera_and_as_a_renderer_has_them(small, camera):
    found = scene_pictures(small, camera)
    kinds = [
        f"{kind}: {by}" for kind in ("day", "night") for by in ("camera", "render")
    ]
    assert list(found) == kinds
    for kind in ("day", "night"):
        seen, made = (np.array(found[f"{kind}: {by}"]) for by in ("camera", "render"))
        assert seen.shape == made.shape == (4, 48, 64, 3)
        apart = np.abs(seen - made).mean(axis=(1, 2, 3))
        others = np.abs(seen - made[::-1]).mean(axis=(1, 2, 3))
        assert (2 * apart < others).all()


@pytest.mark.slow
def test_examples_are_nearer_to_the_goal_than_their_input(small, camera):
    made = material(small, camera, "night", small.protocol.seeds, 10, 0)
    given = dict(by_exposure(made, camera, 0))
    given["translation, camera"] = given["upi, match"]
    found = isp_examples(Draw(small, camera, "quick", 0), given)
    assert list(found.pictures) == [GOAL, INPUT, *SHOWN, "translation, camera"]
    mean = {name: values.mean() for name, values in found.differences.items()}
    assert GOAL not in mean and mean["real"] < 0.6 * mean[INPUT]
    assert {p.shape for p in found.pictures.values()} == {(2, 48, 64, 3)}


def test_the_curve_of_each_training_is_drawn(tmp_path):
    folder = tmp_path / "translation"
    folder.mkdir()
    measures = ("colours", "chromaticities")
    for name in ("canon-600d-day-0", "canon-600d-day-1", "nikon-d40-day-0"):
        curve = [{"step": s, **dict.fromkeys(measures, 1 / (1 + s))} for s in range(4)]
        held = {"floor": dict.fromkeys(measures, 0.1), "curve": curve}
        (folder / f"{name}.json").write_text(json.dumps(held))
    found = curves_in(tmp_path)
    assert {name: len(each) for name, each in found.items()} == {
        "canon-600d-day": 2,
        "nikon-d40-day": 1,
    }
    png = translation_curves(found)
    assert png == translation_curves(found) and colors(png) > 10


@pytest.mark.slow
def test_denoised_pictures_at_night_are_nearer_to_the_goal(small, camera):
    few = replace(small.protocol.denoising, samples={"quick": 4000}, features=60)
    world = replace(small, protocol=replace(small.protocol, denoising=few))
    found = material(world, camera, "night", world.protocol.seeds, 10, 0)
    made = by_exposure(found, camera, 0)
    pictures = night_examples(Draw(world, camera, "quick", 0), made)
    assert list(pictures)[:3] == ["goal", "not denoised", "real"]
    assert "translation" not in pictures  # there is no translator
    shown = {name: np.array(each) for name, each in pictures.items()}
    assert {each.shape for each in shown.values()} == {(4, 48, 64, 3)}
    goal = shown["goal"]
    assert np.array_equal(goal[:2], goal[2:])  # the same frames at two ISOs
    apart = {name: np.abs(each - goal).mean() for name, each in shown.items()}
    for source in ("real", "ours, match"):
        assert apart[source] < 0.8 * apart["not denoised"]


def test_figures_are_of_the_studies_that_results_have(planted, monkeypatch):
    from studies.figures import files
    from studies.figures.files import figures_of_results

    for name in ("gap_bars", "errors_by_light"):
        monkeypatch.setattr(files, name, lambda *_: b"")
    found = {"isp": planted.summaries["isp"]}
    assert list(figures_of_results(found)) == ["gap"]
    lit = {"illuminant, LED lamps": planted.summaries["illuminant"]}
    both = figures_of_results(found | lit)
    assert list(both) == ["gap", "illuminant"]
    assert figures_of_results({}) == {}


def test_pictures_of_the_isp_are_made_only_if_it_is_asked(
    small, camera, tmp_path, monkeypatch
):
    """Of draw 0; no translator is trained here."""
    from studies.draws import Run
    from studies.figures import files

    def examples(draw, made):
        assert (draw.seed, draw.mode, made) == (0, "quick", "sources")
        return Examples(camera.id, {GOAL: noise(1, 1)}, {})

    monkeypatch.setattr(files, "sources_of", lambda *_: "sources")
    monkeypatch.setattr(files, "isp_examples", examples)
    monkeypatch.setattr(files, "scene_pictures", lambda *_: {"a": noise(2, 1)})
    run = Run(small, "quick", {}, tmp_path, print)
    found = files.figures_of_world(run, camera, ["isp"])
    assert list(found) == ["scenes", "isp"]
    files.write_figures(tmp_path, found)
    assert (tmp_path / "isp.png").read_bytes() == found["isp"]
    assert list(files.figures_of_world(run, camera, ["colour"])) == ["scenes"]
    monkeypatch.setattr(files, "night_examples", lambda *_: {"a": noise(2, 1)})
    found = files.figures_of_world(run, camera, ["denoising"])
    assert list(found) == ["scenes", "night"]
