# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw ocio --context: one space whose sensor and light the environment chooses."""

import os

import numpy as np
import PyOpenColorIO as ocio
import pytest

import cg2raw
from images import attributes, read_dn, write_image
from ocio.conversion import SCENE, camera, converted, difference, pixels, system_python
from python.commands import fails, run
from python.counted_reads import bytes_read
from tiers import slow

PAIRS = [
    (sensor, light)
    for sensor in ("samsung-s20fe", "nikon-d40")
    for light in ("A", "sample:1", "neutral:0.55:0.45", "xy:0.3457:0.3585")
]
ASKED = (
    "--sensors", "samsung-s20fe,nikon-d40",
    "--illuminants", "A,sample:1,neutral:0.55:0.45,xy:0.3457:0.3585",
)  # fmt: skip


@pytest.fixture
def path(tmp_path):
    """Return the path of a config of context; its files lie in show_raw."""
    done = run("ocio", *ASKED, "--context", "-o", tmp_path / "show.ocio")
    assert done.code == 0, done.err
    assert f"wrote     {tmp_path / 'show_raw'}{os.sep}: " in done.out
    return tmp_path / "show.ocio"


def choose(monkeypatch, sensor, light):
    """Set the environment's sensor and light."""
    monkeypatch.setenv("CG2RAW_SENSOR", sensor)
    monkeypatch.setenv("CG2RAW_ILLUMINANT", light)


def read(path):
    """Return a valid config; it takes the environment as it is now."""
    config = ocio.Config.CreateFromFile(str(path))
    config.validate()
    return config


@pytest.fixture
def plain(tmp_path):
    """Return the config that has a space for each pair."""
    run("ocio", *ASKED, "-o", tmp_path / "plain.ocio")
    return read(tmp_path / "plain.ocio")


@pytest.mark.parametrize("pair", PAIRS, ids=" ".join)
def test_the_environment_chooses_the_same_chain(path, plain, monkeypatch, pair):
    choose(monkeypatch, *pair)
    config, name = read(path), " - ".join(pair)
    for kind in ("RAW", "RAW unbounded"):
        space, same = f"{kind} - context", f"{kind} - {name}"
        for ends in ((SCENE, space), (space, SCENE)):
            expected = [same if end == space else end for end in ends]
            found = converted(config, *ends, pixels())
            want = converted(plain, *expected, pixels())
            assert difference(found, want) <= 0.02
            assert np.abs(want - pixels()).max() > 0.05
    found = converted(config, SCENE, "raw_context", pixels())
    assert difference(found, camera(*pair, pixels())) <= 0.3


def test_the_first_pair_is_the_default(path, monkeypatch):
    for name in ("CG2RAW_SENSOR", "CG2RAW_ILLUMINANT"):
        monkeypatch.delenv(name, raising=False)
    found = converted(read(path), SCENE, "raw_context", pixels())
    assert difference(found, camera(*PAIRS[0], pixels())) <= 0.3


def test_a_pair_without_a_file_is_named(path, monkeypatch):
    choose(monkeypatch, "nikon-d40", "D75")
    with pytest.raises(ocio.ExceptionMissingFile, match="nikon-d40_D75.ctf"):
        converted(read(path), SCENE, "raw_context", pixels(10))


def test_folder_and_config_may_move_together(path, tmp_path, monkeypatch):
    choose(monkeypatch, *PAIRS[1])
    moved = tmp_path / "else"
    moved.mkdir()
    for name in ("show.ocio", "show_raw"):
        (tmp_path / name).rename(moved / name)
    found = converted(read(moved / "show.ocio"), SCENE, "raw_context", pixels())
    assert difference(found, camera(*PAIRS[1], pixels())) <= 0.3


CONVERT = """
import sys
import numpy as np
import PyOpenColorIO as ocio
image = np.load(sys.argv[2])
config = ocio.Config.CreateFromFile(sys.argv[1])
config.validate()
ends = sys.argv[3:]
cpu = config.getProcessor(*ends).getDefaultCPUProcessor()
cpu.apply(ocio.PackedImageDesc(image, len(image), 1, 4))
np.save(sys.argv[2], image)
"""


@pytest.mark.parametrize("pair", [PAIRS[0], slow(PAIRS[1])], ids=" ".join)
def test_in_the_systems_opencolorio(path, plain, tmp_path, build_folder, pair):
    for ends in ((SCENE, "RAW - context"), ("RAW - context", SCENE)):
        image = np.ones((20000, 4), np.float32)
        image[:, :3] = pixels()
        np.save(tmp_path / "x.npy", image)
        words = ("-c", CONVERT, path, tmp_path / "x.npy", *ends)
        environment = dict(
            zip(("CG2RAW_SENSOR", "CG2RAW_ILLUMINANT"), pair, strict=True)
        )
        system_python(build_folder, *words, env=environment)
        found = np.load(tmp_path / "x.npy")[:, :3]
        same = [end.replace("context", " - ".join(pair)) for end in ends]
        assert difference(found, converted(plain, *same, pixels())) <= 0.3


def test_the_same_bytes_with_the_systems_opencolorio(path, tmp_path, build_folder):
    (tmp_path / "old").mkdir()
    old = tmp_path / "old" / "show.ocio"
    system_python(build_folder, "-m", "cg2raw", "ocio", *ASKED, "--context", "-o", old)
    assert old.read_bytes() == path.read_bytes()
    files = sorted((tmp_path / "show_raw").iterdir())
    assert len(files) == 3 * len(PAIRS)
    for file in files:
        assert (old.parent / "show_raw" / file.name).read_bytes() == file.read_bytes()


@pytest.mark.parametrize("pair", PAIRS[1:6:4], ids=" ".join)
@pytest.mark.parametrize("space", ["RAW - context", "raw_context"])
def test_oiiotool_writes_the_raw_of_the_chosen_sensor(
    oiiotool, path, tmp_path, space, pair
):
    scene = pixels(96 * 64, 0.0, 0.8).reshape(64, 96, 3)
    exr, out = write_image(tmp_path / "in.exr", scene), tmp_path / "out.dng"
    sensor, light = pair
    environment = {
        "OCIO": str(path), "CG2RAW_SENSOR": sensor, "CG2RAW_ILLUMINANT": light
    }  # fmt: skip
    convert = ("--colorconvert", SCENE, space)
    oiiotool(exr, *convert, *attributes(seed=1), "-o", out, env=environment)
    expected = cg2raw.Sensor(sensor).simulate(scene, illuminant=light, seed=1)
    found = read_dn(out).astype(int)
    assert found.shape == expected.shape and np.abs(found - expected).max() <= 1
    metadata = cg2raw.read_dng_metadata(str(out))
    assert sensor.split("-")[0] in metadata.make.lower()


@pytest.mark.parametrize("name", ["RAW unbounded - context", "raw_unbounded_context"])
def test_the_plugin_knows_the_unbounded_twin(monkeypatch, name):
    choose(monkeypatch, "nikon-d40", "sample:3")
    assert cg2raw.raw_space_from_name(name) == ("nikon-d40", "sample:3")
    monkeypatch.delenv("CG2RAW_SENSOR")
    with pytest.raises(ValueError, match="set CG2RAW_SENSOR"):
        cg2raw.raw_space_from_name(name)


@pytest.mark.slow
def test_of_a_thousand_pairs_one_is_read(tmp_path, monkeypatch):
    output = tmp_path / "many.ocio"
    asked = ("--sensors", "samsung-s20fe,nikon-d40", "--illuminants", "sample:0-499")
    assert run("ocio", *asked, "--context", "-o", output).code == 0
    choose(monkeypatch, "nikon-d40", "sample:499")
    before = bytes_read()
    processor = read(output).getProcessor(SCENE, "RAW - context")
    processor.getDefaultCPUProcessor()
    config_and_one_pair = output.stat().st_size + 200_000
    assert bytes_read() - before <= config_and_one_pair
    assert len(list((tmp_path / "many_raw").iterdir())) == 3000


def test_a_new_folder_replaces_the_old_one(path, tmp_path):
    one = ("--sensors", "sony-a57", "--illuminants", "D50")
    assert run("ocio", *one, "--context", "-o", path).code == 0
    names = {file.name for file in (tmp_path / "show_raw").iterdir()}
    stems = ("", "_to_scene", "_unbounded")
    assert names == {f"sony-a57_D50{suffix}.ctf" for suffix in stems}
    assert {file.name for file in tmp_path.iterdir()} == {"show.ocio", "show_raw"}


def test_a_folder_of_someone_else_stays(path, tmp_path):
    (tmp_path / "show_raw" / "holiday.jpg").write_text("")
    before = path.read_bytes()
    files = sorted((tmp_path / "show_raw").iterdir())
    line = fails("ocio", "--sensors", "sony-a57", "--illuminants", "D50", "--context",
                 "-o", path)  # fmt: skip
    assert "holds holiday.jpg, which is not ours" in line
    assert sorted((tmp_path / "show_raw").iterdir()) == files
    assert path.read_bytes() == before


def test_a_write_that_fails_leaves_the_old_pair(path, tmp_path, monkeypatch):
    from cg2raw.io import atomic_file

    before = {file.name: file.read_bytes() for file in tmp_path.rglob("*.[co]*")}
    count, write_in = [0], atomic_file.write_in

    def full(folder, name, data, path):
        count[0] += 1
        if count[0] == 2:
            raise OSError(f"{path}: cannot write: No space left on device")
        write_in(folder, name, data, path)

    monkeypatch.setattr(atomic_file, "write_in", full)
    asked = ("--sensors", "sony-a57", "--illuminants", "D50", "--context")
    assert "No space left" in fails("ocio", *asked, "-o", path)
    after = {file.name: file.read_bytes() for file in tmp_path.rglob("*.[co]*")}
    assert after == before and len(before) == 3 * len(PAIRS) + 1
    assert {file.name for file in tmp_path.iterdir()} == {"show.ocio", "show_raw"}
