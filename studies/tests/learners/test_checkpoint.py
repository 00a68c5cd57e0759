# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A checkpoint is whole, of its key, or none."""

import os

import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

from studies.learners.checkpoint import Checkpoint  # noqa: E402

STATE = {"step": 7, "curve": [{"step": 0, "colours": 0.5}], "weights": torch.ones(3)}


def test_a_state_comes_back_for_its_key_alone(tmp_path):
    path = tmp_path / "deep" / "a.pt"
    assert Checkpoint(path, "one").read() is None
    Checkpoint(path, "one").write(STATE)
    found = Checkpoint(path, "one").read()
    assert found["step"] == 7 and found["curve"] == STATE["curve"]
    assert torch.equal(found["weights"], STATE["weights"])
    assert Checkpoint(path, "other").read() is None
    assert os.listdir(path.parent) == ["a.pt"]


def test_a_write_that_fails_leaves_the_earlier_state(tmp_path, monkeypatch):
    checkpoint = Checkpoint(tmp_path / "a.pt", "one")
    checkpoint.write(STATE)

    def stopped(state, path):
        path.write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(torch, "save", stopped)
    with pytest.raises(KeyboardInterrupt):
        checkpoint.write({"step": 8})
    assert checkpoint.read()["step"] == 7


@pytest.mark.parametrize("content", [b"", b"no checkpoint", b"PK\x03\x04 cut off"])
def test_another_file_is_named(tmp_path, content):
    path = tmp_path / "a.pt"
    path.write_bytes(content)
    with pytest.raises(ValueError, match="a.pt: is no checkpoint"):
        Checkpoint(path, "one").read()


def test_a_file_of_something_else_is_named(tmp_path):
    torch.save([1, 2], tmp_path / "a.pt")
    with pytest.raises(ValueError, match="is no checkpoint"):
        Checkpoint(tmp_path / "a.pt", "one").read()
