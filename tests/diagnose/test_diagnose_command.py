# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw diagnose: options, a report's folder, exit codes. The engine is a fake."""

import json
import re
import sys
import types
from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import ResidualTest
from diagnose import capture_files as files
from diagnose.made_up_diagnosis import made_up_diagnosis
from python.commands import fails, run


@pytest.fixture
def engine(monkeypatch):
    """Replace engine and report by fakes; return what the engine was called with."""
    calls = []

    def diagnose(captures, **options):
        options["progress"]("screening", 0.5)
        calls.append((captures, options))
        return made_up_diagnosis(**engine_result)

    def write_report(found, folder):
        folder.mkdir()
        (folder / "report.html").write_text(f"<h1>{found.verdict}</h1>")
        (folder / "gap.png").write_bytes(b"PNG")

    engine_result = {}
    calls_of = types.SimpleNamespace(calls=calls, result=engine_result)
    monkeypatch.setattr("cg2raw.diagnose.pipeline.diagnose", diagnose)
    monkeypatch.setattr("cg2raw.diagnose.report.write_report", write_report)
    return calls_of


@pytest.fixture
def captures(tmp_path):
    """Return the path of a small manifest."""
    return files.standard_set(tmp_path, 3)


def test_a_report_is_written(engine, captures, tmp_path):
    out = tmp_path / "report"
    done = run("diagnose", "run", captures, "-o", out)
    assert done.code == 0 and done.err == ""
    assert done.out.startswith("verdict   explained: lens_shading, row_noise\n")
    assert "the lens loses 29 % at the corner" in done.out
    assert "0.4113 -> 0.00031 nats/pixel" in done.out
    assert "aberration was not tested" in done.out  # notes
    names = ["gap.png", "profile.json", "report.html", "verdict.json"]
    assert sorted(file.name for file in out.iterdir()) == names
    verdict = json.loads((out / "verdict.json").read_text())
    assert verdict["verdict"] == "explained" and verdict["files"] == names
    [(found, options)] = engine.calls
    assert found.sensor.id == files.SENSOR and len(found.captures) == 3
    del options["progress"]
    assert options == {
        "alpha": 0.01,
        "most": 6,
        "without": (),
        "only": (),
        "time_limit": 600,
        "statistics": None,
    }


def test_options_reach_the_engine(engine, captures, tmp_path):
    base = ("diagnose", "run", captures, "-o", tmp_path / "r")
    words = ("--alpha", "0.05", "--max-effects", "2")
    run(*base, *words, "--exclude", "row_noise, shot_noise")
    options = engine.calls[0][1]
    assert (options["alpha"], options["most"]) == (0.05, 2)
    assert options["without"] == ("row_noise", "shot_noise")
    assert "pixels" not in options  # the engine's own
    run(*base, "--include", "row_noise,lens_shading")
    assert engine.calls[1][1]["only"] == ("row_noise", "lens_shading")
    words = ("--max-pixels", "8192", "--time-limit")
    for text, seconds in (("90", 90), ("90s", 90), ("1.5min", 90), ("2 h", 7200)):
        run(*base, *words, text)
        options = engine.calls[-1][1]
        assert (options["pixels"], options["time_limit"]) == (8192, seconds)


@pytest.mark.parametrize(
    ("verdict", "code"),
    [
        *[("consistent", 0), ("explained", 10), ("ambiguous", 11)],
        *[("partially_explained", 12), ("unexplained", 13), ("incomplete", 14)],
    ],
)
def test_the_verdict_is_the_exit_code(engine, captures, tmp_path, verdict, code):
    engine.result["verdict"] = verdict
    words = ("diagnose", "run", captures, "-o", tmp_path / "r")
    assert run(*words, "--exit-code").code == code
    assert run(*words).code == 0


def test_a_long_rest_is_left_to_the_report(engine, captures, tmp_path):
    tests = [ResidualTest(f"test {n}", 9.0, 1e-9, 0.1, "there") for n in range(9)]
    engine.result.update(verdict="unexplained", unexplained=tests)
    done = run("diagnose", "run", captures, "-o", tmp_path / "r")
    assert "left      test 5: there\nleft      ... and 3 more, in the" in done.out
    assert "test 6" not in done.out


@pytest.mark.parametrize(
    ("name", "code", "words"),
    [
        ("interrupted", 130, "interrupted; the report is partial"),
        ("time_limit_reached", 0, "the time limit ended the diagnosis"),
    ],
)
def test_what_came_in_between_is_told(engine, captures, tmp_path, name, code, words):
    engine.result.update({name: True, "verdict": "incomplete"})
    command = ("diagnose", "run", captures, "-o", tmp_path / "r")
    assert run(*command, "--exit-code").code == 14
    done = run(*command)
    assert done.code == code and words in done.out + done.err
    assert json.loads((tmp_path / "r" / "verdict.json").read_text())[name]


def test_a_report_is_replaced_as_a_whole(engine, captures, tmp_path):
    out = tmp_path / "r"
    run("diagnose", "run", captures, "-o", out)
    engine.result["profile_json"] = ""
    assert run("diagnose", "run", captures, "-o", out, "--quiet").out == ""
    names = {file.name for file in out.iterdir()}
    assert names == {"gap.png", "report.html", "verdict.json"}
    assert not list(tmp_path.glob(".cg2raw*"))


def test_other_files_are_never_lost(engine, captures, tmp_path):
    out = tmp_path / "r"
    run("diagnose", "run", captures, "-o", out)
    (out / "mask.png").write_bytes(b"mine")
    assert "holds mask.png, which is of no report" in fails(
        "diagnose", "run", captures, "-o", out
    )
    assert len(engine.calls) == 1  # told before the work
    assert "holds captures.yaml" in fails("diagnose", "run", captures, "-o", tmp_path)
    assert run("diagnose", "run", captures, "-o", out, "--overwrite").code == 0
    assert (out / "mask.png").read_bytes() == b"mine"
    assert (out / "report.html").exists()


def test_a_file_that_comes_while_it_works_is_not_lost(
    engine, captures, tmp_path, monkeypatch
):
    out = tmp_path / "r"
    run("diagnose", "run", captures, "-o", out)

    def write_report(found, folder):
        folder.mkdir()
        (out / "late.txt").write_text("mine")

    monkeypatch.setattr("cg2raw.diagnose.report.write_report", write_report)
    assert "late.txt" in fails("diagnose", "run", captures, "-o", out)
    assert (out / "late.txt").read_text() == "mine"


def test_profiles_are_compared(engine, captures, tmp_path):
    engine.result["verdict"] = "consistent"
    profile = tmp_path / "profile.json"
    profile.write_text(files.other_sensor(black_level=[66] * 4).to_json())
    words = ("diagnose", "compare", captures, profile, files.SENSOR)
    done = run(*words)
    assert done.code == 0
    rows = [line.split()[0] for line in done.out.splitlines()[1:4]]
    assert rows == [files.SENSOR, str(profile), files.SENSOR]
    assert [options["most"] for _, options in engine.calls] == [0, 0, 0]
    assert [c.sensor.black_level[0] for c, _ in engine.calls] == [64, 66, 64]
    said = json.loads(run(*words, "--json").out)
    assert [one["sensor"] for one in said["sensors"]] == rows
    assert said["sensors"][1]["gap"] == 0.4113
    engine.result["interrupted"] = True
    assert run(*words).code == 130


@pytest.mark.parametrize(
    ("nats", "verdict"), [(3e-4, "consistent"), (5e-4, "unexplained")]
)
def test_a_trace_of_what_was_closed_is_consistent(
    engine, captures, tmp_path, monkeypatch, nats, verdict
):
    profile = tmp_path / "profile.json"
    profile.write_text(files.other_sensor(black_level=[66] * 4).to_json())
    test = ResidualTest("kurtosis", 4.1, 1e-5, nats, "tails")
    given = made_up_diagnosis(verdict="unexplained", unexplained=[test])
    results = [
        replace(given, gap=replace(given.gap, before=before)) for before in (0.41, 0.01)
    ]
    monkeypatch.setattr(
        "cg2raw.diagnose.pipeline.diagnose", lambda *_, **__: results.pop(0)
    )
    done = run("diagnose", "compare", captures, profile, "--json")
    assert json.loads(done.out)["sensors"][1]["verdict"] == verdict


def test_json_is_all_of_stdout_and_verbose_all_of_stderr(engine, captures, tmp_path):
    out = tmp_path / "r"
    done = run("diagnose", "run", captures, "-o", out, "--json", "-v")
    assert done.out == (out / "verdict.json").read_text()
    stage, why, *_ = done.err.splitlines()
    assert stage == "screening" and why.startswith("why       lens_shading: ")
    done = run("diagnose", "run", captures, "-o", out, "--quiet", "-vv")
    assert done.out == "" and re.match(r" +\d+\.\d s  screening\n", done.err)


def test_without_a_command_run_is_meant(engine, captures, tmp_path):
    assert run("diagnose", captures, "-o", tmp_path / "r").code == 0
    assert run("diagnose", "--quiet", captures, "-o", tmp_path / "r").out == ""
    assert "{" not in fails("diagnose", code=2)


def test_a_check_says_once_what_holds_for_many_frames(tmp_path):
    rng = np.random.default_rng(2)
    for index in range(5):
        away = 20 if index == 0 else 0
        raw = np.rint(rng.normal(3 + away, 4, files.SHAPE)).clip(0)
        np.save(tmp_path / f"{index}.npy", raw.astype(np.uint16))
    lines = [f"{{file: {n}.npy, kind: dark, temperature: -5}}" for n in range(5)]
    path = files.manifest(tmp_path, lines)
    done = run("diagnose", "check", path)
    assert done.code == 1 and "  -5 C  " in done.out
    assert "note      1.npy, 2.npy, 3.npy and 1 more: more than 1% of" in done.out
    assert "wrong     0.npy: the first of 5 repeats is +" in done.out
    assert "nothing is wrong" not in done.out
    said = json.loads(run("diagnose", "check", path, "--json").out)
    assert [one["name"] for one in said["frames"]] == [f"{n}.npy" for n in range(5)]
    assert said["frames"][0]["temperature"] == -5 and len(said["wrong"]) == 1


def test_a_check_looks_at_pixels_alone(tmp_path):
    path = files.standard_set(tmp_path)
    done = run("diagnose", "check", path)
    assert done.code == 0 and done.out.splitlines()[-1] == "nothing is wrong"
    rows = [line.split() for line in done.out.splitlines()[2:11]]
    assert [row[0] for row in rows][::4] == ["dark_0.dng", "flat_1.dng", "shot_2.dng"]
    assert rows[0][1:5] == ["dark", "100", "0.5", "s"] and rows[4][3] == "-"
    line = "{file: shot_0.dng, kind: scene, scene: render_1.npy}"
    done = run("diagnose", "check", files.manifest(tmp_path, [line]))
    assert done.code == 1 and "the scene does not correspond" in done.out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("-o", "r"), "x.yaml: No such file"),
        (("-o", "no/r"), "-o no/r: there is no folder"),
        (("-o", "file"), "-o file: is a file; name a folder"),
        (("-o", "r", "--exclude", "row_nois"), "did you mean row_noise?"),
        (("-o", "r", "--include", "fog"), 'no diagnosis names "fog": they are '),
    ],
)
def test_what_is_not_there_is_one_line(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    assert message in fails("diagnose", "run", "x.yaml", *words)


@pytest.mark.parametrize(
    "words",
    [
        "run c.yaml",
        "run -o r",
        "run c.yaml -o r --alpha 1",
        "run c.yaml -o r --alpha 0",
        "run c.yaml -o r --max-effects 0",
        "run c.yaml -o r --max-pixels 10",
        "run c.yaml -o r --time-limit 0",
        "run c.yaml -o r --time-limit soon",
        "run c.yaml -o r --include prnu --exclude prnu",
        "check",
        "check c.yaml -o r",
        "compare c.yaml",
        "compare c.yaml p.json --exit-code",
        "synthesize -s nikon-d40 -o r",
        "synthesize -s nikon-d40 --effects blur --seed x -o r",
    ],
)
def test_usage(words):
    line = fails("diagnose", *words.split(), code=2)
    assert line.startswith(("cg2raw diagnose ", "cg2raw: error: unrecognized"))


def test_a_bad_manifest_is_one_line(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_text("sensor: nikon-d40\nframes: [{file: x.dng, kind: dark}]\n")
    line = fails("diagnose", "run", path, "-o", tmp_path / "r")
    assert line.startswith(f'cg2raw diagnose run: {path}:2: frames[0].file is "x.dng"')
    assert not (tmp_path / "r").exists()


def test_a_missing_library_is_named(captures, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "cg2raw.diagnose.pipeline", None)
    line = fails("diagnose", "run", captures, "-o", tmp_path / "r")
    assert "needs cg2raw.diagnose.pipeline: pip install 'cg2raw[diagnose]'" in line
