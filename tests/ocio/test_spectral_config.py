# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw ocio --convention spectral: configs whose tables are files beside them."""

import re
import shutil
import subprocess

import numpy as np
import PyOpenColorIO as ocio
import pytest

import cg2raw
from cg2raw import _core
from cg2raw_ocio import names
from cg2raw_ocio.spaces import TABLE_REMARK
from ocio.conversion import (
    SCENE,
    camera,
    converted,
    difference,
    pixels,
    system_python,
)
from ocio.test_config import CHECKERS
from python.commands import fails, run
from tiers import slow

SPECTRAL = ("--convention", "spectral")
PAIRS = [("canon-600d", "FL2"), ("nikon-d850", "sample:1")]
ASKED = ("--sensors", "canon-600d,nikon-d850", "--illuminants", "FL2,sample:1")
ONE = ("--sensors", "canon-600d", "--illuminants", "FL2")
FILES = [
    f"raw_{sensor}_{light}.ctf"
    for sensor in ("canon_600d", "nikon_d850")
    for light in ("fl2", "sample_1")
]
# What the laws of test_spectral_chain.py allow these two pairs, and pixels up to 1.5.
MAX_DN = 12.5


def scene(high=1.5):
    """Return pixels of light: no negative components."""
    return pixels(low=0.0, high=high)


def exact(pair, rgb):
    """Return the core's camera RGB."""
    return camera(*pair, rgb, convention="spectral")


def made(path):
    """Return the path of a config that the command writes."""
    done = run("ocio", *ASKED, *SPECTRAL, "-o", path)
    assert done.code == 0 and "4 RAW spaces" in done.out and "4 files" in done.out
    return path


def read(path):
    """Return the config of a file that must be valid."""
    config = ocio.Config.CreateFromFile(str(path))
    config.validate()
    return config


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """Return the path of a config that is only read."""
    return made(tmp_path_factory.mktemp("shared") / "show.ocio")


@pytest.fixture
def path(shared, tmp_path):
    """Return the path of a config; its files lie in show_raw."""
    shutil.copytree(shared.parent, tmp_path, dirs_exist_ok=True)
    return tmp_path / shared.name


@pytest.mark.parametrize("pair", PAIRS, ids=" ".join)
def test_a_space_is_what_the_core_says(path, pair):
    config, name = read(path), "RAW - " + " - ".join(pair)
    found = converted(config, SCENE, name, scene())
    assert difference(found, exact(pair, scene())) <= MAX_DN
    assert found.max() > 1.2  # the sensor clips, not the space
    assert difference(found, camera(*pair, scene(), convention="sensor")) > 1000


@pytest.mark.parametrize("pair", PAIRS, ids=" ".join)
def test_the_way_back_is_a_cameras(path, tmp_path, pair):
    """The profile's matrices: the same as in a config of convention dng."""
    run("ocio", *ASKED, "-o", tmp_path / "dng.ocio")
    name = "RAW - " + " - ".join(pair)
    found, expected = (
        converted(read(p), name, SCENE, scene()) for p in (path, tmp_path / "dng.ocio")
    )
    np.testing.assert_array_equal(found, expected)


def test_spaces_have_no_twins_and_say_what_they_are(path):
    config = read(path)
    assert config.getInactiveColorSpaces() == ""
    everything = (ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL)
    spaces = [space.getName() for space in config.getColorSpaces(*everything)]
    assert not [name for name in spaces if "unbounded" in name]
    for pair in PAIRS:  # the interop ID is that of other conventions
        name, _, interop_id = names.raw_space(*pair)
        assert config.getColorSpace(name).getInteropID() == interop_id
        assert config.getColorSpace(interop_id).getName() == name
    text = config.getColorSpace("RAW - canon-600d - FL2").getDescription()
    assert "convention spectral, by the spectrum of FL2" in text
    assert text.endswith(TABLE_REMARK)


def test_files_are_small_and_move_with_the_config(path, tmp_path):
    folder = tmp_path / "show_raw"
    assert sorted(file.name for file in folder.iterdir()) == FILES
    assert all(file.stat().st_size < 450_000 for file in folder.iterdir())
    moved = tmp_path / "else"
    moved.mkdir()
    for name in ("show.ocio", "show_raw"):
        (tmp_path / name).rename(moved / name)
    found = converted(read(moved / "show.ocio"), SCENE, "raw_canon_600d_fl2", scene())
    assert difference(found, exact(PAIRS[0], scene())) <= MAX_DN


def test_it_goes_into_an_archive(path, tmp_path):
    config = read(path)
    assert config.isArchivable()
    config.archive(str(tmp_path / "show.ocioz"))
    for file in (tmp_path / "show_raw").iterdir():
        file.unlink()
    found = converted(
        read(tmp_path / "show.ocioz"), SCENE, "raw_canon_600d_fl2", scene()
    )
    assert difference(found, exact(PAIRS[0], scene())) <= MAX_DN


@pytest.mark.parametrize("checker", CHECKERS)
def test_ociocheck_has_no_warning(path, checker):
    if not CHECKERS[checker].exists():
        pytest.skip(f"no {CHECKERS[checker]}")
    command = [CHECKERS[checker], "--iconfig", path]
    done = subprocess.run(command, capture_output=True, text=True)
    said = done.stdout + done.stderr
    assert done.returncode == 0 and "passed" in said, said
    assert re.findall(r"(?m)^(?:WARNING|ERROR|Warnings encountered).*", said) == []


def test_the_same_bytes_with_the_systems_opencolorio(path, tmp_path, build_folder):
    (tmp_path / "old").mkdir()
    old = tmp_path / "old" / "show.ocio"
    system_python(build_folder, "-m", "cg2raw", "ocio", *ASKED, *SPECTRAL, "-o", old)
    assert old.read_bytes() == path.read_bytes()
    for name in FILES:
        new, again = (p.parent / "show_raw" / name for p in (path, old))
        assert new.read_bytes() == again.read_bytes(), name


CONVERT = """
import sys
import numpy as np
import PyOpenColorIO as ocio
image = np.load(sys.argv[2])
config = ocio.Config.CreateFromFile(sys.argv[1])
config.validate()
cpu = config.getProcessor(*sys.argv[3:]).getDefaultCPUProcessor()
cpu.apply(ocio.PackedImageDesc(image, len(image), 1, 4))
np.save(sys.argv[2], image)
"""


@pytest.mark.parametrize("pair", [PAIRS[0], slow(PAIRS[1])], ids=" ".join)
def test_in_the_systems_opencolorio(path, tmp_path, build_folder, pair):
    image = np.ones((len(scene()), 4), np.float32)
    image[:, :3] = scene()
    np.save(tmp_path / "x.npy", image)
    words = (
        "-c",
        CONVERT,
        path,
        tmp_path / "x.npy",
        SCENE,
        "RAW - " + " - ".join(pair),
    )
    system_python(build_folder, *words)
    found = np.load(tmp_path / "x.npy")[:, :3]
    assert difference(found, exact(pair, scene())) <= MAX_DN


@pytest.mark.parametrize("pair", [slow(PAIRS[0]), PAIRS[1]], ids=" ".join)
def test_the_environment_chooses(tmp_path, monkeypatch, pair):
    output = tmp_path / "show.ocio"
    done = run("ocio", *ASKED, *SPECTRAL, "--context", "-o", output)
    assert done.code == 0 and "8 files, 4 pairs" in done.out
    stems = [f"{sensor}_{light}" for sensor in ("canon-600d", "nikon-d850")
             for light in ("FL2", "sample:1")]  # fmt: skip
    names = {file.name for file in (tmp_path / "show_raw").iterdir()}
    assert names == {f"{s}{end}.ctf" for s in stems for end in ("", "_to_scene")}
    for variable, word in zip(("SENSOR", "ILLUMINANT"), pair, strict=True):
        monkeypatch.setenv(f"CG2RAW_{variable}", word)
    config = read(output)
    found = converted(config, SCENE, "RAW - context", scene())
    assert difference(found, exact(pair, scene())) <= MAX_DN
    assert config.getColorSpace("RAW unbounded - context") is None
    back = converted(config, "RAW - context", SCENE, found)
    run("ocio", *ASKED, "-o", tmp_path / "dng.ocio")
    name = "RAW - " + " - ".join(pair)
    expected = converted(read(tmp_path / "dng.ocio"), name, SCENE, found)
    assert difference(back, expected) <= 0.02


STUDIO = """\
ocio_profile_version: 2.1
strictparsing: false
%sroles: {aces_interchange: ap0, scene_linear: ap0, default: ap0}
file_rules:
  - !<Rule> {name: Default, colorspace: ap0}
displays:
  monitor:
    - !<View> {name: raw, colorspace: ap0}
colorspaces:
  - !<ColorSpace> {name: ap0}
  - !<ColorSpace>
    name: graded
    from_scene_reference: !<FileTransform> {src: %s}
"""


@pytest.mark.parametrize(
    ("search_path", "source"), [("", "luts/x.ctf"), ("search_path: luts\n", "x.ctf")]
)
def test_in_a_studios_config_both_find_their_files(tmp_path, search_path, source):
    doubled = ocio.GroupTransform(
        [ocio.MatrixTransform(np.diag([2.0, 2, 2, 1]).ravel())]
    )
    (tmp_path / "luts").mkdir()
    text = doubled.write("Color Transform Format", ocio.Config.CreateRaw())
    (tmp_path / "luts" / "x.ctf").write_text(text)
    (tmp_path / "studio.ocio").write_text(STUDIO % (search_path, source))
    merging = ("--merge", tmp_path / "studio.ocio", "-o", tmp_path / "merged.ocio")
    done = run("ocio", *ASKED, *SPECTRAL, *merging)
    assert done.code == 0, done.err
    config = read(tmp_path / "merged.ocio")
    found = converted(config, "ap0", "graded", scene())
    np.testing.assert_allclose(found, 2 * scene(), rtol=1e-6)
    aces = ocio.Config.CreateFromBuiltinConfig("cg-config-v1.0.0_aces-v1.3_ocio-v2.1")
    rgb = converted(aces, SCENE, "ACES2065-1", scene())
    for pair in PAIRS:
        found = converted(config, "ap0", "RAW - " + " - ".join(pair), rgb)
        assert difference(found, exact(pair, scene())) <= MAX_DN


def test_in_a_built_in_config(tmp_path):
    output = tmp_path / "merged.ocio"
    done = run("ocio", *ONE, *SPECTRAL, "--merge", "ocio://default", "-o", output)
    assert done.code == 0, done.err
    base = ocio.Config.CreateFromBuiltinConfig("cg-config-v2.2.0_aces-v1.3_ocio-v2.4")
    config = read(output)
    assert config.getInactiveColorSpaces() == base.getInactiveColorSpaces()
    found = converted(config, SCENE, "RAW - canon-600d - FL2", scene())
    assert difference(found, exact(PAIRS[0], scene())) <= MAX_DN


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((*ONE, "-o", "-"), "needs -o OUT.ocio, beside which its tables lie, or --ctf"),
        (ONE, "needs -o OUT.ocio, beside which its tables lie, or --ctf"),
        ((*ONE, "--merge", "ocio://default"), "needs -o OUT.ocio, beside which"),
        ((*ONE, "--ctf", "x.ctf", "-o", "-"), "needs -o OUT.ocio, beside which"),
        (
            ("--sensors", "nikon-d40", "--illuminants", "A", "--ctf", "x.ctf"),
            "sensor nikon-d40 has no spectral_sensitivities: use convention dng",
        ),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    assert message in fails("ocio", *words, *SPECTRAL)
    assert not list(tmp_path.iterdir())


def test_of_all_sensors_those_that_see_spectra(tmp_path):
    asked = ("--sensors", "all", "--illuminants", "A", "-o", tmp_path / "a.ocio")
    done = run("ocio", *asked, *SPECTRAL)
    seeing = [
        id
        for id in cg2raw.installed_profiles()
        if _core.load_profile(id).spectral_sensitivities is not None
    ]
    names = [space.getName() for space in read(tmp_path / "a.ocio").getColorSpaces()]
    assert [n for n in names if n.startswith("RAW")] == [
        f"RAW - {s} - A" for s in seeing
    ]
    others = len(cg2raw.installed_profiles()) - len(seeing)
    assert f"{others} sensors have no spectral_sensitivities: skipped" in done.err
