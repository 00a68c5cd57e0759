# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The PyTorch examples of the documentation, run."""

import sys

import numpy as np
import pytest

import cg2raw
from cg2raw.io.image_file import read_image
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


def batches(data, workers=2):
    """Return the batches of a DataLoader with so many processes."""
    return list(torch.utils.data.DataLoader(data, batch_size=2, num_workers=workers))


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


@pytest.fixture
def synthesised(images):
    """Return a function that makes the dataset of the four EXRs."""
    from torch_synthesis import SynthesisedPairs, renders_in

    def make(sensor="samsung-s20fe", *, size=16, crops=4, **options):
        paths = renders_in(images, size)
        return SynthesisedPairs(paths, sensor, size=size, crops=crops, **options)

    return make


def same(one, other):
    """Return whether two batches are the same."""
    return all(torch.equal(one[name], other[name]) for name in one)


def test_batches_do_not_depend_on_the_number_of_workers(synthesised):
    data = synthesised(epochs=2, cached=2)
    alone = batches(data, 0)
    assert len(alone) == len(data) / 2 == 16
    for workers in (1, 2):
        assert all(map(same, batches(data, workers), alone))
    assert alone[0]["noisy"].shape == (2, 4, 8, 8)
    assert {value.dtype for value in alone[0].values()} == {torch.float32}
    assert not any(map(same, alone[:8], alone[8:]))  # another epoch, other draws
    assert not same(batches(synthesised(seed=1), 0)[0], alone[0])


@pytest.mark.parametrize("sensor", ["samsung-s20fe", "canon-70d", "nikon-d850"])
def test_planes_are_those_of_simulate(synthesised, sensor):
    data = synthesised(sensor, isos=(400, 1600), noise="gaussian", convention="sensor")
    camera = cg2raw.Sensor(sensor)
    path, place, iso, run = data.recipe(5)
    y, x = (place * (9, 21)).astype(int)  # the images have 24 x 36 pixels
    scene = read_image(path, undo="stated").pixels[y : y + 16, x : x + 16]
    item = data[5]
    assert item["iso"] == iso and iso in (400, 1600) and run["convention"] == "sensor"
    for name, options in (("noisy", {"iso": iso, "noise": "gaussian"}), ("clean", {})):
        raw = camera.simulate(scene, **options, **run)
        signal = camera.signal_from_raw(raw)
        sites = [signal[row::2, col::2] for row in (0, 1) for col in (0, 1)]
        red = camera.cfa.index("R")
        order = (red, red ^ 1, red ^ 2, red ^ 3)  # R, G of its row, other G, B
        assert np.array_equal(item[name].numpy(), np.stack([sites[i] for i in order]))
    light = camera.illuminant(run["illuminant"])
    assert item["neutral"].tolist() == pytest.approx(light.neutral)
    matrix = camera.camera_from_xyz(light.xy)
    assert item["camera_from_xyz"].numpy() == pytest.approx(matrix, rel=1e-6)


def test_an_epoch_has_each_image_as_often(synthesised):
    data = synthesised(crops=6, epochs=3, cached=2)
    orders = [data.order_of(epoch).tolist() for epoch in range(3)]
    assert all(sorted(order) == sorted([*range(4)] * 6) for order in orders)
    assert orders[0] != orders[1]
    with pytest.raises(IndexError):
        data[len(data)]


@pytest.mark.parametrize(("cached", "most"), [(4, 4), (2, 16)])
def test_few_files_are_decoded_again(synthesised, monkeypatch, cached, most):
    """Two epochs of four images: once each, if the process keeps them all."""
    decoded = []

    def read(path, undo):
        decoded.append(path)
        return read_image(path, undo=undo)

    monkeypatch.setattr("torch_synthesis.read_image", read)
    data = synthesised(crops=32, epochs=2, cached=cached)
    for number in range(len(data)):
        data.image(data.recipe(number)[0])
        assert len(data.images) <= cached
    assert 4 <= len(decoded) <= most


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": 15}, "size 15 of a crop must be even"),
        ({"size": 26}, "36x24 pixels, the crops have 26"),
        ({"sensor": "fujifilm-x-m1"}, "fujifilm-x-m1: its CFA is not Bayer"),
        ({"sensor": "canon-600d"}, "canon-600d has no measured noise"),
        ({"sensor": "canon"}, 'unknown sensor "canon"'),
        ({"isos": (100, 1e6)}, r"1e\+06 is outside 50 to 6400"),
    ],
)
def test_what_cannot_be_synthesised(synthesised, options, message):
    with pytest.raises(ValueError, match=message):
        synthesised(**options)


def test_a_folder_without_renders(tmp_path):
    from torch_synthesis import renders_in

    with pytest.raises(ValueError, match="no renders"):
        renders_in(tmp_path, 16)
