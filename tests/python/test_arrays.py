# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What goes in and out of the API: types, copies, and other threads meanwhile."""

import threading
import tracemalloc

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from cg2raw.calibration import UniformFrame
from cg2raw.io import raw_file

HALVES = np.arange(2**16, dtype=np.uint16).view(np.float16)


@pytest.fixture(scope="module")
def sensor():
    return cg2raw.Sensor("canon-5d-mark-iv")


def test_every_half_float_is_itself(sensor):
    """Camera RGB makes NaN 0 and clamps infinities to 1e6; all else passes."""
    halves = np.repeat(HALVES.reshape(256, 256, 1), 3, axis=2)
    seen = cg2raw.mosaic(halves, "RGGB")
    with np.errstate(invalid="ignore"):
        expected = HALVES.reshape(256, 256).astype(np.float32)
    expected = np.clip(
        np.nan_to_num(expected, nan=0.0, posinf=1e6, neginf=-1e6), -1e6, 1e6
    )
    np.testing.assert_array_equal(seen, expected)


VIEWS = {
    "as it is": lambda image: image,
    "RGBA": lambda image: np.dstack([image, image[..., :1]]),
    "RGB of RGBA": lambda image: np.dstack([image, image[..., :1]])[..., :3],
    "upside down": lambda image: image[::-1].copy()[::-1],
    "every other column": lambda image: np.repeat(image, 2, axis=1)[:, ::2],
    "planes": lambda image: np.moveaxis(np.moveaxis(image, -1, 0).copy(), 0, -1),
    "Fortran": np.asfortranarray,
    "big-endian": lambda image: image.astype(image.dtype.newbyteorder(">")),
    "read-only": lambda image: np.frombuffer(image.tobytes(), image.dtype).reshape(
        image.shape
    ),
}


@pytest.mark.parametrize("type", [np.float16, np.float32, np.float64])
@pytest.mark.parametrize("view", VIEWS)
def test_the_layout_of_an_image_does_not_matter(sensor, view, type):
    image = np.random.default_rng(1).uniform(0, 1.2, (131, 70, 3)).astype(np.float16)
    expected = sensor.simulate(image.astype(np.float32), illuminant="A", iso=800)
    seen = sensor.simulate(VIEWS[view](image.astype(type)), illuminant="A", iso=800)
    assert seen.dtype == np.uint16 and seen.shape == (131, 70)
    np.testing.assert_array_equal(seen, expected)


@pytest.mark.parametrize("view", ["as it is", "RGB of RGBA", "upside down"])
def test_float32_goes_in_without_a_copy(sensor, view):
    image = VIEWS[view](np.full((1000, 1000, 3), 0.5, np.float32))
    assert peak_of(lambda: sensor.simulate(image, illuminant="A", threads=1)) < 1e5


def test_float16_goes_in_without_a_float32_copy(sensor):
    image = np.full((1000, 1000, 3), 0.5, np.float16)
    assert peak_of(lambda: sensor.simulate(image, illuminant="A", threads=1)) < 1e5
    # The measure sees what it should: float64 is copied, 12 MB.
    image = image.astype(np.float64)
    assert peak_of(lambda: sensor.simulate(image, illuminant="A", threads=1)) > 12e6


def peak_of(call):
    """Return the peak of what NumPy and Python allocate during a call, bytes."""
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


BAD = [np.ones((4, 4, 3), int), np.ones((4, 4, 3), complex), np.ones((4, 4, 3), object)]


@pytest.mark.parametrize("image", BAD, ids=lambda image: str(image.dtype))
@pytest.mark.parametrize("call", ["to_camera", "to_scene", "simulate", "signal"])
def test_other_types_are_named(sensor, call, image):
    with pytest.raises(ValueError, match=f"floating point.*not {image.dtype}"):
        getattr(sensor, call)(image, illuminant="A")
    with pytest.raises(ValueError, match="floating point"):
        cg2raw.demosaic(image[..., 0], "RGGB")


WORDS = np.arange(16 * 24, dtype=np.uint16).reshape(16, 24) + 2048
DN = {
    "big-endian": lambda words: words.astype(">u2"),
    "upside down": lambda words: words[::-1].copy()[::-1],
    "every other column": lambda words: np.repeat(words, 2, axis=1)[:, ::2],
    "read-only": lambda words: np.frombuffer(words.tobytes(), "=u2").reshape(16, 24),
    "an array of others": lambda words: type(
        "Other", (), {"__array__": lambda self, dtype=None, copy=None: words}
    )(),
}


@pytest.mark.parametrize("view", DN)
def test_the_layout_of_dn_does_not_matter(sensor, view, tmp_path):
    seen = DN[view](WORDS)
    signal = sensor.signal_from_raw(WORDS)
    np.testing.assert_array_equal(sensor.signal_from_raw(seen), signal)
    for name, array in (("a.dng", WORDS), ("b.dng", seen)):
        cg2raw.write_dng(tmp_path / name, array, sensor=sensor, illuminant="A")
    assert (tmp_path / "b.dng").read_bytes() == (tmp_path / "a.dng").read_bytes()
    frame = UniformFrame("a", "dark", lambda: seen).pixels()
    assert frame.dtype.isnative and (frame == WORDS).all()


def test_a_frame_keeps_its_simulation_in_another_byte_order(sensor, tmp_path):
    frame = sensor.simulate(np.full((16, 24, 3), 0.2, np.float32), illuminant="A")
    cg2raw.write_dng(tmp_path / "a.dng", frame)
    cg2raw.write_dng(tmp_path / "b.dng", frame.astype(">u2"))
    assert (tmp_path / "b.dng").read_bytes() == (tmp_path / "a.dng").read_bytes()


def test_a_file_of_big_endian_words_is_a_frame(tmp_path):
    np.save(tmp_path / "a.npy", WORDS.astype(">u2"))
    np.savez(tmp_path / "a.npz", dark=WORDS.astype(">u2"))
    for name in ("a.npy", "a.npz"):
        (frame,) = raw_file.frames_in(str(tmp_path / name))
        np.testing.assert_array_equal(frame.read(None), WORDS)


def test_what_is_no_dn_is_refused_in_words(sensor):
    masked = np.ma.masked_equal(WORDS, 2048)
    with pytest.raises(ValueError, match="raw is a masked array: fill"):
        sensor.signal_from_raw(masked)
    with pytest.raises(ValueError, match="signal is a masked array: fill"):
        sensor.raw_from_signal(np.ma.masked_less(np.zeros((4, 4), np.float32), 1))
    with pytest.raises(ValueError, match=r"int64; astype\(numpy.uint16\) converts"):
        sensor.signal_from_raw(WORDS.astype(np.int64))
    signal = np.zeros((4, 4), np.float32)
    with pytest.raises(ValueError, match="native float32, not >f4"):
        sensor.add_noise(signal, iso=100, out=signal.astype(">f4"))


def test_the_core_refuses_what_it_cannot_read():
    with pytest.raises(ValueError, match="float32 or float16, not int64"):
        _core.mosaic(np.ones((4, 4, 3), np.int64), "RGGB")
    with pytest.raises(ValueError, match="shape"):
        _core.mosaic(np.ones((4, 4), np.float32), "RGGB")


def test_a_simulation_takes_no_image_of_another_size(sensor):
    simulation = sensor.simulation((40, 60), illuminant="A")
    for call in (simulation.raw, simulation.signal, simulation.predict):
        with pytest.raises(ValueError, match="40 x 60"):
            call(np.ones((41, 60, 3), np.float32))


LONG = np.full((1600, 1600, 3), 0.4, np.float32)
CALLS = {
    "simulate": lambda s: s.simulate(
        LONG, illuminant="A", iso=800, noise="physical", threads=1
    ),
    "signal": lambda s: s.signal(LONG, illuminant="A", iso=800, threads=1),
    "predict": lambda s: s.predict(LONG, illuminant="A", iso=800, threads=1),
    "to_camera": lambda s: s.to_camera(LONG, illuminant="A", threads=1),
    "to_scene": lambda s: s.to_scene(LONG, illuminant="A", threads=1),
    "demosaic": lambda s: s.demosaic(LONG[..., 0], threads=1),
    "add_noise": lambda s: s.add_noise(LONG[..., 0], iso=800, threads=1),
}


@pytest.mark.parametrize("name", CALLS)
def test_other_threads_run_during_a_call(sensor, name):
    """Beats of a thread that needs the GIL, in between a call's begin and end."""
    beats, calling, stop = [], threading.Event(), threading.Event()

    def beat():
        while not stop.wait(0.0005):
            if calling.is_set():
                beats.append(1)

    thread = threading.Thread(target=beat)
    thread.start()
    try:
        # A call that holds the GIL lets it go only before and after.
        most = 0
        for _ in range(5):
            beats.clear()
            calling.set()
            CALLS[name](sensor)
            calling.clear()
            most = max(most, len(beats))
    finally:
        stop.set()
        thread.join()
    assert most >= 4


@pytest.mark.parametrize("shape", [(8,), (8, 8, 1), (8, 8, 3)])
def test_a_signal_that_is_no_mosaic_is_one_error(sensor, shape):
    def noisy(signal):
        return sensor.add_noise(signal, iso=800)

    for call in (sensor.raw_from_signal, sensor.demosaic, noisy):
        with pytest.raises(ValueError, match=r"signal must have the shape \(H, W\)"):
            call(np.zeros(shape, np.float32))
