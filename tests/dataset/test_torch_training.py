# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The example torch_training.py: what it prints, and its errors in one line."""

import importlib.util
import os
import re
import subprocess
import sys

import numpy as np
import pytest

from dataset.data_sets import write_image

SENSOR = ("--sensor", "samsung-s20fe")
ISO = ("--iso", "1600,3200")


@pytest.fixture(scope="module")
def renders(tmp_path_factory):
    """Return a folder of four smooth renders, so that noise is all that is rough."""
    folder = tmp_path_factory.mktemp("renders")
    y, x = np.mgrid[:80, :96] / 80
    for number in range(4):
        waves = [0.3 + 0.2 * np.sin(3 * x + (k + number) * y + k) for k in range(3)]
        write_image(folder / f"{number}.exr", np.stack(waves, -1).astype(np.float32))
    return folder


@pytest.fixture
def program(repository, monkeypatch):
    """Return the program as a module, with less to do; skip without PyTorch."""
    if importlib.util.find_spec("torch") is None:
        pytest.skip("PyTorch is not installed")
    monkeypatch.syspath_prepend(str(repository / "python" / "examples"))
    import torch_training

    small = {"SIZES": (32, 64), "STEPS": 3, "WARM_UP": 1, "PAIRS": 8, "BATCH": 4}
    for name, value in small.items():
        monkeypatch.setattr(torch_training, name, value)
    monkeypatch.setattr(torch_training, "HELD_OUT", 8)
    yield torch_training
    for name in ("torch_training", "torch_synthesis"):
        sys.modules.pop(name, None)


@pytest.fixture
def run(program, monkeypatch, capsys):
    """Return a function that runs the program and returns what it prints."""

    def main(*words):
        monkeypatch.setattr(sys, "argv", ["torch_training.py", *map(str, words)])
        program.main()
        return capsys.readouterr().out

    return main


def test_throughput_is_printed(run, renders):
    head, sizes, *rows = run(renders, *SENSOR, *ISO, "--crops", "2").splitlines()
    assert head.startswith("samsung-s20fe: batches of 4 pairs, 2 workers, 2 crops a")
    assert sizes.split() == ["crops", "of", "32", "crops", "of", "64"]
    names = [re.split("  +", row)[0] for row in rows]
    assert [name.split(",")[0] for name in names] == [
        "frames per CPU second",
        "megapixels per CPU second",
        "frames per CPU second",
        "CPU ms per batch",
        "CPU ms per batch",
        "CPU ms per training step",
        "share of training that waits for data",
        "share that waits",
    ]
    for row in rows:
        small, large = re.findall(r" ([0-9.]+)(?: %)?(?= |$)", row)[-2:]
        assert float(small) >= 0 and float(large) >= 0


def test_training_takes_noise_out(run, renders, program, monkeypatch):
    monkeypatch.setattr(program, "WIDTH", 8)
    monkeypatch.setattr(program, "SIZES", (32,))
    out = run(renders, *SENSOR, *ISO, "--train", "250", "--workers", "0")
    assert out.startswith("step 50: mean squared error ")
    last = out.splitlines()[-1]
    found = re.fullmatch(
        r"8 crops of 1 held-out renders: PSNR (.*) dB noisy, (.*) dB denoised", last
    )
    assert float(found[2]) > float(found[1]) + 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((*SENSOR, *ISO), "FOLDER: no renders (.exr) in this folder"),
        (("--sensor", "kodak", *ISO), 'unknown sensor "kodak"; installed: '),
        (("--sensor", "canon-600d", *ISO), "sensor canon-600d has no measured noise"),
        ((*SENSOR, *ISO, "--train", "1"), "--train needs two renders or more"),
        ((*SENSOR, *ISO, "--workers", "-1"), "num_workers"),
    ],
)
def test_errors_are_one_line(run, program, renders, tmp_path, words, message):
    if not message.startswith("FOLDER"):
        (tmp_path / "one.exr").symlink_to(renders / "0.exr")
    with pytest.raises(SystemExit) as stop:
        run(tmp_path, *words)
    said = str(stop.value.code)
    assert said.startswith("torch_training.py: ") and "\n" not in said
    assert message.replace("FOLDER", str(tmp_path)) in said


def test_missing_torch_is_said_in_one_line(repository, tmp_path):
    (tmp_path / "torch.py").write_text("raise ModuleNotFoundError('torch')\n")
    done = subprocess.run(
        [sys.executable, repository / "python/examples/torch_training.py"],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr == (
        "torch_training.py: PyTorch is not installed: pip install torch\n"
    )
