# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw ocio --ctf, --clf, --cube: a pair as a file, its error as measured."""

import re

import numpy as np
import pytest

from cg2raw import _core
from cg2raw_ocio import cube, export, measure
from cg2raw_ocio.spaces import Exposure, camera_transform
from ocio.conversion import camera, difference, pixels, system_python, through_file
from python.commands import fails, run

NOT_PROTECTED = "Highlights are not protected: they take the colour of the light."
PAIRS = [("samsung-s20fe", "A"), ("nikon-d40", "D65"), ("canon-600d", "sample:2")]


def asked(pair):
    """Return the arguments of cg2raw ocio for one pair."""
    return "ocio", "--sensors", pair[0], "--illuminants", pair[1]


def float64_camera(pair, rgb, convention="dng"):
    """Return camera RGB without protected highlights, by NumPy in float64."""
    profile = _core.load_profile(pair[0])
    transform = camera_transform(profile, pair[1], Exposure(convention))
    balanced = np.clip(rgb.astype(float) @ transform.first.T, 0, 1)
    if convention == "paper":  # by way of XYZ, which it clips too
        balanced = np.clip(balanced @ transform.second.T, 0, 1)
    return balanced * transform.gains, balanced.mean(axis=1) <= 0.9


def errors(text):
    """Return the [(max, mean)] that a report names, DN."""
    found = re.findall(r"max ([0-9.e+-]+) DN, mean ([0-9.e+-]+) DN", text)
    return [(float(most), float(mean)) for most, mean in found]


@pytest.mark.parametrize("pair", PAIRS)
def test_a_ctf_is_exact(tmp_path, pair):
    done = run(*asked(pair), "--ctf", tmp_path / "x.ctf")
    found = through_file(tmp_path / "x.ctf", pixels())
    assert difference(found, camera(*pair, pixels())) <= 0.3
    [(most, _)] = errors(done.out)
    assert most <= 0.3 and done.err == ""
    assert [path.name for path in tmp_path.iterdir()] == ["x.ctf"]  # and no config


@pytest.mark.parametrize(
    ("pair", "convention"), [*((pair, "dng") for pair in PAIRS), (PAIRS[0], "paper")]
)
def test_a_clf_is_exact_below_highlights_and_says_what_is_above(
    tmp_path, pair, convention
):
    words = ("--convention", convention, "--clf", tmp_path / "x.clf")
    done = run(*asked(pair), *words)
    rgb = pixels(low=0.0, high=1.0)
    found = through_file(tmp_path / "x.clf", rgb)
    expected, below = float64_camera(pair, rgb, convention)
    assert difference(found, expected) <= 0.02
    assert difference(found[below], camera(*pair, rgb, convention)[below]) <= 0.02
    white = difference(
        through_file(tmp_path / "x.clf", np.ones((1, 3), np.float32)),
        camera(*pair, np.ones((1, 3), np.float32), convention),
    )
    (most, mean), (most_below, _) = errors(done.err)
    assert 1000 < most <= white * 1.001 and 0 < mean < most
    assert most_below <= 0.02 and "max" not in done.out
    share = float(re.search(r"([\d.]+)% of \[0, 1\]\^3", done.err)[1])
    assert share == pytest.approx(100 * below.mean(), abs=1)
    assert NOT_PROTECTED in (tmp_path / "x.clf").read_text()


def test_a_clf_of_unprotected_highlights_is_exact_everywhere(tmp_path):
    done = run(*asked(PAIRS[0]), "--no-highlights", "--clf", tmp_path / "x.clf")
    found = through_file(tmp_path / "x.clf", pixels())
    expected = camera(*PAIRS[0], pixels(), highlights=False)
    assert difference(found, expected) <= 0.02 and len(errors(done.err)) == 1
    assert NOT_PROTECTED not in (tmp_path / "x.clf").read_text()


@pytest.mark.parametrize("encoding", ["linear", "srgb"])
def test_a_cube_holds_the_core_at_its_nodes(tmp_path, encoding):
    options = ("--cube-size", 5, "--cube-input", encoding)
    run(*asked(PAIRS[0]), "--cube", tmp_path / "x.cube", *options)
    text = (tmp_path / "x.cube").read_text()
    assert "LUT_3D_SIZE 5\n" in text and "DOMAIN_MAX 1 1 1\n" in text
    rows = np.loadtxt(text.splitlines()[4:])
    nodes = np.array([[r, g, b] for b in range(5) for g in range(5) for r in range(5)])
    values = nodes / 4.0
    if encoding == "srgb":  # 0.25, 0.5, 0.75 decoded. Source: IEC 61966-2-1
        values = np.array([0, 0.0508761, 0.2140411, 0.5225216, 1])[nodes]
    expected = camera(*PAIRS[0], values.astype(np.float32))
    assert difference(rows, expected) <= 0.02


def test_encodings_are_undone():
    """At the ends, on both sides of the toe (IEC 61966-2-1), and between."""
    linear = np.array([0.0, 0.0031308, 0.0031309, 0.18, 0.2140411, 1.0])
    codes = cube.encoded_from(linear, "srgb")
    assert codes[[0, 4, 5]] == pytest.approx([0, 0.5, 1], abs=1e-7)
    assert codes[1] == pytest.approx(12.92 * 0.0031308)
    for encoding in ("srgb", "linear"):
        again = cube.linear_from(cube.encoded_from(linear, encoding), encoding)
        assert again == pytest.approx(linear, abs=1e-7)
    np.testing.assert_array_equal(cube.encoded_from(linear, "linear"), linear)


@pytest.mark.parametrize(
    ("value", "words"),
    [(0.0123456, "0.0123"), (99.96, "100"), (123.6, "124"), (7, "7")],
)
def test_errors_have_three_digits(value, words):
    assert str(measure.Error(value, value)) == f"max {words} DN, mean {words} DN"


@pytest.mark.parametrize("size", [17, 33])
def test_a_cube_is_as_wrong_as_it_says(tmp_path, size):
    path = tmp_path / "x.cube"
    done = run(*asked(PAIRS[0]), "--cube", path, "--cube-size", size)
    (most, mean), (ramp_most, _) = errors(done.out)
    rgb = pixels(low=0.0, high=1.0)
    error = np.abs(through_file(path, rgb) - camera(*PAIRS[0], rgb)) * 65535
    assert error.max() <= most * 1.2 and error.mean() == pytest.approx(mean, rel=0.2)
    assert most > 10 and ramp_most > 10  # highlights are not linear


def test_a_finer_cube_is_better(tmp_path):
    found = {}
    for size in (17, 65):
        path = tmp_path / f"{size}.cube"
        done = run(*asked(PAIRS[0]), "--cube", path, "--cube-size", size)
        found[size] = errors(done.out)
    for coarse, fine in zip(found[17], found[65], strict=True):
        assert fine[0] < coarse[0] / 4 and fine[1] < coarse[1] / 4


def test_the_error_of_a_planted_difference():
    exact = pixels(1000)
    found = exact.copy()
    found[7, 1] += 10 / 65535
    error = measure.error(found, exact)
    assert error.max_dn == pytest.approx(10, abs=0.05)
    assert error.mean_dn == pytest.approx(10 / 3000, rel=0.01)
    assert measure.error(exact[:0], exact[:0]) == measure.Error(0.0, 0.0)


def test_a_file_that_reads_back_otherwise_is_refused():
    transform = camera_transform(_core.load_profile("nikon-d40"), "A", Exposure())
    plain = export.plain_chain(transform)
    text = export.chain_text(plain, ".clf", ("nikon-d40", "A"), "")
    with pytest.raises(ValueError, match="must be below 0.02 DN"):
        export.read_back(text, ".clf", plain[:-1], pixels())


def test_the_same_ctf_and_cube_with_the_systems_opencolorio(tmp_path, build_folder):
    for name in ("old", "new"):
        (tmp_path / name).mkdir()
    files = {
        name: ("--ctf", tmp_path / name / "x.ctf", "--cube", tmp_path / name / "x.cube")
        for name in ("old", "new")
    }
    size = ("--cube-size", 9)
    system_python(build_folder, "-m", "cg2raw", *asked(PAIRS[0]), *files["old"], *size)
    run(*asked(PAIRS[0]), *files["new"], *size)
    for name in ("x.ctf", "x.cube"):
        old, new = ((tmp_path / age / name).read_bytes() for age in ("old", "new"))
        assert old == new


def test_the_systems_clf_is_the_same_transform(tmp_path, build_folder):
    path = tmp_path / "x.clf"
    system_python(build_folder, "-m", "cg2raw", *asked(PAIRS[0]), "--clf", path)
    expected, _ = float64_camera(PAIRS[0], pixels())
    assert difference(through_file(path, pixels()), expected) <= 0.02


@pytest.mark.parametrize("option", ["--ctf", "--clf", "--cube"])
def test_more_than_one_pair_is_an_error(tmp_path, option):
    path = tmp_path / f"x.{option[2:]}"
    two = ("ocio", "--sensors", "nikon-d40", "--illuminants", "A,D65", option, path)
    assert "one sensor under one illuminant, not 1 x 2" in fails(*two)
    assert not path.exists()


@pytest.mark.parametrize("size", [1, 130])
def test_a_cube_has_bounds(tmp_path, size):
    options = ("--cube", tmp_path / "x.cube", "--cube-size", size)
    assert "must be 2 to 129" in fails(*asked(PAIRS[0]), *options)
    assert not list(tmp_path.iterdir())


def test_an_ending_that_is_another_ones(tmp_path):
    assert "must end in .clf" in fails(*asked(PAIRS[0]), "--clf", tmp_path / "x.ctf")


def test_config_and_files_at_once(tmp_path):
    run(*asked(PAIRS[0]), "--ctf", tmp_path / "x.ctf", "-o", tmp_path / "x.ocio")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["x.ctf", "x.ocio"]
