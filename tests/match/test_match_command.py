# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw match: from folders to match.json, a page, or one line that says why not."""

import json
import re
import sys
from types import SimpleNamespace

import numpy as np
import OpenImageIO as oiio
import pytest

from cg2raw import Sensor, __version__, write_dng
from cg2raw.cli.match import iso_of
from cg2raw.match import captures_in
from cg2raw.match.frame import REC709
from match.match_sets import scene
from oracles import cameras
from python.commands import fails, run

SENSOR, COUNT = "canon-700d", 10


def write_exr(path, image):
    """Write an image of floats."""
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), oiio.ImageSpec(image.shape[1], image.shape[0], 3, "float"))
    assert output.write_image(np.ascontiguousarray(image, np.float32))
    output.close()


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Return a folder with captures/ of exposure 2 and 3 by turns, renders/ of the same
    scenes, and empty/."""
    folder = tmp_path_factory.mktemp("match")
    sensor, rng = Sensor(SENSOR), np.random.default_rng(1)
    for name in ("captures", "renders/inside", "empty"):
        (folder / name).mkdir(parents=True)
    for index in range(COUNT):
        image = scene(rng, 0.5, shape=(96, 144))
        write_exr(folder / "renders/inside" / f"{index}.exr", image)
        write_dng(
            folder / "captures" / f"{COUNT - index}.dng",
            sensor.simulate(
                image * np.float32(4 * 2 ** (index % 2)),
                illuminant=f"{3000 + 300 * index}K",
                iso=400,
                frame=index,
            ),
        )
    (folder / "captures" / "1.jpg").write_bytes(b"a camera's own picture beside it")
    return folder


def words(folders, *more, captures="captures", renders="renders", sensor=SENSOR):
    """Return a command line."""
    return "match", folders / captures, folders / renders, "-s", sensor, *more


def test_what_is_printed_and_written(folders, tmp_path):
    output, page = tmp_path / "match.json", tmp_path / "page"
    done = run(*words(folders, "-o", output, "--report", page, "--white-balance"))
    assert (done.code, done.err) == (0, ""), done.err
    lines = done.out.splitlines()
    assert "10 captures, 10 renders, " in lines[0] and lines[0].endswith(
        "scene of a render"
    )
    assert re.match(r"Add \+2\.[45]\d stops to your renders \(", lines[1])
    darker = re.compile(r"The middles of your renders are 2\.\d stops darker\.")
    assert any(darker.fullmatch(line) for line in lines)
    assert lines[-2:] == [f"wrote {output}", f"wrote {page / 'match.html'}"]
    text = (page / "match.html").read_text()
    assert "stops darker" in text and text.count("<figure>") == 8
    written = json.loads(output.read_text())
    assert list(written) == [
        *("cg2raw_match", "cg2raw", "sensor", "exposure", "levels", "white_balance"),
        *("captures", "renders", "uncertainty"),
    ]
    assert (written["cg2raw_match"], written["cg2raw"]) == (1, __version__)
    assert (written["sensor"], written["captures"]) == (SENSOR, COUNT)
    exposure = written["exposure"]
    assert exposure["median"] == pytest.approx(2.5, abs=0.05)
    assert exposure["spread"] == pytest.approx(0.5, abs=0.05)
    ends = [exposure["quantiles"][i] for i in (0, -1)]
    assert np.array(ends) == pytest.approx(np.array([[0, 2], [1, 3]]), abs=0.05)
    for name in ("red", "blue"):
        assert abs(written["white_balance"][name]["median"]) < 0.1
    low, high = written["uncertainty"]["exposure"]["median"]
    assert low < 2.5 < high and written["uncertainty"]["confidence"] == 0.99


def test_renders_get_the_levels_of_captures_by_what_is_written(folders, tmp_path):
    """Exposures that are drawn lie within those of the captures."""
    output = tmp_path / "match.json"
    assert run(*words(folders, "-o", output, "--quiet")).code == 0
    levels = json.loads(output.read_text())["levels"]
    options = ("--illuminant", "D65", "--sensor", SENSOR, "--json")
    found = []
    for index in range(COUNT):
        render, dng = folders / f"renders/inside/{index}.exr", tmp_path / "1.dng"
        done = run(
            "convert", render, "-o", dng, *options, "--exposure", f"match:{output}"
        )
        assert done.code == 0, done
        stops = json.loads(done.out)["files"][0]["exposure"]["stops"]
        image = np.asarray(oiio.ImageInput.open(str(render)).read_image("float"))
        found.append(stops + np.log2(np.median(image @ REC709)))
    captured = [stops for _, stops in levels["captures"]]
    for of in (np.min, np.mean, np.max):
        assert of(found) == pytest.approx(of(captured), abs=0.15)
    drawn = f"match:{output}:draw"
    done = run("convert", render, "-o", dng, *options, "--exposure", drawn)
    assert 1.9 < json.loads(done.out)["files"][0]["exposure"]["stops"] < 3.1
    other = (*options[:2], "--sensor", "nikon-d40")
    line = fails("convert", render, "-o", dng, *other, "--exposure", drawn)
    assert "run cg2raw match --sensor nikon-d40" in line


def test_json_has_the_table_and_is_the_same_for_any_number_of_workers(folders):
    one, two = (run(*words(folders, "--json", "--workers", n)) for n in (1, 3))
    assert one.out == two.out
    found = json.loads(one.out)
    assert {"exposure", "table", "notes"} <= set(found)
    row = next(row for row in found["table"] if row["name"] == "clipped samples")
    assert row["unit"] == "%" and row["captures"] > row["renders"]
    assert "white_balance" not in found


def test_a_match_on_stdout_and_quiet(folders):
    done = run(*words(folders, "-o", "-"))
    assert json.loads(done.out)["cg2raw_match"] == 1
    assert re.search(r"Add \+2\.[45]", done.err)
    done = run(*words(folders, "--quiet"))
    assert (done.code, done.out, done.err) == (0, "", "")


def test_links_to_folders_lead_to_each_frame_once(tmp_path):
    inside = tmp_path / "inside"
    inside.mkdir()
    for name in ("one.dng", ".hidden.dng"):
        (inside / name).write_bytes(b"")
    (inside / "round").symlink_to(tmp_path)
    (tmp_path / "again").symlink_to(inside)
    assert captures_in([str(tmp_path)]) == [str(tmp_path / "again/one.dng")]


@pytest.mark.parametrize("stops", [-12, 9])
def test_renders_in_other_units_are_seen_at_their_level(folders, tmp_path, stops):
    """As of light in cd/m2, far above white, or far below the black level's error."""
    for index in range(COUNT):
        path = str(folders / "renders/inside" / f"{index}.exr")
        image = np.asarray(oiio.ImageInput.open(path).read_image("float"))
        write_exr(tmp_path / f"{index}.exr", image * 2.0**stops)
    done = run("match", folders / "captures", tmp_path, "-s", SENSOR, "--json")
    found = json.loads(done.out)
    assert found["exposure"]["median"] == pytest.approx(2.5 - stops, abs=0.1)
    assert found["uncertainty"]["scenes"] == COUNT


def test_renders_without_noise_say_so(folders, tmp_path):
    profile = json.loads(Sensor(SENSOR).to_json())
    del profile["noise"]
    (tmp_path / "quiet.json").write_text(json.dumps(profile))
    done = run(*words(folders, sensor=tmp_path / "quiet.json"))
    assert "They are without noise." in done.out
    assert "The middles of your renders" in done.out
    assert "note: renders are without noise" in done.out


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"captures": "empty"}, "empty: holds no captures: give the camera's own RAW"),
        ({"renders": "empty"}, "empty: holds no renders: give"),
        ({"captures": "gone"}, "gone: No such file"),
        ({"captures": "renders"}, "renders: holds no captures"),
        ({"renders": "captures"}, "captures: holds RAW files, and no renders"),
        ({"captures": "captures/1.dng"}, "1 capture: an exposure is inferred from 10"),
        ({"captures": "captures/1.jpg"}, "1.jpg: is a developed picture, not RAW"),
        ({"renders": "renders/inside/1.exr"}, "1 render: an exposure is inferred"),
        ({"sensor": "sony-a7s-ii"}, "is of a Canon EOS 700D, sony-a7s-ii is the SONY"),
        ({"sensor": "canon-70d"}, "give captures of that camera, or a profile"),
    ],
)
def test_bad_input_is_one_line_with_the_remedy(folders, changed, said, tmp_path):
    output = tmp_path / "match.json"
    assert said in fails(*words(folders, "-o", output, **changed))
    assert not output.exists()


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--illuminant", "moonshine"), "unknown illuminant moonshine"),
        (("--iso", "1e6"), "is outside 50 to 12800"),
        (("-o", "match.txt"), "must end in .json"),
        (("--workers", "0"), "must be at least 1"),
        (("--report", "/nowhere/page"), "there is no folder /nowhere"),
    ],
)
def test_bad_options_are_said_before_any_frame_is_read(folders, more, said):
    assert said in fails(*words(folders, *more, captures="gone"))


def test_a_missing_library_is_named(folders, monkeypatch):
    for name in [n for n in sys.modules if n.startswith("cg2raw.match")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    line = fails(*words(folders))
    assert "needs scipy.optimize: pip install 'cg2raw[diagnose]'" in line


@pytest.mark.parametrize(
    ("sensor", "asked", "stated", "iso"),
    [
        (SENSOR, None, [100, 800, None, 400], 400),
        (SENSOR, 200, [800], 200),
        (SENSOR, None, [None], None),
        (SENSOR, None, [409600], None),  # whose noise nobody knows
        ("nikon-d40", None, [400], None),  # nor any of this sensor's
    ],
)
def test_renders_have_the_noise_of_the_captures_iso(sensor, asked, stated, iso):
    captures = [SimpleNamespace(iso=one) for one in stated]
    assert iso_of(SimpleNamespace(iso=asked), Sensor(sensor), captures) == iso


def test_developed_pictures_are_no_captures(folders, tmp_path):
    (tmp_path / "one.JPG").write_bytes(b"")
    line = fails("match", tmp_path, folders / "renders", "-s", SENSOR)
    assert "holds developed pictures (one.JPG), and no RAW: give the camera's" in line


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"cfa": "bggr"}, "its CFA is RGGB, that of test BGGR"),
        ({"white_level": 8000}, "tags say white level 15303 DN, test 8000 DN"),
    ],
)
def test_captures_of_another_sensor_under_the_same_name(
    folders, fields, said, tmp_path
):
    profile = json.loads(Sensor(SENSOR).to_json()) | fields | {"id": "test"}
    (tmp_path / "test.json").write_text(json.dumps(profile))
    assert said in fails(*words(folders, sensor=tmp_path / "test.json"))


def test_black_captures_tell_nothing(folders, tmp_path):
    sensor = Sensor(SENSOR)
    black = sensor.simulate(np.zeros((96, 144, 3), np.float32), illuminant="D65")
    for index in range(COUNT):
        write_dng(tmp_path / f"{index}.dng", black)
    line = fails("match", tmp_path, folders / "renders", "-s", SENSOR)
    assert "the middle of most captures is clipped or black" in line


def test_captures_without_a_white_balance_are_grey_in_the_mean(folders, monkeypatch):
    from dataclasses import replace

    from cg2raw.io import raw_file
    from cg2raw.match import captures

    def without(path):
        file = raw_file.open_raw(path)
        return replace(file, header=replace(file.header, as_shot=None))

    monkeypatch.setattr(captures, "open_raw", without)
    done = run(*words(folders))
    assert "10 of 10 captures state no white balance" in done.out
    assert re.search(r"Add \+2\.[45]\d? stops", done.out)


def test_a_sensor_without_filters(folders, tmp_path):
    (tmp_path / "mono.json").write_text(cameras.mono_text(id="mono"))
    sensor = Sensor(tmp_path / "mono.json")
    (tmp_path / "captures").mkdir()
    for index in range(COUNT):
        path = str(folders / "renders/inside" / f"{index}.exr")
        image = np.asarray(oiio.ImageInput.open(path).read_image("float"))
        write_dng(tmp_path / "captures" / f"{index}.dng", sensor.simulate(image * 2))
    done = run(
        *("match", tmp_path / "captures", folders / "renders"),
        *("-s", tmp_path / "mono.json"),
    )
    assert re.search(r"Add \+(1\.0|0\.99)", done.out), done
