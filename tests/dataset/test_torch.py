# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The PyTorch examples of the documentation, run."""

import sys

import numpy as np
import pytest

from dataset.data_sets import rows
from python.commands import run

torch = pytest.importorskip("torch", reason="PyTorch is not installed")


@pytest.fixture(autouse=True)
def examples(repository, monkeypatch):
    """Let the examples be imported, here and in a loader's processes."""
    monkeypatch.syspath_prepend(str(repository / "python" / "examples"))
    yield
    for name in ("torch_dataset", "torch_synthesis"):
        sys.modules.pop(name, None)


def batches(data):
    """Return the batches of a DataLoader with two processes."""
    return list(torch.utils.data.DataLoader(data, batch_size=2, num_workers=2))


@pytest.mark.parametrize("kind", ["float32", "uint16"])
def test_a_data_set_is_read_back(images, tmp_path, kind):
    from torch_dataset import RawPairs

    words = "--sensors samsung-s20fe --illuminants 1 --iso clean,400 --format npy"
    run("dataset", images, tmp_path / "out", *words.split(), "--type", kind)
    data = RawPairs(tmp_path / "out")
    noisy = [row for row in rows(tmp_path / "out") if row["iso"]]
    assert len(data) == len(noisy) == 5
    for index, row in enumerate(noisy):
        item = data[index]
        planes = np.load(tmp_path / "out" / row["path"])
        scale = 1 if kind == "float32" else np.float32(65535)
        assert np.array_equal(item["noisy"].numpy(), planes / scale)
        assert item["neutral"].tolist() == pytest.approx(row["neutral"])
    first, *_ = batches(data)
    assert first["noisy"].shape == first["clean"].shape == (2, 4, 12, 18)
    assert not torch.equal(first["noisy"], first["clean"])


def test_pairs_are_synthesised_while_training(images):
    from torch_synthesis import SynthesisedPairs

    data = SynthesisedPairs(sorted(images.glob("*.exr")), "samsung-s20fe", size=16)
    first, again = batches(data), batches(data)
    assert first[0]["noisy"].shape == (2, 4, 8, 8)
    assert torch.equal(first[0]["noisy"], again[0]["noisy"])  # whoever makes it
    data.epoch = 1
    assert not torch.equal(batches(data)[0]["neutral"], first[0]["neutral"])
