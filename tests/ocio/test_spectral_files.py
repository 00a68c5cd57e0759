# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convention spectral as CTF, CLF and .cube, and as a DNG by way of OCIO."""

import numpy as np
import pytest

import cg2raw
from cg2raw_ocio import measure
from cg2raw_ocio.export import raw_text
from cg2raw_ocio.spaces import Exposure
from images import attributes, read_dn, write_image
from ocio.conversion import difference, through_file
from ocio.test_color_effects import SETTINGS, with_effects
from ocio.test_export import errors
from ocio.test_spectral_config import (
    MAX_DN,
    ONE,
    PAIRS,
    SPECTRAL,
    exact,
    made,
    scene,
)
from python.commands import run
from tiers import WHEEL_FAST, slow


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Return the path of a config that is only read; its files lie in show_raw."""
    return made(tmp_path_factory.mktemp("shared") / "show.ocio")


def test_a_ctf_is_as_wrong_as_it_says(tmp_path, path):
    done = run("ocio", *ONE, *SPECTRAL, "--ctf", tmp_path / "x.ctf")
    [(most, mean)] = errors(done.out)
    error = np.abs(
        through_file(tmp_path / "x.ctf", scene(1.0)) - exact(PAIRS[0], scene(1.0))
    )
    assert error.max() * 65535 <= most * 1.2 <= 3.0
    assert error.mean() * 65535 == pytest.approx(mean, rel=0.2)
    expected = path.parent / "show_raw" / "raw_canon_600d_fl2.ctf"
    assert (tmp_path / "x.ctf").read_bytes() == expected.read_bytes()


def test_color_effects_and_gain_are_in_it(tmp_path, repository):
    profile = with_effects(repository, "canon-600d", SETTINGS)
    exposure = Exposure("spectral", 0.7)
    text, _ = raw_text(profile, "FL2", exposure)
    (tmp_path / "x.ctf").write_text(text)
    found = through_file(tmp_path / "x.ctf", scene())
    expected = measure.exact_camera(profile, "FL2", exposure, scene())
    assert difference(found, expected) <= MAX_DN
    assert difference(found, exact(PAIRS[0], scene())) > 1000


def test_a_clf_is_as_wrong_as_it_says(tmp_path):
    """Neutrals are exact but for the roots and squares of OpenColorIO 2.6: 4e-5."""
    done = run("ocio", *ONE, *SPECTRAL, "--clf", tmp_path / "x.clf")
    [(most, mean)] = errors(done.err)
    found = through_file(tmp_path / "x.clf", scene(1.0))
    error = np.abs(found - exact(PAIRS[0], scene(1.0))) * 65535
    assert error.max() <= most * 1.2 < 100
    assert error.mean() == pytest.approx(mean, rel=0.2)
    ramp = np.repeat(np.geomspace(1e-5, 4, 400, dtype=np.float32)[:, None], 3, axis=1)
    neutral = through_file(tmp_path / "x.clf", ramp) - exact(PAIRS[0], ramp)
    assert (np.abs(neutral) / np.maximum(ramp, 1)).max() <= 4e-5
    assert "negative components for 0, and what is above 4 for that" in done.err


def test_a_cube_is_the_core_at_its_nodes(tmp_path):
    options = ("--cube", tmp_path / "x.cube", "--cube-size", 5)
    assert run("ocio", *ONE, *SPECTRAL, *options).code == 0
    rows = np.loadtxt((tmp_path / "x.cube").read_text().splitlines()[4:])
    nodes = [[r, g, b] for b in range(5) for g in range(5) for r in range(5)]
    expected = exact(PAIRS[0], np.float32(nodes) / 4)
    assert difference(rows, expected) <= 0.02


# Share of the words of 14 bits that may differ by 1. An error of 1 DN of 16 bits, which
# roots have at white in OpenColorIO 2.6, moves a quarter of the roundings; most pixels
# are far darker than white, and as much more exact.
SHARE = 0.03


@pytest.mark.parametrize("picture", ["interior", slow("night_street")])
@pytest.mark.parametrize("oiiotool", WHEEL_FAST, indirect=True)
def test_both_routes_to_a_dng(oiiotool, repository, path, tmp_path, picture):
    image = repository / "tests" / "data" / f"{picture}.exr"
    by_ocio, direct = tmp_path / "ocio.dng", tmp_path / "direct.dng"
    environment = {"OCIO": str(path)}
    space = "RAW - canon-600d - FL2"
    oiiotool(image, "--tocolorspace", space, "-o", by_ocio, env=environment)
    given = {"sensor": "canon-600d", "illuminant": "FL2"}
    oiiotool(image, *attributes(**given, convention="spectral"), "-o", direct)
    found, expected = (read_dn(p).astype(int) for p in (by_ocio, direct))
    off = np.abs(found - expected)
    print(f"{oiiotool.name} {picture}: {(off > 0).mean():.2%}")
    assert off.max() <= 1 and (off > 0).mean() <= SHARE
    matrices = tmp_path / "dng.dng"
    oiiotool(image, *attributes(**given), "-o", matrices)
    assert np.abs(read_dn(matrices).astype(int) - expected).max() > 50
    one, other = (cg2raw.read_dng_metadata(str(p)) for p in (by_ocio, direct))
    assert one.as_shot_neutral == other.as_shot_neutral
    assert one.make == other.make and one.model == other.model


def test_pixels_in_the_space_are_not_converted_again(oiiotool, path, tmp_path):
    source = write_image(tmp_path / "in.exr", scene(1.0)[:4096].reshape(64, 64, 3))
    words = (
        "--tocolorspace",
        "RAW - canon-600d - FL2",
        *attributes(convention="spectral"),
    )
    output = ("-o", tmp_path / "out.dng")
    done = oiiotool(source, *words, *output, env={"OCIO": str(path)}, check=False)
    assert done.returncode != 0
    assert "belongs to the conversion, which has been done" in done.stdout + done.stderr
