# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What commands print and write, one after the other in a folder, is as it was."""

import re

import numpy as np
import pytest

pytest.importorskip("scipy")
pytest.importorskip("OpenImageIO", reason="OpenImageIO's wheel is not installed")
pytest.importorskip("pyarrow", reason="pyarrow is not installed")

from cg2raw import Sensor, __version__, write_dng
from dataset.data_sets import write_image
from golden import outlines
from match.match_sets import scene
from python.commands import run

CANON, NIKON = "canon-5d-mark-iv", "nikon-d40"
SHOTS = "shots/captures.yaml"
# Name, words, files that it writes. Each finds what those before it wrote.
COMMANDS = {
    "synthesize": (
        f"diagnose synthesize -s {CANON} --effects lens_shading=0.3,row_noise=0.5,"
        "black_level --seed 3 --size 96x80 -o shots",
        ("shots/captures.yaml", "shots/truth.json"),
    ),
    "check": (f"diagnose check {SHOTS}", ()),
    "run": (f"diagnose run {SHOTS} -o report -q", ("report/verdict.json",)),
    "compare": (f"diagnose compare {SHOTS} report/profile.json", ()),
    "calibrate": (
        f"calibrate --darks shots/*dark*.dng --flats shots/*flat*.dng -s {CANON} "
        "-o found.json --report pages",
        ("found.json", "pages/calibration.html"),
    ),
    "profile": (
        "profile captures/*.dng -o made.json --plot made.png",
        ("made.json", "made.png"),
    ),
    "match": (
        f"match captures renders -s {NIKON} -o match.json --report pages",
        ("match.json", "pages/match.html"),
    ),
    "convert": (
        f"convert renders/0.exr renders/1.exr -o dngs -s {NIKON} --illuminant 3200K "
        "--exposure auto --json",
        (),
    ),
    "dataset": (
        f"dataset renders/0.exr renders/1.exr set --sensors {CANON},{NIKON} "
        "--illuminants 2 --seed 5 --exposure random:-1:1 --format npy --patches 1 "
        "--patch-size 32",
        ("set/manifest.jsonl",),
    ),
    "sensors": ("sensors", ()),
    "sensor": (f"sensors {CANON} --plot sensor.png", ("sensor.png",)),
    "effects": ("effects", ()),
    "effect": ("effects lens_shading", ()),
    "ocio": (
        f"ocio --sensors {NIKON} --illuminants A,sample:2 -o raw.ocio",
        ("raw.ocio",),
    ),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory, repository):
    """Return a folder with captures/ and renders/ of ten scenes, in which commands
    run."""
    folder, rng = tmp_path_factory.mktemp("golden"), np.random.default_rng(1)
    for name in ("captures", "renders"):
        (folder / name).mkdir()
    for index in range(10):
        image = np.ascontiguousarray(scene(rng, 0.5, shape=(64, 96)))
        write_image(folder / f"renders/{index}.exr", image)
        light = {"illuminant": f"{3000 + 300 * index}K", "frame": index}
        raw = Sensor(NIKON).simulate(image * np.float32(4 * 2 ** (index % 2)), **light)
        write_dng(folder / f"captures/{index}.dng", raw)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        profiles = repository / "plugins/profiles"
        patch.setenv("CG2RAW_PROFILE_PATH", str(profiles))
        yield folder


def without_what_changes(line, folder):
    """Return a line without where it was run, by which version and how fast."""
    line = line.replace(str(folder), "FOLDER").replace(__version__, "VERSION")
    return re.sub(r"(?<=^seconds: ).*", "TIME", line)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command(name, folder):
    words, files = COMMANDS[name]
    given = [sorted(folder.glob(w)) if "*" in w else [w] for w in words.split()]
    done = run(*(word for some in given for word in some))
    lines = [f"exit code {done.code}", "stdout:", *outlines.of_lines(done.out)]
    lines += ["stderr:", *outlines.of_lines(done.err)]
    for file in files:
        lines += [f"{file}:", *outlines.of_file(folder / file)]
    lines = [without_what_changes(line, folder) for line in lines]
    outlines.check(name, lines)
