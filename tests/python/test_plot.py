# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The picture of a sensor's illuminants: drawn for any profile, with what it shows."""

import io
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib import image, style
from matplotlib.figure import Figure

import cg2raw
from cg2raw.io.figure import drawn
from cg2raw.profile import plot, summary
from dng import dng_files
from oracles import cameras
from python.commands import fails, run
from tiers import first_fast

NEUTRALS = [[0.9, 0.3], [0.6, 0.5], [0.4, 0.8], [0.5, 0.7]]

EXTREME = [[0.01, 99], [99, 0.01], [1, 1]]
# Profiles; samples, neutrals and ellipses of each, and the second line of its title.
PROFILES = {
    "a distribution": ({}, (200, 0, 3), "neutrals known by their distribution"),
    "neutrals": ({"illuminants": {"neutrals": NEUTRALS}}, (200, 4, 3), "4 neutrals"),
    "one neutral": (
        {"illuminants": {"neutrals": NEUTRALS[:1]}},
        (200, 1, 0),
        "1 neutral",
    ),
    "neutrals on a line": (
        {"illuminants": {"neutrals": [[0.5, 0.5]] * 4}},
        (200, 4, 0),
        "4 neutrals",
    ),
    "extreme neutrals": (
        {"illuminants": {"neutrals": EXTREME}},
        (200, 3, 3),
        "3 neutrals",
    ),
    "no neutrals": ({"illuminants": None}, (200, 0, 0), "no neutrals"),
    "nothing to draw from": (
        {
            "illuminants": None,
            "color_matrix_2": None,
            "calibration_illuminant_2": None,
        },
        (0, 0, 0),
        "no neutrals",
    ),
}


@pytest.mark.parametrize(
    ("changes", "counts", "known"), first_fast(list(PROFILES.values()), 3), ids=PROFILES
)
def test_any_profile_can_be_drawn(changes, counts, known):
    sensor = dng_files.sensor(**changes)
    axes = Figure().add_subplot()
    plot.draw_illuminants(axes, sensor, None)
    dots = {dot.get_label(): len(dot.get_offsets()) for dot in axes.collections}
    dashed = [line for line in axes.lines if line.get_linestyle() == "--"]
    found = dots.get("sample:0 to sample:199", 0), dots.get("neutrals", 0)
    assert (*found, len(dashed)) == counts
    assert axes.get_title().splitlines()[1] == known
    pixels = image.imread(io.BytesIO(plot.plot_png(sensor)))
    assert pixels.shape == (780, 960, 4)  # 8 x 6.5 inches of 120 pixels
    assert (pixels[..., :3] < 0.9).any(axis=2).mean() > 0.005  # not an empty page


def test_a_picture_holds_what_was_measured_and_a_third_more():
    axes = Figure().subplots()
    profile = SimpleNamespace(
        illuminants={"neutrals": [[0.5, 0.9], [0.7, 0.1]], "hull": []}
    )
    drawn = np.array([[0.6, 0.4], [np.nan, np.nan]])
    plot.set_limits(axes, profile, drawn, np.zeros((3, 2)))
    assert axes.get_xlim() == pytest.approx((0.43, 0.77))
    assert axes.get_ylim() == pytest.approx((0, 1.18))


def test_the_same_profile_gives_the_same_bytes():
    png = plot.plot_png(cg2raw.Sensor("samsung-s20fe"))
    with style.context("dark_background"):  # as a user's matplotlibrc may say
        assert png == plot.plot_png(cg2raw.Sensor("samsung-s20fe"))
    assert png != plot.plot_png(cg2raw.Sensor("nikon-d40"))
    photograph = drawn(1.0, lambda figure: None, colors=None)
    assert b"Software" not in photograph  # which would be matplotlib and its version


def axes_of(sensor):
    """Return axes with what is drawn of a sensor."""
    axes = Figure().add_subplot()
    plot.draw_lights(axes, sensor, plot.drawn(sensor))
    return axes


def test_the_ellipses_are_those_of_the_covariance():
    sensor = dng_files.sensor(illuminants={"neutrals": NEUTRALS})
    mean, covariance = np.mean(NEUTRALS, axis=0), np.cov(np.transpose(NEUTRALS))
    dashed = [line for line in axes_of(sensor).lines if line.get_linestyle() == "--"]
    for sigmas, line in enumerate(dashed, 1):
        offsets = line.get_xydata() - mean
        distance = np.einsum("ni,ij,nj->n", offsets, np.linalg.inv(covariance), offsets)
        np.testing.assert_allclose(distance, sigmas**2, rtol=1e-6)
        assert offsets[-1] == pytest.approx(offsets[0])  # all the way round
        reach = sigmas * np.sqrt(np.diag(covariance))
        assert np.abs(offsets).max(axis=0) == pytest.approx(reach, rel=1e-3)
    assert len(dashed) == 3


def test_samples_and_neutrals_are_those_of_the_sensor():
    sensor = dng_files.sensor(illuminants={"neutrals": NEUTRALS})
    samples, neutrals = (dots.get_offsets() for dots in axes_of(sensor).collections)
    np.testing.assert_allclose(neutrals, NEUTRALS)
    red, _, blue = sensor.illuminant("sample:7").neutral
    assert len(samples) == 200 and list(samples[7]) == pytest.approx([red, blue])


def test_the_locus_is_that_of_the_sensor():
    sensor = cg2raw.Sensor("nikon-d40")
    points = plot.draw_locus(Figure().add_subplot(), sensor)
    for row, word in ((0, "15000K"), (-1, "2000K")):
        red, _, blue = sensor.illuminant(word).neutral
        assert list(points[row]) == pytest.approx([red, blue], abs=1e-5)


def test_what_a_sensor_does_not_see_is_no_point_of_its_locus():
    def illuminant(word):
        if float(word[:-1]) < 3000:
            raise ValueError("no light")
        return SimpleNamespace(neutral=(0.5, 1.0, 0.6))

    sensor = SimpleNamespace(illuminant=illuminant)
    points = plot.draw_locus(Figure().add_subplot(), sensor)
    assert list(points[0]) == [0.5, 0.6] and np.isnan(points[-1]).all()


@pytest.mark.parametrize("unit", ["energy", "photon"])
@pytest.mark.parametrize("mono", [False, True])
def test_sensitivities_are_drawn_in_a_picture_of_their_own(unit, mono):
    steps = np.arange(380.0, 781.0, 5.0)
    curves = np.exp(-(((steps[:, None] - [600, 540, 460]) / 40) ** 2))
    curves = np.repeat(curves[:, :1], 3, axis=1) if mono else curves
    names = ["mono"] if mono else list("RGB")
    field = {"unit": unit, "scale": 1.0, "wavelengths": steps.tolist()}
    field |= {n: curves[:, i].tolist() for i, n in enumerate(names)}
    text = cameras.mono_text if mono else cameras.profile_text
    sensor = cg2raw.Sensor.from_json(text(spectral_sensitivities=field))
    axes = Figure().add_subplot()
    plot.draw_sensitivities(axes, sensor.spectral_sensitivities)
    *lines, zero = axes.lines
    assert len(lines) == len(names) and set(zero.get_ydata()) == {0.0}
    for line, curve in zip(lines, curves.T, strict=False):
        np.testing.assert_allclose(line.get_xydata(), np.column_stack([steps, curve]))
    assert axes.get_xlim() == (380, 780)
    words = {"energy": "radiant energy", "photon": "a photon"}[unit]
    assert words in axes.get_ylabel()
    if mono and unit == "energy":  # its one picture
        height, width, _ = image.imread(io.BytesIO(plot.plot_png(sensor))).shape
        assert (height, width) == (420, 960)  # 8 x 3.5 inches of 120 pixels


def test_temperatures_stay_within_the_picture():
    figure = Figure(figsize=(8, 6.5), dpi=120)
    axes, sensor = figure.add_subplot(), cg2raw.Sensor("nikon-d40")
    locus = plot.draw_locus(axes, sensor)
    for cool, warm in ((0, 399), (100, 399), (0, 250)):
        (left, top), (right, bottom) = locus[cool], locus[warm]
        axes.set(xlim=(left - 0.01, right + 0.01), ylim=(bottom - 0.01, top + 0.01))
        plot.label_ticks(axes, sensor)
        box = axes.get_window_extent().padded(25)  # at the bottom words may hang over
        assert len(axes.texts) > 3
        for text in list(axes.texts):
            words = text.get_window_extent()
            assert box.contains(words.x0, words.y0) and box.contains(words.x1, words.y1)
            text.remove()


def picture_of(sensor):
    """Return the picture that the commands draw: temperatures are in its title."""
    return plot.plot_png(sensor, summary.illuminants_of(sensor)["cct"])


@pytest.mark.parametrize("command", [("sensors", "nikon-d40")], ids=" ".join)
def test_the_option_plot(tmp_path, command):
    out = tmp_path / "lights.png"
    assert run(*command, "--plot", out).code == 0
    assert out.read_bytes() == picture_of(cg2raw.Sensor("nikon-d40"))
    assert "must end in .png" in fails(*command, "--plot", tmp_path / "lights.pdf")
    assert "needs the whole ID" in fails("sensors", "--plot", out)


def test_a_new_profile_is_drawn_with_it(tmp_path):
    photo, out = tmp_path / "a.dng", tmp_path / "lights.png"
    dng_files.write(photo, dng_files.sensor(), shape=(16, 24))
    assert run("profile", photo, "-o", tmp_path / "a.json", "--plot", out).code == 0
    assert out.read_bytes() == picture_of(cg2raw.Sensor(tmp_path / "a.json"))
