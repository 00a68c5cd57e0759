# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""scripts/mutants: which faults it plants, and that it knows seen ones from others."""

import importlib.util
import os
import subprocess
import sys

import pytest


def script(repository, name):
    """Return a module of scripts/."""
    path = repository / "scripts" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def mutations(repository):
    return script(repository, "mutation_operators").mutations


# Sources, and all that takes the place of their text.
FAULTS = {
    "a < b": ["a <= b"],
    "a + b * c": ["a - b * c", "a + b / c"],
    "(a) + (b)": ["(a) - (b)"],
    "a is not None": ["a is None"],
    "a and b or c": ["a or b or c", "a and b and c"],
    "x = not a": ["x =  a"],
    "x = -1": ["x = 1", "x = -2"],
    "x = 0.5, True": ["x = 1.5, True", "x = 0.5, False"],
    "x += 1": ["x -= 1", "x += 2"],
    "x = y if z else w": ["x = y if not (z) else w"],
    "x = [y for y in z if y]": ["x = [y for y in z if not (y)]"],
    "x = np.min(a, axis=b)": ["x = np.max(a, axis=b)", "x = np.min(a, )"],
    "f(a, b=c, d=e)": ["pass", "f(a,  d=e)", "f(a, b=c, )"],
    "zip(a, b, strict=True)": ["pass"],
    "while a:\n    break": ["while not (a):\n    break", "while a:\n    continue"],
    "def f():\n    return a": ["def f():\n    return None"],
    "def f():\n    raise a": ["def f():\n    pass"],
    'def f(x: "a < b" = c) -> 1:\n    "1 + 1"': [],
    'x = f"{a + 1} {b:3}"': [],
    "if TYPE_CHECKING:\n    import a": [],
}


@pytest.mark.parametrize("source", FAULTS)
def test_faults_of_a_source(mutations, source):
    text = source.encode()
    found = [one.apply(text).decode() for one in mutations(text)]
    assert found == FAULTS[source] or sorted(found) == sorted(FAULTS[source])
    assert all(one.compiles(text) for one in mutations(text))


def test_lines_that_decide_which_tests_run_a_fault(mutations):
    """Those of the statement up to the fault; None for what runs at import."""
    source = b"A = 1\ndef f(x=2):\n    y = (\n        3 +\n        x)\n    return y\n"
    found = {one.text: (one.line, one.lines) for one in mutations(source)}
    assert found["2"] == (1, None) and found["3"] == (2, None)
    assert found["4"] == (4, range(3, 5)) and found["-"] == (4, range(3, 6))
    assert found["None"] == (6, range(6, 7))


def run(repository, *words, **variables):
    environment = os.environ | {"TERM": "dumb", **variables}
    return subprocess.run(
        [sys.executable, repository / "scripts/mutants.py", *words],
        env=environment,
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["tests"], "tests: no Python source of python/cg2raw or ocio/cg2raw_ocio"),
        (["--changed", "no-such-revision"], "no-such-revision"),
    ],
)
def test_what_it_cannot_change_is_one_line(repository, words, said):
    pytest.importorskip("coverage")
    done = run(repository, *words)
    assert done.returncode == 1 and said in done.stderr
    assert done.stderr.startswith("mutants: ") and done.stderr.count("\n") == 1


@pytest.mark.slow
def test_seen_and_unseen_faults_are_told_apart_and_kept(repository, tmp_path):
    pytest.importorskip("coverage")
    source = repository / "python/cg2raw/near_words.py"
    before = source.read_bytes()
    words = ["python/cg2raw/near_words.py", "-n", "5", "--seed", "1", "--kept"]
    words += [tmp_path / "kept", "--tests", "tests/python/test_near_words.py"]
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    done = run(repository, *words, "--least", "1.0", TMPDIR=str(scratch))
    verdicts = [line for line in done.stdout.splitlines() if line.endswith(" s)")]
    seen = [line for line in verdicts if "tests/python/test_near_words.py::" in line]
    unseen = [line for line in verdicts if " survived (" in line or "no test (" in line]
    assert len(seen) + len(unseen) == len(verdicts) == 5
    assert seen, done.stdout + done.stderr
    assert f"5 faults, {len(unseen)} unseen" in done.stdout
    assert done.returncode == (1 if unseen else 0)
    assert source.read_bytes() == before and not list(scratch.iterdir())
    again = run(repository, *words, "--least", "0.0", TMPDIR=str(scratch))
    assert again.returncode == 0 and " s)" not in again.stdout
    assert again.stdout.splitlines() == [
        line for line in done.stdout.splitlines() if line not in verdicts
    ]


def test_what_a_module_says_once_meets_the_tests_of_its_folder(repository):
    found = object.__new__(script(repository, "mutants").Coverage)
    a, b, c = (f"tests/{name}.py::test" for name in ("io/test_a", "io/test_b", "c"))
    found.lines = {
        "cg2raw/io/a.py": {a: [3, 4]},
        "cg2raw/io/b.py": {b: [1]},
        "cg2raw/cli/c.py": {c: [1]},
    }
    found.seconds = {a: 2.0, b: 1.0, c: 0.1}
    source = "python/cg2raw/io/a.py"
    assert found.tests_of(source, range(4, 6)) == [a]
    assert found.tests_of(source, range(6, 7)) == []
    assert found.tests_of(source, None) == [b, a]
